// Pins sub-step classes (docs/substeps.md): an island under a heavy load, or with joints that turn far, makes more
// sub-steps, and no other island feels it by a bit; what is remembered from step to step does not depend on the class;
// the same bits in any number of lanes and threads, on GL and in all mixes.
#include <cmath>

#include "support_ways.h"
#include "support_world.h"

using namespace worldtest;

namespace {

BodyDef box(Vec3 position, Vec3 half, double density) {
  BodyDef def;
  def.shapes = {ShapeDef::box(half)};
  def.pose.position = position;
  def.density = density;
  return def;
}

/// A box under one `ratio` times as heavy.
std::vector<BodyId> add_tower(World& world, Vec3 foot, double ratio) {
  const Vec3 half{0.5, 0.5, 0.5};
  return {must(world.create_body(box(foot + Vec3{0, 0.5, 0}, half, 10))),
          must(world.create_body(box(foot + Vec3{0, 1.5, 0}, half, 10 * ratio)))};
}

/// Links of 0.4 m from `top` down, the lower ones spinning; a ring where `closed`.
std::vector<BodyId> add_links(World& world, Vec3 top, int count, double spin, bool closed = false) {
  std::vector<BodyId> links;
  for (int i = 0; i < count; i++) {
    BodyDef def = box(top - Vec3{0, 0.2 + 0.4 * i, 0}, {0.05, 0.2, 0.08}, 500);
    if (i > 0) def.angular_velocity = {spin, 0.3 * spin, -0.5 * spin};
    def.linear_drag = 0.2;
    def.angular_drag = 0.1;
    links.push_back(must(world.create_body(def)));
    if (i == 0) continue;
    JointDef joint;
    joint.a = links[std::size_t(i - 1)];
    joint.b = links.back();
    joint.frame_a.position = {0, -0.2, 0};
    joint.frame_b.position = {0, 0.2, 0};
    (void)must(world.create_joint(joint));
  }
  if (!closed) return links;
  JointDef last;
  last.a = links.back();
  last.b = links.front();
  last.frame_a.position = {0.4, -0.2, 0};
  last.frame_b.position = {0.4, -0.2 - 0.4 * (count - 1), 0};
  (void)must(world.create_joint(last));
  return links;
}

struct Yard {
  World world;
  std::vector<BodyId> tower, chain, pile;

  explicit Yard(Precision precision, double ratio = 1000, double spin = 400) : world({precision}) {
    (void)must(world.create_body(fixed_box({0, -0.5, 0}, {20, 0.5, 20})));
    tower = add_tower(world, {}, ratio);
    chain = add_links(world, {6, 9, 0}, 4, spin, true);
    pile = {must(world.create_body(box({-6, 0.3, 0}, {0.3, 0.3, 0.5}, 100))),
            must(world.create_body(box({-6, 0.95, 0.1}, {0.3, 0.3, 0.4}, 120))),
            must(world.create_body(ball({-6.2, 2, 0}, 0.4)))};
  }
};

}  // namespace

TEST_CASE("octaves: what each island of a world asks for") {
  Yard yard(Precision::f32);
  Stepper stepper;
  const StepReport& report = stepper.step(yard.world, frame);
  REQUIRE(report);
  CHECK(report.substeps == 64);  // the tower's
  CHECK(report.refined == 6);    // the tower and the ring, not the pile
  StepSettings never;
  never.refinement = 1;
  REQUIRE(stepper.configure(never));
  REQUIRE(stepper.step(yard.world, frame));
  CHECK(report.substeps == 4);
  CHECK(report.refined == 0);
}

TEST_CASE("octaves: a tower asks for its load's, a chain that spins for its turn's, a loop at rest for none") {
  World heavy, spinning, resting;
  (void)must(heavy.create_body(fixed_box({0, -0.5, 0}, {20, 0.5, 20})));
  (void)add_tower(heavy, {}, 1000);
  (void)add_links(spinning, {6, 9, 0}, 4, 400);
  (void)add_links(resting, {6, 9, 0}, 4, 0, true);
  Stepper stepper;
  CHECK(stepper.step(heavy, frame).substeps == 64);
  CHECK(stepper.step(spinning, frame).substeps == 16);
  for (int i = 0; i < 20; i++) CHECK(stepper.step(resting, frame).substeps == 4);
}

