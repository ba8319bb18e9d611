// Pins Stepper::memory: the host's own properties and tables are listed beside the library's, in each place, and leave
// with them; what kernels sum up is counted.
#include "pcphys/write_kernel.h"
#include "support_world.h"

using namespace worldtest;

namespace {

PCPHYS_KERNEL(push, (PC_IN(Vec3) thrust, PC_IN(Vec3) gust, PC_INOUT(Vec3) force),
              { force = pc_add(pc_add(force, thrust), gust); })
PCPHYS_KERNEL(momentum, (PC_IN(Real) mass, PC_IN(Vec3) displacement_rate, PC_SUM(Vec3) total),
              { total = pc_scale(displacement_rate, mass); })

/// Bytes of what has that name there; 0 where it is not listed.
std::size_t bytes(const World& world, const Stepper& stepper, std::string_view name, Place place,
                  std::string_view table) {
  std::size_t sum = 0;
  for (const BufferUse& use : stepper.memory(world))
    if (use.name == name && use.place == place) {
      CHECK(use.table == table);
      CHECK(use.bytes > 0);
      sum += use.bytes;
    }
  return sum;
}

}  // namespace

TEST_CASE("memory lists the host's own properties by name and table, where they stand, and drops what is removed") {
  require_gl();
  constexpr std::size_t count = 500;
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const Place place : {Place::cpu, Place::gl}) {
      World world({precision});
      const std::size_t real = precision == Precision::f32 ? 4 : 8;
      const TableId air = must(world.add_table("air", 1)), notes = must(world.add_table("notes", 100));
      (void)must(world.add_property<Vec3>("thrust", {}, "N"));
      (void)must(world.add_property<Vec3>("gust", {}, "N", air));
      (void)must(world.add_property<Vec3>("total", {}, "kg m/s", air));
      (void)must(world.add_property<std::int32_t>("page", 0, "1", notes));
      for (std::size_t i = 0; i < count; i++) (void)must(world.create_body(ball({3.0 * double(i), 0, 0})));
      StepSettings settings;
      settings.set_all(place);
      Stepper stepper(settings);
      must(stepper.add_kernel(world, {.text = push::text()}));
      must(stepper.add_kernel(world, {.text = momentum::text()}));
      run(world, stepper, 2);
      CHECK(bytes(world, stepper, "thrust", Place::cpu, "body") >= count * 4 * real);
      CHECK(bytes(world, stepper, "thrust", Place::cpu, "body") < 2 * (count + 16) * 4 * real);
      CHECK(bytes(world, stepper, "gust", Place::cpu, "air") >= 2 * 4 * real);
      CHECK(bytes(world, stepper, "page", Place::cpu, "notes") >= 100 * 4);
      CHECK(bytes(world, stepper, "page", Place::gl, "notes") == 0);  // no kernel reads it
      CHECK(bytes(world, stepper, "sums", place, "") >= 4 * real);
      CHECK(bytes(world, stepper, "moving_by_id", Place::cpu, "") >= count * 4);
      if (place == Place::gl) CHECK(bytes(world, stepper, "thrust", Place::gl, "body") >= count * 4 * real);
      must(stepper.remove_kernels());
      must(world.remove_property("thrust"));
      run(world, stepper, 1);
      CHECK(bytes(world, stepper, "thrust", Place::cpu, "body") == 0);
    }
}
