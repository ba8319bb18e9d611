// Pins one value of all rows: sums, least and most are those of the same rows; CPU (lanes, threads) and GPU agree to
// the bit for any number of rows, in both precisions and for every type; they are of the step's end, in the order of
// ids; other kernels may read them; of nothing the sum is zero.
#include <cmath>

#include "pcphys/write_kernel.h"
#include "support_world.h"

using namespace worldtest;

namespace {

PCPHYS_KERNEL(totals,
              (PC_IN(Real) mass, PC_IN(Vec3) position, PC_IN(Vec3) displacement_rate, PC_SUM(Real) kinetic,
               PC_SUM(Vec3) momentum, PC_MIN(Vec3) low, PC_MAX(Vec3) high, PC_SUM(uint) bodies),
              {
                precise Real v2 = pc_dot(displacement_rate, displacement_rate);
                precise Real twice = mass * v2;
                kinetic = twice * PC_REAL(0.5);
                momentum = pc_scale(displacement_rate, mass);
                low = position;
                high = position;
                bodies = 1u;
              })
PCPHYS_KERNEL(spread,
              (PC_IN(Real) x, PC_IN(int) n, PC_SUM(Real) sum, PC_MIN(Real) least, PC_MAX(int) most,
               PC_SUM(double) fine),
              {
                sum = x;
                least = x;
                most = n;
                fine = double(n);
              })
PCPHYS_KERNEL(brake, (PC_INOUT(Vec3) displacement_rate, PC_IN(Real) kinetic, PC_PARAM(Real) limit),
              { displacement_rate = pc_scale(displacement_rate, kinetic > limit ? PC_REAL(0.5) : PC_REAL(1.0)); })

TableId add_totals(World& world) {
  const TableId table = must(world.add_table("totals", 1));
  must(world.add_property<Real>("kinetic", 0, "J", table));
  must(world.add_property<Vec3>("momentum", {}, "kg m/s", table));
  must(world.add_property<Vec3>("low", {}, "m", table));
  must(world.add_property<Vec3>("high", {}, "m", table));
  must(world.add_property<std::uint32_t>("bodies", 0, "1", table));
  return table;
}
template <class T> T total(const World& world, const char* name) {
  return must(world.get(must(world.property<T>(name)), RowOf(1)));
}

}  // namespace

TEST_CASE("totals of bodies are of those that move, at the step's end") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    SceneWorld s = scene_world("balls", 150, precision);
    add_totals(s.world);
    Stepper stepper;
    must(stepper.add_kernel(s.world, {.text = totals::text()}));
    run(s.world, stepper, 30);
    double kinetic = 0, lowest = 1e9, highest = -1e9;
    std::uint32_t moving = 0;
    for (const BodyId id : s.world.bodies()) {
      if (must(s.world.kind(id)) != BodyKind::dynamic) continue;
      moving++;
      const Vec3 v = must(s.world.get(must(s.world.property<Vec3>("displacement_rate")), id));
      kinetic += 0.5 * double(must(s.world.get(must(s.world.property<Real>("mass")), id))) * dot(v, v);
      lowest = std::min(lowest, must(s.world.get(must(s.world.property<Vec3>("position")), id)).y);
      highest = std::max(highest, must(s.world.get(must(s.world.property<Vec3>("position")), id)).y);
    }
    CHECK(total<std::uint32_t>(s.world, "bodies") == moving);
    CHECK(double(total<Real>(s.world, "kinetic")) == doctest::Approx(kinetic).epsilon(1e-5));
    CHECK(total<Vec3>(s.world, "low").y == lowest);
    CHECK(total<Vec3>(s.world, "high").y == highest);
  }
}

TEST_CASE("the same bits in lanes, threads, on the GPU and wherever stages run") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64})
    check_same_bits(
        [&](const StepSettings& settings, int steps) {
          SceneWorld s = scene_world("balls", 100, precision);
          add_totals(s.world);
          Stepper stepper(settings);
          must(stepper.add_kernel(s.world, {.text = totals::text()}));
          must(stepper.add_kernel(s.world, {.text = brake::text(),
                                            .stage = Stage::impulses,
                                            .once_a_step = true,
                                            .parameters = {{"limit", 200.0}}}));
          const std::vector<std::uint64_t> hashes = hash_each_step(s.world, stepper, steps);
          CHECK(double(total<Real>(s.world, "kinetic")) > 0);
          return hashes;
        },
        6, 3);
}

TEST_CASE("any number of rows, none among them") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const std::uint32_t rows : {0u, 1u, 2u, 63u, 64u, 65u, 130u, 4096u, 4097u, 5000u}) {
      std::uint64_t hashes[2];
      for (int gl = 0; gl < 2; gl++) {
        World world(WorldDef{precision, {}});
        const TableId table = must(world.add_table("things", rows)), one = must(world.add_table("one", 1));
        const auto x = must(world.add_property<Real>("x", 0, "1", table));
        const auto n = must(world.add_property<std::int32_t>("n", 0, "1", table));
        must(world.add_property<Real>("sum", 9, "1", one));
        must(world.add_property<Real>("least", 9, "1", one));
        must(world.add_property<std::int32_t>("most", -9, "1", one));
        must(world.add_property<double>("fine", 9, "1", one));
        for (std::uint32_t row = 1; row <= rows; row++) {
          must(world.set(x, RowOf(row), Real(std::sin(row * 0.7) / 3)));
          must(world.set(n, RowOf(row), std::int32_t(row * 7919 % 1000) - 500));
        }
        StepSettings settings;
        if (gl) settings.set_all(Place::gl);
        Stepper stepper(settings);
        must(stepper.add_kernel(world, {.text = spread::text(), .over = table}));
        run(world, stepper, 1);
        double sum = 0, fine = 0;
        for (std::uint32_t row = 1; row <= rows; row++) {
          sum += double(must(world.get(x, RowOf(row))));
          fine += must(world.get(n, RowOf(row)));
        }
        CHECK(std::abs(double(total<Real>(world, "sum")) - sum) < 1e-4);
        CHECK(total<double>(world, "fine") == fine);
        if (rows == 0) CHECK(total<std::int32_t>(world, "most") == -9);
        hashes[gl] = world.hash();
      }
      CHECK_MESSAGE(hashes[0] == hashes[1], rows, " rows");
    }
}

TEST_CASE("what sleeps counts still") {
  World world(WorldDef{Precision::f32, {0, -9.81, 0}});
  add_totals(world);
  (void)must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
  (void)must(world.create_body(ball({0, 0.5, 0})));
  (void)must(world.create_body(ball({2, 0.5, 0})));
  (void)must(world.create_body(ball({4, 40, 0})));
  StepSettings settings;
  settings.sleep = true;
  Stepper stepper(settings);
  must(stepper.add_kernel(world, {.text = totals::text()}));
  run(world, stepper, 120);
  CHECK(stepper.step(world, frame).asleep == 2);
  CHECK(total<std::uint32_t>(world, "bodies") == 3);
}