TEST_CASE("octaves: columns that are high for the sub-step, and pyramids of boxes small for it") {
  const auto asked = [](double edge, int count, double dt) {
    World world;
    (void)must(world.create_body(fixed_box({0, -0.5, 0}, {20, 0.5, 20})));
    for (int i = 0; i < count; i++)
      (void)must(world.create_body(box({0, edge * (i + 0.5), 0}, {0.5 * edge, 0.5 * edge, 0.5 * edge}, 100)));
    Stepper stepper;
    return stepper.step(world, dt).substeps;
  };
  CHECK(asked(1, 5, frame) == 8);
  CHECK(asked(1, 50, 1.0 / 240) == 64);  // slender
  CHECK(asked(0.5, 10, frame) == 32);
  CHECK(asked(0.5, 30, 1.0 / 240) == 32);
  CHECK(asked(0.05, 60, frame) == 64);  // any number
}

TEST_CASE("octaves: slender towers of many bodies stand") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world({precision});
    (void)must(world.create_body(fixed_box({0, -0.5, 0}, {20, 0.5, 20})));
    std::vector<BodyId> beams;
    for (int i = 0; i < 60; i++) {  // 30 layers of two, laid crosswise
      const double out = i % 2 == 0 ? 0.8 : -0.8, height = 0.2 * (i / 2) + 0.1;
      const bool turned = i / 2 % 2 == 1;
      beams.push_back(must(world.create_body(turned ? box({0, height, out}, {1, 0.1, 0.1}, 1000)
                                                    : box({out, height, 0}, {0.1, 0.1, 1}, 1000))));
    }
    Stepper stepper;
    CHECK(stepper.step(world, frame).substeps == 32);
    run(world, stepper, 600);
    const Vec3 top = world.pose(beams.back())->position;
    CHECK(std::fabs(top.y - 5.9) < 0.005);
    CHECK(std::hypot(top.x, top.z + 0.8) < 0.02);
  }
}

TEST_CASE("octaves: islands do not feel each other's, by a bit") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Yard both(precision), light(precision, 2, 400), still(precision, 1000, 0);
    Stepper a, b, c;
    for (int i = 0; i < 90; i++) {
      run(both.world, a, 1);
      run(light.world, b, 1);
      run(still.world, c, 1);
      CHECK(states(both.world, both.pile) == states(light.world, light.pile));
      CHECK(states(both.world, both.pile) == states(still.world, still.pile));
      CHECK(states(both.world, both.chain) == states(light.world, light.chain));
      CHECK(states(both.world, both.tower) == states(still.world, still.tower));
    }
  }
}

TEST_CASE("octaves: equal hashes in lanes, threads, on GL and in all mixes") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    INFO((precision == Precision::f32 ? "float" : "double"));
    const auto hashes_of = [&](const StepSettings& settings, int steps) {
      Yard yard(precision);
      Stepper stepper(settings);
      return hash_each_step(yard.world, stepper, steps);
    };
    check_same_bits(hashes_of, 60, 8);
    check_same_ways({.make = [&] { return std::move(Yard(precision).world); }}, 60, 8);
  }
}

TEST_CASE("octaves: a snapshot goes on alike, whatever octaves came before") {
  Yard yard(Precision::f64);
  Stepper stepper;
  run(yard.world, stepper, 20);
  const std::vector<std::byte> middle = yard.world.snapshot();
  run(yard.world, stepper, 20);
  const std::uint64_t wanted = yard.world.hash();
  must(yard.world.restore(middle));
  Stepper other;
  run(yard.world, other, 20);
  CHECK(yard.world.hash() == wanted);
}

TEST_CASE("octaves: coming and going keeps the motion") {
  // free links with a spin that drag takes out; without gravity and linear drag their centre goes straight on
  World world({Precision::f64, {}});
  const std::vector<BodyId> links = add_links(world, {}, 4, 300);
  for (const BodyId link : links) {
    must(world.set_drag(link, 0, 2));
    must(world.set_velocity(link, {3, -2, 1}));
  }
  const Vec3 momentum = world.momentum();
  Stepper stepper;
  std::vector<std::uint32_t> seen;
  for (int i = 0; i < 240; i++) {
    const StepReport& report = stepper.step(world, frame);
    REQUIRE(report);
    if (seen.empty() || seen.back() != report.substeps) seen.push_back(report.substeps);
    CHECK(length(world.momentum() - momentum) < 1e-11 * length(momentum));
  }
  CHECK(seen.front() > 4);
  CHECK(seen.back() == 4);
  CHECK(seen.size() >= 3);  // by and by
}

