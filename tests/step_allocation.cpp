// Pins: a warmed-up step allocates nothing. A scene is run to its end, put back to its start with a
// snapshot, run again, and put back once more: the third run, in which nothing is larger than before, may not
// allocate. (The second one may: putting all bodies back at once is more for the broad phase than any step was.)
#include <utility>

#include "pcphys/write_kernel.h"
#include "step/backend.h"
#include "support_memory.h"
#include "support_world.h"

using namespace worldtest;
using memorytest::allocations;
using memorytest::counting;

namespace {

/// How often the last of three equal runs allocated, and in which step first.
struct Count {
  std::size_t allocations = 0;
  int first = -1;
  std::uint64_t memory_growth = 0;
};

Count last_run(const char* name, int count, Precision precision, const StepSettings& settings, int settle, int steps) {
  SceneWorld s = scene_world(name, count, precision);
  Stepper stepper(settings);
  run(s.world, stepper, settle);
  const std::vector<std::byte> start = s.world.snapshot();
  run(s.world, stepper, steps);
  const std::uint64_t hash = s.world.hash();
  must(s.world.restore(start));
  run(s.world, stepper, steps);
  must(s.world.restore(start));
  const std::size_t memory = s.world.memory_bytes();
  Count c;
  for (int i = 0; i < steps; i++) {
    allocations = 0;
    counting = true;
    const StepReport& report = stepper.step(s.world, frame);
    counting = false;
    if (!report) FAIL(report.error.message);
    if (allocations > 0 && c.first < 0) c.first = i;
    c.allocations += allocations;
  }
  CHECK(s.world.hash() == hash);
  c.memory_growth = s.world.memory_bytes() - memory;
  return c;
}

void check_none(const char* name, int count, Precision precision, const StepSettings& settings, int settle, int steps) {
  INFO(std::string(name) << " " << count << ", " << std::string(precision == Precision::f32 ? "float" : "double")
                         << ", lanes " << settings.lanes << ", after " << settle << " steps");
  const Count c = last_run(name, count, precision, settings, settle, steps);
  CHECK_MESSAGE(c.allocations == 0, c.allocations << " allocations, the first in step " << c.first);
  CHECK(c.memory_growth == 0);
}
void check_none(const char* name, int count, Precision precision, std::uint32_t width, int settle, int steps) {
  check_none(name, count, precision, lanes(width), settle, steps);
}

PCPHYS_KERNEL(pulled, (PC_IN(Vec3) position, PC_INOUT(Vec3) force),
              { force = pc_madd(force, position, PC_REAL(-0.01)); })
PCPHYS_KERNEL(held, (PC_IN(Vec3) position, PC_INOUT(Vec3) torque),
              { torque = pc_madd(torque, position, PC_REAL(0.0001)); })
PCPHYS_KERNEL(joined, (PC_A(Vec3) position_a, PC_B(Vec3) position_b, PC_OUT(Real) stretch, PC_ADD_B(Vec3) force_b), {
  Vec3 way = pc_sub(position_b, position_a);
  stretch = pc_length(way);
  force_b = pc_scale(way, PC_REAL(-0.01));
})
PCPHYS_PAIR_KERNEL(apart, (PC_SELF(Vec3) position, PC_OTHER(Vec3) position_other, PC_ADD(Vec3) force),
                   { force = pc_scale(pc_sub(position, position_other), PC_REAL(0.0001)); })
PCPHYS_KERNEL(total_stretch, (PC_IN(Real) stretch, PC_SUM(Real) total), { total = stretch; })

}  // namespace

TEST_CASE("the counter counts") {
  allocations = 0;
  counting = true;
  delete new int;
  std::free(aligned_alloc(64, 128));
  { World world; }
  counting = false;
  CHECK(allocations > 3);
}

TEST_CASE("no allocation in 100 steps of scenes that have settled") {
  check_none("balls", 200, Precision::f32, 0, 400, 100);
  check_none("ragdolls", 4, Precision::f32, 0, 300, 100);
  check_none("stack", 10, Precision::f64, 0, 120, 100);
}

