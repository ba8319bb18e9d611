// Pins pair kernels of the host's own: forces between all pairs are those of the same sum done plainly; they keep
// momentum; CPU (lanes, threads) and GPU agree to the bit wherever stages run, for any number of bodies; everything is
// read before anything is written; the order of sums is that of ids, wherever rows stand; bodies that act on each other
// have one octave.
#include <cmath>

#include "pcphys/write_kernel.h"
#include "support_ways.h"
#include "support_world.h"

using namespace worldtest;

namespace {

PCPHYS_PAIR_KERNEL(attraction,
                   (PC_SELF(Vec3) position, PC_SELF(Real) mass, PC_OTHER(Vec3) position_other,
                    PC_OTHER(Real) mass_other, PC_ADD(Vec3) force, PC_PARAM(Real) strength, PC_PARAM(Real) softening),
                   {
                     Vec3 d = pc_sub(position_other, position);
                     precise Real r2 = pc_dot(d, d) + softening;
                     precise Real r3 = r2 * pc_sqrt(r2);
                     precise Real both = mass * mass_other;
                     precise Real k = strength * both;
                     force = pc_scale(d, pc_div(k, r3));
                   })

/// Heat goes from the warm to the cold: what is summed is what is read.
PCPHYS_PAIR_KERNEL(conduction,
                   (PC_SELF(Real) heat_self, PC_OTHER(Real) heat_other, PC_ADD(Real) heat, PC_SUM(uint) warmer,
                    PC_SUM(Vec3) flow, PC_PARAM(Real) rate),
                   {
                     precise Real d = heat_other - heat_self;
                     heat = d * rate;
                     warmer = heat_other > heat_self ? 1u : 0u;
                     flow = Vec3(heat, -heat, d);
                   })

PCPHYS_KERNEL(warm_total, (PC_IN(Real) heat, PC_SUM(Real) whole), { whole = heat; })
PCPHYS_KERNEL(tick, (PC_INOUT(Real) ticks), { ticks = ticks + PC_REAL(1.0); })

constexpr double strength = 2, softening = 0.01;
void add_attraction(Stepper& stepper, World& world) {
  must(stepper.add_kernel(
      world, {.text = attraction::text(), .parameters = {{"strength", strength}, {"softening", softening}}}));
}

/// Balls that never touch, at rest, of several masses; some of them fixed.
World cloud(int count, Precision precision, bool fixed = true) {
  World world(WorldDef{precision, {}});
  for (int i = 0; i < count; i++) {
    BodyDef def = ball({i % 7 * 1.5 + 0.1 * (i % 3), i / 7 % 7 * 1.3, i / 49 * 1.7 + 0.05 * (i % 5)}, 0.05);
    def.mass = 1 + i % 4;
    if (fixed && i % 11 == 5) def.kind = BodyKind::fixed;
    (void)must(world.create_body(def));
  }
  return world;
}

}  // namespace

TEST_CASE("two bodies fall onto each other as the formula says") {
  World world(WorldDef{Precision::f64, {}});
  BodyDef a = ball({0, 0, 0}, 0.1), b = ball({2, 0, 0}, 0.1);
  a.mass = 3;
  b.mass = 5;
  const BodyId first = must(world.create_body(a)), second = must(world.create_body(b));
  Stepper stepper;
  add_attraction(stepper, world);
  const double dt = 1e-3;
  run(world, stepper, 10, dt);
  const double r2 = 4 + softening, f = strength * 15 * 2 / (r2 * std::sqrt(r2)), t = 10 * dt;
  CHECK(must(world.velocity(first)).x == doctest::Approx(f / 3 * t).epsilon(1e-3));
  CHECK(must(world.velocity(second)).x == doctest::Approx(-f / 5 * t).epsilon(1e-3));
}