TEST_CASE("octaves: a kinematic body joins what it carries") {
  World world;
  BodyDef belt = fixed_box({0, -0.5, 0}, {20, 0.5, 20});
  belt.kind = BodyKind::kinematic;
  belt.velocity = {0.5, 0, 0};
  (void)must(world.create_body(belt));
  (void)add_tower(world, {}, 1000);
  const BodyId far = must(world.create_body(box({6, 0.3, 0}, {0.3, 0.3, 0.3}, 100)));
  Stepper stepper;
  const StepReport& report = stepper.step(world, frame);
  REQUIRE(report);
  CHECK(report.refined == 4);  // the belt too
  run(world, stepper, 120);
  CHECK(std::fabs(world.velocity(far)->x - 0.5) < 1e-3);
  CHECK(std::fabs(world.pose(far)->position.x - 6 - 121 * frame * 0.5) < 0.05);
}

TEST_CASE("octaves: a step that makes a free tree spin, or whip, far faster than it was made for is made again") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const auto& pair : {std::pair(10.0, 4u), {1e3, 32u}, {1e5, 64u}}) {  // enough; whips; spins
      const double torque = pair.first;
      const std::uint32_t substeps = pair.second;
      CAPTURE(torque);
      World world({precision, {}});
      const std::vector<BodyId> links = add_links(world, {}, 4, 0);
      const ForceId twist = must(world.add_force(links[3], {{}, {torque, 0, 0}}));
      Stepper stepper;
      const StepReport& report = stepper.step(world, frame);
      REQUIRE(report);
      CHECK((report.repeats > 0) == (substeps > 4));
      CHECK(report.substeps == substeps);
      must(world.remove(twist));
      CHECK(stepper.step(world, frame).repeats == 0);  // what was chosen before it is enough
      CHECK(std::isfinite(world.kinetic_energy()));
    }
}

TEST_CASE(
    "octaves: a ragdoll that is pulled gets them by how far its body would go in a sub-step, limits or not, and no "
    "other") {
  // a forearm of 1.7 kg and 0.18 m (twice its radius of gyration): a hundredth of that in 1/240 s with 180 N
  const auto asked = [](bool limits, double force, bool called, Precision precision) {
    World world({precision, {}});
    RagdollDef chain = RagdollDef::human();
    if (!limits)
      for (BoneDef& bone : chain.bones) bone.freedom = {};
    const Ragdoll pulled = must(world.create_ragdoll(chain, {{0, 5, 0}, {}})),
                  other = must(world.create_ragdoll(chain, {}));
    const BodyId arm = pulled.bones[6];
    if (called)
      (void)must(world.add_force(arm, [=](const World&, BodyId) { return Wrench{{force, 0, 0}, {}}; }));
    else
      (void)must(world.add_force(arm, {{0.5 * force, 0, 0}, {}})),
          (void)must(world.add_force(arm, {{0.5 * force, 0, 0}, {}}));
    Stepper stepper;
    const StepReport& report = stepper.step(world, frame);
    REQUIRE(report);
    CHECK(report.refined == (report.substeps > 4 ? pulled.bones.size() : 0));
    return report.substeps;
  };
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const bool called : {false, true}) {
      CHECK(asked(true, 150, called, precision) == 4);
      CHECK(asked(true, 1e4, called, precision) > asked(true, 1e3, called, precision));
      CHECK(asked(true, 1e6, called, precision) == 64);
      CHECK(asked(false, 1e3, called, precision) == 4);
    }
}

TEST_CASE("a step that asked for more sub-steps before all of its bodies were frozen reports those of the settings") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world(WorldDef{precision, {}});
    BodyDef link = box({0, 0, 0}, {0.1, 0.2, 0.4}, 1);
    link.mass = 1e-9;
    const BodyId upper = must(world.create_body(link));
    link.pose.position = {0, 0, 2};
    const BodyId lower = must(world.create_body(link));
    (void)must(world.create_joint(pin(upper, {0, 0, 1}, lower, {0, 0, -1})));
    for (const BodyId body : {upper, lower}) (void)must(world.add_force(body, {{1e14, 0, 0}, {10, 20, 10}}));
    Stepper stepper({.substeps = 1});
    const StepReport& report = stepper.step(world, frame);
    REQUIRE(report);
    CHECK(report.frozen.size() == 2);
    CHECK(report.substeps == 1);
  }
}
