// Pins pair kernels with a cut-off: who is within it is exactly those that plain loops find, in each sub-step; what is
// summed depends on positions alone, not on how long lists of neighbours have stood or how fast bodies come; CPU and
// GPU agree to the bit.
#include <cmath>

#include "pcphys/write_kernel.h"
#include "support_ways.h"
#include "support_world.h"

using namespace worldtest;

namespace {

PCPHYS_PAIR_KERNEL(count_near, (PC_OTHER(uint) one_other, PC_SUM(uint) near), { near = one_other; })
PCPHYS_PAIR_KERNEL(spring_apart,
                   (PC_SELF(Vec3) position, PC_OTHER(Vec3) position_other, PC_ADD(Vec3) force, PC_PARAM(Real) stiffness,
                    PC_PARAM(Real) reach),
                   {
                     Vec3 d = pc_sub(position, position_other);
                     Real apart = pc_length(d);
                     precise Real push = reach - apart;
                     force = pc_scale(d, pc_div(push * stiffness, apart));
                   })

PCPHYS_KERNEL(shove, (PC_INOUT(Vec3) force, PC_PARAM(Vec3) push), { force = pc_add(force, push); })

/// Balls that never touch, crowded; some stand, one is fast.
World crowd(int count, Precision precision) {
  World world(WorldDef{precision, {0, -2, 0}});
  for (int i = 0; i < count; i++) {
    BodyDef def = ball({i % 6 * 0.5 + 0.07 * (i % 5), i / 6 % 6 * 0.45 + 0.03 * (i % 7), i / 36 * 0.5}, 0.01);
    def.mass = 1 + i % 3;
    if (i % 13 == 4) def.kind = BodyKind::fixed;
    if (i == 1) def.velocity = {60, 40, 10};
    (void)must(world.create_body(def));
  }
  must(world.add_property<std::uint32_t>("one", 1));
  must(world.add_property<std::uint32_t>("near", 0));
  return world;
}
void add_kernels(Stepper& stepper, World& world, double cutoff) {
  must(stepper.add_kernel(world,
                          {.text = count_near::text(), .stage = Stage::impulses, .after = true, .cutoff = cutoff}));
  must(stepper.add_kernel(
      world, {.text = spring_apart::text(), .parameters = {{"stiffness", 30.0}, {"reach", 0.8}}, .cutoff = 0.8}));
}
void check_counts(const World& world, double cutoff) {
  const auto near = must(world.property<std::uint32_t>("near"));
  const auto position = must(world.property<Vec3>("position"));
  for (const BodyId a : world.bodies()) {
    if (must(world.kind(a)) == BodyKind::fixed) continue;
    std::uint32_t wanted = 0;
    for (const BodyId b : world.bodies())
      if (a != b && length(must(world.get(position, b)) - must(world.get(position, a))) <= cutoff) wanted++;
    CHECK(must(world.get(near, a)) == wanted);
  }
}

}  // namespace

TEST_CASE("those within the cut-off, and no others, as bodies move") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const double cutoff : {0.6, 2.5}) {
      World world = crowd(150, precision);
      Stepper stepper;
      add_kernels(stepper, world, cutoff);
      for (int i = 0; i < 20; i++) {
        run(world, stepper, 1);
        check_counts(world, cutoff);
      }
    }
}

TEST_CASE("lists that stand and lists made anew give the same bits") {
  std::uint64_t hashes[2];
  for (int anew = 0; anew < 2; anew++) {
    World world = crowd(150, Precision::f32);
    Stepper kept;
    if (!anew) add_kernels(kept, world, 0.7);
    for (int i = 0; i < 20; i++) {
      Stepper fresh;
      if (anew) add_kernels(fresh, world, 0.7);
      run(world, anew ? fresh : kept, 1);
    }
    hashes[anew] = world.hash();
  }
  CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("a body that is thrown further than lists were made for: the step is made anew") {
  // it stands still, so that lists allow for little; a kernel's force sends it along a row of others within one step
  World world(WorldDef{Precision::f64, {}});
  must(world.add_property<std::uint32_t>("one", 1));
  must(world.add_property<std::uint32_t>("near", 0));
  BodyDef def = ball({0, 0, 0}, 0.001);
  def.mass = 1;
  const BodyId thrown = must(world.create_body(def));
  for (int i = 0; i < 100; i++) {
    BodyDef post = ball({0.5 * i, 0.3, 0}, 0.001);
    post.kind = BodyKind::fixed;
    (void)must(world.create_body(post));
  }
  Stepper stepper;
  must(stepper.add_kernel(world, {.text = shove::text(), .parameters = {{"push", Vec3{1e5, 0, 0}}}}));
  must(stepper.add_kernel(world, {.text = count_near::text(), .stage = Stage::impulses, .after = true, .cutoff = 0.8}));
  run(world, stepper, 1);
  CHECK(must(world.pose(thrown)).position.x > 5);
  check_counts(world, 0.8);
  CHECK(must(world.get(must(world.property<std::uint32_t>("near")), thrown)) == 3);
}

TEST_CASE("the same bits in lanes, threads, on the GPU and wherever stages run") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64})
    check_same_bits(
        [&](const StepSettings& settings, int steps) {
          World world = crowd(150, precision);
          Stepper stepper(settings);
          add_kernels(stepper, world, 0.7);
          return hash_each_step(world, stepper, steps);
        },
        6, 3);
}

TEST_CASE("the same bits whoever steps") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    check_same_ways({[&] { return crowd(150, precision); }, [](Stepper& s, World& w) { add_kernels(s, w, 0.7); }}, 12,
                    4);
}

TEST_CASE("objects come and go") {
  World world = crowd(60, Precision::f32);
  Stepper stepper;
  add_kernels(stepper, world, 0.7);
  for (int i = 0; i < 6; i++) {
    run(world, stepper, 2);
    check_counts(world, 0.7);
    must(world.destroy(world.bodies()[std::size_t(i * 5)]));
    if (i % 2) (void)must(world.create_body(ball({0.2 * i, 0.1, 0.3}, 0.01)));
  }
  for (const BodyId id : world.bodies()) must(world.destroy(id));
  run(world, stepper, 2);
}

TEST_CASE("more pairs than there is room for: a named error, and the world as it was") {
  World world = crowd(100, Precision::f32);
  StepSettings settings;
  settings.max_pairs = 500;
  Stepper stepper(settings);
  add_kernels(stepper, world, 1e6);
  CHECK_REFUSED(world, step_status(stepper, world), ErrorCode::buffer_full, "more than 500 pairs of bodies");
}