TEST_CASE("the sum over all pairs is that of plain loops, and keeps momentum") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world = cloud(300, precision, false);
    const std::vector<BodyId> bodies = world.bodies();
    std::vector<Vec3> at, wanted(bodies.size());
    std::vector<double> mass;
    for (const BodyId id : bodies) {
      at.push_back(must(world.pose(id)).position);
      mass.push_back(1 + double(mass.size() % 4));
    }
    for (std::size_t i = 0; i < at.size(); i++)
      for (std::size_t j = 0; j < at.size(); j++) {
        const Vec3 d = at[j] - at[i];
        const double r2 = dot(d, d) + softening;
        if (i != j) wanted[i] = wanted[i] + d * (strength * mass[j] / (r2 * std::sqrt(r2)));
      }
    StepSettings settings;
    settings.substeps = 1;
    Stepper stepper(settings);
    add_attraction(stepper, world);
    const double dt = 1e-4;
    run(world, stepper, 1, dt);
    Vec3 momentum;
    double worst = 0, most = 0;
    for (std::size_t i = 0; i < bodies.size(); i++) {
      const Vec3 v = must(world.velocity(bodies[i]));
      momentum = momentum + v * mass[i];
      worst = std::max(worst, length(v - wanted[i] * dt));
      most = std::max(most, length(v));
    }
    const double rounding = precision == Precision::f32 ? 1e-5 : 1e-6;  // and the way in the step
    CHECK(worst < rounding * most);
    CHECK(length(momentum) < (precision == Precision::f32 ? 1e-5 : 1e-13) * most * double(bodies.size()));
  }
}

TEST_CASE("the same bits in lanes, threads, on the GPU and wherever stages run") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const int count : {1, 2, 63, 66, 200})
      check_same_bits(
          [&](const StepSettings& settings, int steps) {
            World world = cloud(count, precision);
            Stepper stepper(settings);
            add_attraction(stepper, world);
            return hash_each_step(world, stepper, steps);
          },
          4, 2);
}

TEST_CASE("the same bits whoever steps") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    check_same_ways({[&] { return cloud(66, precision); }, add_attraction}, 12, 4);
}

TEST_CASE("of many others, in several chunks and on several levels") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    std::uint64_t hashes[2];
    for (int gl = 0; gl < 2; gl++) {
      World world = cloud(3000, precision);
      StepSettings settings;
      settings.substeps = 1;
      if (gl) settings.set_all(Place::gl);
      Stepper stepper(settings);
      add_attraction(stepper, world);
      run(world, stepper, 1);
      hashes[gl] = world.hash();
    }
    CHECK(hashes[0] == hashes[1]);
  }
}

TEST_CASE("rows of a table of one's own; what is summed may be what is read") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    std::uint64_t hashes[2];
    for (int gl = 0; gl < 2; gl++) {
      World world(WorldDef{precision, {}});
      const TableId table = must(world.add_table("cells", 150));
      const auto heat = must(world.add_property<Real>("heat", 0, "K", table));
      const auto warmer = must(world.add_property<std::uint32_t>("warmer", 77, "1", table));
      must(world.add_property<Vec3>("flow", {1, 2, 3}, "K", table));
      for (std::uint32_t row = 1; row <= 150; row++) must(world.set(heat, RowOf(row), Real(row)));
      StepSettings settings;
      if (gl) settings.set_all(Place::gl);
      Stepper stepper(settings);
      must(stepper.add_kernel(
          world, {.text = conduction::text(), .over = table, .once_a_step = true, .parameters = {{"rate", 0.001}}}));
      run(world, stepper, 1);
      // every difference is of what was there before
      CHECK(must(world.get(heat, RowOf(1))) == doctest::Approx(1 + 0.001 * (150 * 149 / 2)));
      CHECK(must(world.get(warmer, RowOf(1))) == 149);
      CHECK(must(world.get(warmer, RowOf(150))) == 0);
      run(world, stepper, 3);
      hashes[gl] = world.hash();
    }
    CHECK(hashes[0] == hashes[1]);
  }
}