TEST_CASE("no allocation in 100 steps of scenes that move") {
  check_none("balls", 200, Precision::f32, 0, 60, 100);
  check_none("balls", 60, Precision::f64, 0, 60, 100);
  check_none("ragdolls", 4, Precision::f32, 0, 60, 100);
  check_none("ragdolls", 4, Precision::f32, 1, 60, 100);
  check_none("dominoes", 20, Precision::f32, 0, 30, 100);
  check_none("hulls", 30, Precision::f32, 0, 60, 100);
  check_none("door", 1, Precision::f32, 0, 10, 100);
  check_none("chain", 20, Precision::f32, 0, 10, 100);
}

TEST_CASE("no allocation for events") {
  StepSettings settings;
  settings.contact_events = settings.hit_events = settings.body_events = true;
  check_none("balls", 200, Precision::f32, settings, 60, 100);
  check_none("ragdolls", 4, Precision::f64, settings, 60, 100);
}

// GL drivers allocate as they like, so the CPU plays the device: what is counted is what pcphys does for two places,
// such as the copies that a failed step is put back from.
TEST_CASE("no allocation where a device takes part") {
  const GlBackendMaker before =
      std::exchange(gl_backend_maker(), [](Precision precision, int, bool) { return make_cpu_backend(precision, 0); });
  for (const Mix& mix : mixes()) {
    INFO(mix.text());
    check_none("ragdolls", 4, Precision::f32, mix.settings(), 60, 100);
  }
  gl_backend_maker() = before;
}

TEST_CASE("no allocation for forces and callbacks") {
  World world;
  for (int i = 0; i < 10; i++) {
    const BodyId body = must(world.create_body(ball({2.0 * i, 0, 0})));
    (void)must(world.add_force(body, Wrench{{1, 0, 0}, {}}));
    (void)must(world.add_force(body, [](const World& w, BodyId id) {
      return Wrench{-1.0 * w.pose(id)->position, {}};
    }));
  }
  Stepper stepper(lanes(0));
  run(world, stepper, 20);
  allocations = 0;
  counting = true;
  for (int i = 0; i < 100; i++) (void)stepper.step(world, frame);
  counting = false;
  CHECK(allocations == 0);
}

TEST_CASE("no allocation for kernels of the host's own, of each form, in octaves that change") {
  World world = chains_world(Precision::f32);
  must(world.add_property<Real>("stretch", 0, "m", joint_table));
  must(world.add_property<Real>("total", 0, "m", must(world.add_table("totals", 1))));
  Stepper stepper(lanes(0));
  must(stepper.add_kernel(world, {.text = pulled::text()}));
  must(stepper.add_kernel(world, {.text = held::text(), .once_a_step = true}));
  must(stepper.add_kernel(world, {.text = joined::text(), .over = joint_table}));
  must(stepper.add_kernel(world, {.text = apart::text()}));
  must(stepper.add_kernel(world, {.text = total_stretch::text(), .over = joint_table}));
  const std::vector<std::byte> start = world.snapshot();
  run(world, stepper, 30);
  must(world.restore(start));
  run(world, stepper, 30);
  must(world.restore(start));
  std::size_t most = 0;
  for (int i = 0; i < 30; i++) {
    allocations = 0;
    counting = true;
    (void)stepper.step(world, frame);
    counting = false;
    most = std::max(most, allocations);
  }
  CHECK(most == 0);
}

TEST_CASE("no allocation while everything sleeps, or all but one body") {
  for (const bool rolls : {false, true}) {
    SceneWorld s = scene_world("stack", 8);
    StepSettings settings = lanes(0);
    settings.sleep = true;
    Stepper stepper(settings);
    if (rolls) {
      BodyDef def = ball({100, 0, 0});
      def.can_sleep = false;
      def.velocity = {5, 0, 0};
      must(s.world.create_body(def));
    }
    run(s.world, stepper, 300);
    allocations = 0;
    for (int i = 0; i < 100; i++) {
      counting = true;
      const StepReport& report = stepper.step(s.world, frame);
      counting = false;
      if (!report) FAIL(report.error.message);
      CHECK(report.asleep == 8);
    }
    CHECK(allocations == 0);
  }
}