TEST_CASE("the order is that of ids, wherever rows stand") {
  const auto made = [](bool moved) {
    World world(WorldDef{Precision::f32, {}});
    std::vector<BodyDef> defs;
    for (int i = 0; i < 100; i++) {
      defs.push_back(ball({i * 0.7 + 0.01 * (i % 7), 0.3 * (i % 5), 0.2 * (i % 3)}, 0.05));
      defs.back().mass = 1 + i % 6;
    }
    for (int i = 0; i < 100; i++) (void)must(world.create_body(defs[std::size_t(moved && i == 20 ? 21 : i)]));
    if (moved) {  // the body of index 20 stands in the last row
      const BodyId wrong = world.bodies()[20];
      must(world.destroy(wrong));
      CHECK(must(world.create_body(defs[20])).index == wrong.index);
    }
    Stepper stepper;
    add_attraction(stepper, world);
    run(world, stepper, 5);
    std::vector<Vec3> places;
    for (const BodyId id : world.bodies()) places.push_back(must(world.pose(id)).position);
    return places;
  };
  CHECK(made(false) == made(true));
}

TEST_CASE("bodies that act on each other make the same sub-steps") {
  // a heavy load on a light box asks for more sub-steps; the ball far away goes along
  World world(WorldDef{Precision::f64, {0, -9.81, 0}});
  (void)must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
  BodyDef light = ball({0, 0.5, 0}), heavy = ball({0, 2, 0});
  light.shapes = {ShapeDef::box({0.5, 0.5, 0.5})};
  heavy.shapes = {ShapeDef::box({1, 1, 1})};
  light.mass = 1;
  heavy.mass = 1000;
  (void)must(world.create_body(light));
  (void)must(world.create_body(heavy));
  (void)must(world.create_body(ball({100, 50, 0})));
  Stepper plain, with;
  run(world, plain, 5);
  REQUIRE(plain.step(world, frame).refined > 0);
  const std::uint32_t alone = plain.step(world, frame).refined;
  add_attraction(with, world);
  run(world, with, 1);
  CHECK(with.step(world, frame).refined > alone);
}

TEST_CASE("where nothing moves: the same on CPU and GL, of bodies in pairs, by themselves and in total") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    for (const bool any : {true, false}) {
      for (const std::optional<double> cutoff : {std::optional<double>(), std::optional<double>(3)}) {
        std::uint64_t hashes[2];
        for (const bool gl : {false, true}) {
          World world(WorldDef{precision, {}});
          for (int i = 0; any && i < 5; i++) (void)must(world.create_body(fixed_box({3.0 * i, 0, 0}, {1, 1, 1})));
          (void)must(world.add_property<Real>("heat", 2));
          (void)must(world.add_property<std::uint32_t>("warmer"));
          (void)must(world.add_property<Vec3>("flow"));
          const TableId one = must(world.add_table("one", 1)), cells = must(world.add_table("cells", 4));
          const auto whole = must(world.add_property<Real>("whole", 7, "1", one));
          const auto ticks = must(world.add_property<Real>("ticks", 0, "1", cells));
          StepSettings settings;
          if (gl) settings.set_all(Place::gl);
          Stepper stepper(settings);
          must(
              stepper.add_kernel(world, {.text = conduction::text(), .parameters = {{"rate", 0.1}}, .cutoff = cutoff}));
          must(stepper.add_kernel(world, {.text = warm_total::text()}));
          must(stepper.add_kernel(world, {.text = tick::text(), .over = cells}));
          add_attraction(stepper, world);
          run(world, stepper, 2);
          CHECK(double(must(world.get(whole, RowOf(1)))) == 0);  // of no rows
          CHECK(double(must(world.get(ticks, RowOf(4)))) == 8);
          hashes[gl] = world.hash();
        }
        CHECK(hashes[0] == hashes[1]);
      }
    }
  }
}
