// Pins what the direct solve of joint trees promises: chains under loads of up to a million links neither stretch nor
// gain energy, welds and hinges hold, bodies follow a kinematic one, loops (solved by rows) stay closed, momentum is
// kept, and neither the backend nor a snapshot in mid-run makes a difference.
#include "scenes/scene.h"
#include "support_trees.h"

using namespace trees;

namespace {

/// 20 links and a load of `ratio` links; a chainswing starts level, a chain hangs and its load is pushed at 1 m/s.
struct Chain {
  Run run;
  double range;  // energy that is exchanged: of the push, or of the fall from level to hanging [J]

  Chain(const Mode& mode, const char* scene, double ratio) : run(mode, {0, -gravity, 0}, 4) {
    scenes::SceneOptions options;
    options.count = 20;
    options.ratio = ratio;
    const auto made = scenes::make(scene, options, run.world);
    if (!made) FAIL(made.error().message);
    range = run.world.kinetic_energy();
    if (range > 0) return;
    const Vec3 top{0, 20, 0};
    for (const BodyId body : run.world.bodies())
      range += run.world.mass_properties(body)->mass * gravity * length(run.position(body) - top);
  }
};

}  // namespace

namespace {

void check_chain(const Mode& mode, const char* scene, double ratio) {
  Chain chain(mode, scene, ratio);
  const Worst w = watch(chain.run);
  CAPTURE(mode.name());
  CAPTURE(ratio);
  tell(std::string(scene) + " with a load of " + std::to_string(long(ratio)), mode, w, chain.range);
  CHECK(w.finite);
  CHECK(w.separation <= (mode.is_double() ? 1e-13 : 4e-6));  // places are rounded by 2e-15 and 1e-6
  CHECK(w.gain <= 1e-3 * chain.range);
}

}  // namespace

// In single, 1e6 is the first to go when the solve loses digits: it flew apart (375 m) for one revision.
TEST_CASE("trees: a chain whose load is pushed, loads of 1 to 1e6 links") {
  for (const Mode& mode : precisions())
    for (const double ratio : {1.0, 1e2, 1e4, 1e6}) check_chain(mode, "chain", ratio);
}

TEST_CASE("trees: a chain let go from level, loads of 1e2 to 1e4 links") {
  for (const Mode& mode : precisions())
    for (const double ratio : {1e2, 1e3, 1e4}) check_chain(mode, "chainswing", ratio);
}

// A light chain that whips keeps its joints too; of its energy: analytic_whips.
TEST_CASE("trees: chains of 20 with loads of 1 and 1e6 links, hung and swung, hold after every step of ten seconds") {
  for (const Mode& mode : precisions())
    for (const char* scene : {"chain", "chainswing"})
      for (const double ratio : {1.0, 1e6}) {
        Chain chain(mode, scene, ratio);
        const Worst w = watch(chain.run, 600);
        CAPTURE(mode.name());
        tell(std::string(scene) + " with a load of " + std::to_string(long(ratio)) + ", 10 s", mode, w, chain.range);
        CHECK(w.finite);
        CHECK(w.separation <= 1 * millimetre);
      }
}

TEST_CASE("trees: a chain with a load of 1e4 links in every lane width and on GL") {
  std::uint64_t hashes[2] = {};  // by precision
  for (const Mode& mode : everywhere()) {
    Chain chain(mode, "chain", 1e4);
    const Worst w = watch(chain.run, 60);
    CAPTURE(mode.name());
    CHECK(w.separation <= 1 * millimetre);
    CHECK(w.gain <= 1e-3 * chain.range);
    std::uint64_t& hash = hashes[mode.is_double()];
    if (hash == 0) hash = chain.run.world.hash();
    CHECK(chain.run.world.hash() == hash);
  }
}

TEST_CASE("trees: a chain that is cut goes on as two") {
  for (const Mode& mode : precisions()) {
    Chain chain(mode, "chainswing", 100);
    World& world = chain.run.world;
    Worst w = watch(chain.run, 60);
    const double start = energy(world);
    REQUIRE(world.destroy(world.joints()[10]));  // the last joint's row moves into the gap
    for (int i = 0; i < 120; i++) {
      chain.run.step(frame);
      note(w, world, start);
    }
    CAPTURE(mode.name());
    tell("chain cut", mode, w, chain.range);
    const std::vector<BodyId> bodies = world.bodies();
    CHECK(w.finite);
    CHECK(w.separation <= 1 * millimetre);
    CHECK(w.gain <= 1e-3 * chain.range);
    CHECK(length(chain.run.position(bodies[9]) - Vec3{0, 20, 0}) <= 5);  // ten links of half a metre still hang
    CHECK(chain.run.position(bodies.back()).y < 0);                      // the load falls
  }
}

// ---- loops: one joint of each is solved by rows -----------------------------------------------------------

namespace {

/// Two arms that hang from the ground, and a bar between them; level, let go at 60 degrees.
void add_four_bar(Run& run, const AngleFreedom& freedom) {
  const BodyId ground = run.world.ground();
  const Quat tilt = axis_angle({0, 0, 1}, 60 * degree);
  const Vec3 down = rotate(tilt, {0, -0.5, 0}), apart{1, 0, 0};
  const BodyId left = run.add(rod({0.03, 0.25, 0.03}, 1, 0.5 * down, tilt));
  const BodyId right = run.add(rod({0.03, 0.25, 0.03}, 1, apart + 0.5 * down, tilt));
  const BodyId bar = run.add(rod({0.5, 0.03, 0.03}, 2, 0.5 * apart + down));
  join(run, ground, left, {}, freedom, about_z);
  join(run, left, bar, down, freedom, about_z);
  join(run, bar, right, apart + down, freedom, about_z);
  join(run, ground, right, apart, freedom, about_z);
}

/// Six rods end to end, which turn about each other, and are bent in and out.
void add_ring(Run& run) {
  std::vector<BodyId> rods;
  const auto corner = [](int i) { return Vec3{std::cos(60 * degree * i), std::sin(60 * degree * i), 0}; };
  for (int i = 0; i < 6; i++) {
    const Vec3 middle = 0.5 * (corner(i) + corner(i + 1));
    BodyDef def = rod({0.45, 0.05, 0.05}, 1 + 0.5 * i, middle, axis_angle({0, 0, 1}, 60 * degree * i + 120 * degree));
    def.velocity = cross(Vec3{0.5, 0, 2}, middle) + (i % 2 ? 1.0 : -1.0) * middle + Vec3{0, 0, i % 3 - 1.0};
    def.angular_velocity = {0.5, 0, 2};
    rods.push_back(run.add(def));
  }
  for (int i = 0; i < 6; i++) join(run, rods[std::size_t(i)], rods[std::size_t(i + 1) % 6], corner(i + 1));
}

/// A door of 40 kg on two pins at its edge, pushed.
void add_door(Run& run) {
  BodyDef def = rod({0.5, 1, 0.02}, 40, {0.5, 1, 0});
  def.angular_velocity = {0, 2, 0};
  def.velocity = cross(def.angular_velocity, {0.5, 0, 0});
  const BodyId door = run.add(def);
  for (const double height : {0.2, 1.8}) join(run, run.world.ground(), door, {0, height, 0});
}

}  // namespace

TEST_CASE("trees: loops stay closed") {
  struct Case {
    const char* name;
    void (*add)(Run&);
    double limit;  // of the separation [mm]; measured 1.70, 1.70, 5.75 and 0.123
  };
  const Case cases[] = {
      {"four-bar of pins", [](Run& run) { add_four_bar(run, {}); }, 2.5},
      {"four-bar of hinges", [](Run& run) { add_four_bar(run, AngleFreedom::hinge()); }, 2.5},
      {"ring of six", add_ring, 8},
      {"door on two pins", add_door, 0.25},
  };
  for (const Mode& mode : precisions())
    for (const Case& c : cases) {
      Run run(mode, {0, -gravity, 0}, 4);
      c.add(run);
      const Worst w = watch(run);
      CAPTURE(mode.name());
      CAPTURE(std::string(c.name));
      tell(c.name, mode, w, w.kinetic);
      CHECK(w.finite);
      CHECK(w.gain <= 1e-3 * w.kinetic);
      CHECK(w.separation <= c.limit * millimetre);
    }
}

// ---- locked angles ----------------------------------------------------------------------------------------

TEST_CASE("trees: a cantilever of four welded boxes holds") {
  for (const Mode& mode : precisions())
    for (const double tip : {2.0, 1000.0}) {
      Run run(mode, {0, -gravity, 0}, 4);
      BodyId last = run.world.ground();
      for (int i = 0; i < 4; i++) {
        const BodyId box = run.add(rod({0.25, 0.05, 0.05}, i == 3 ? tip : 2, {0.25 + 0.5 * i, 0, 0}));
        join(run, last, box, {0.5 * i, 0, 0}, AngleFreedom::locked());
        last = box;
      }
      double sag = 0;
      Worst w;
      for (int i = 0; i < 300; i++) {
        run.step(frame);
        note(w, run.world, 0);
        sag = std::max(sag, angle_between(run.orientation(last), {}));
      }
      MESSAGE("trees, cantilever with a tip of "
              << tip << " kg, " << mode.name() << ": sag " << sag / degree << " degrees, at the end "
              << angle_between(run.orientation(last), {}) / degree << ", separation " << w.separation / millimetre
              << " mm");
      CAPTURE(mode.name());
      CHECK(w.finite);
      CHECK(sag <= 1 * degree);
      CHECK(w.separation <= 1 * millimetre);
    }
}

TEST_CASE("trees: a hinge keeps its axis under a load that bends it") {
  for (const Mode& mode : precisions()) {
    Run run(mode, {0, -gravity, 0}, 4);
    // the centre of mass stands off the hinge's plane, so gravity and the swing bend the hinge
    const BodyId body = run.add(rod({0.3, 0.05, 0.3}, 5, {0.3, 0, 0.4}));
    join(run, run.world.ground(), body, {}, AngleFreedom::hinge(), about_z);
    double bend = 0;
    Worst w;
    for (int i = 0; i < 300; i++) {
      run.step(frame);
      note(w, run.world, 0);
      const Vec3 axis = rotate(run.orientation(body), {0, 0, 1});
      bend = std::max(bend, std::atan2(std::hypot(axis.x, axis.y), axis.z));
    }
    MESSAGE("trees, hinge, " << mode.name() << ": bent by " << bend / degree << " degrees, separation "
                             << w.separation / millimetre << " mm");
    CAPTURE(mode.name());
    CHECK(w.finite);
    CHECK(bend <= 1 * degree);
    CHECK(w.separation <= 1 * millimetre);
  }
}

TEST_CASE("trees: what hangs on a kinematic body follows it") {
  for (const Mode& mode : precisions()) {
    Run run(mode, {0, -gravity, 0}, 4);
    BodyDef carrier = rod({0.1, 0.1, 0.1}, 1, {});
    carrier.kind = BodyKind::kinematic;
    BodyId above = run.add(carrier);
    const BodyId moved = above;
    for (int i = 0; i < 3; i++) {
      const BodyId link = run.add(rod({0.03, 0.25, 0.03}, i == 2 ? 20 : 1, {0, -0.25 - 0.5 * i, 0}));
      join(run, above, link, {0, -0.5 * i, 0});
      above = link;
    }
    Worst w;
    for (int i = 0; i < 300; i++) {
      const double t = frame * (i + 0.5);
      REQUIRE(run.world.set_velocity(moved, {2 * std::cos(2 * t), std::sin(3 * t), -std::cos(t)}));
      run.step(frame);
      note(w, run.world, 0);
    }
    MESSAGE("trees, on a kinematic body, " << mode.name() << ": separation " << w.separation / millimetre << " mm");
    CAPTURE(mode.name());
    CHECK(w.finite);
    CHECK(length(run.position(moved)) > 0.5);  // it did go somewhere
    CHECK(w.separation <= 1 * millimetre);
  }
}

// ---- momentum, and the same bits --------------------------------------------------------------------------

namespace {

/// A hub and four arms with cones and twists that they meet.
void add_star(Run& run) {
  BodyDef hub = rod({0.2, 0.2, 0.2}, 3, {});
  hub.velocity = {0.3, -0.2, 0.1};
  const BodyId centre = run.add(hub);
  for (int i = 0; i < 4; i++) {
    const Quat turn = axis_angle({0, 0, 1}, 90 * degree * i);
    BodyDef arm = rod({0.3, 0.05, 0.08}, 0.5 + i, rotate(turn, {0.5, 0, 0}), turn);
    arm.angular_velocity = {3.0 * i, 2.0 - i, 4};
    arm.velocity = {0, 0, i % 2 ? 2.0 : -1.0};
    join(run, centre, run.add(arm), rotate(turn, {0.2, 0, 0}), AngleFreedom::cone_and_twist(30 * degree, 20 * degree),
         turn);
  }
}

}  // namespace

TEST_CASE("trees: a free tree with cone limits keeps its momenta") {
  for (const Mode& mode : precisions()) {
    Run run(mode, {}, 4);
    add_star(run);
    const Momenta start = momenta_in_phase(run.world);
    double linear = 0, angular = 0;
    for (int i = 0; i < 300; i++) {
      run.step(frame);
      const Momenta now = momenta_stored(run.world);
      linear = std::max(linear, length(now.linear - start.linear) / start.linear_scale);
      angular = std::max(angular, length(now.angular - start.angular) / start.angular_scale);
    }
    MESSAGE("trees, momentum of a star, " << mode.name() << ": " << linear << " and " << angular);
    CAPTURE(mode.name());
    CHECK(linear <= (mode.is_double() ? 1e-12 : 1e-5));
    CHECK(angular <= (mode.is_double() ? 1e-12 : 2e-5));
  }
}

TEST_CASE("trees: neither a change of the backend nor a snapshot in mid-run makes a difference") {
  constexpr int steps = 40;
  const auto build = [](Run& run) {
    add_star(run);
    add_ring(run);
    add_four_bar(run, AngleFreedom::hinge());
    const auto ragdoll = run.world.create_ragdoll(RagdollDef::human(), {{3, 1, 0}, {}});
    REQUIRE(ragdoll);
  };
  for (const Mode& mode : precisions()) {
    Run plain(mode, {0, -gravity, 0}, 4), changing(mode, {0, -gravity, 0}, 4);
    build(plain), build(changing);
    std::vector<std::byte> middle;
    for (int i = 0; i < steps; i++) {
      StepSettings settings = changing.stepper.settings();
      settings.joints = i % 2 ? Place::gl : Place::cpu;
      settings.integrate = i % 3 ? Place::gl : Place::cpu;
      settings.lanes = i % 4 ? 0 : 1;
      REQUIRE(changing.stepper.configure(settings));
      plain.step(frame), changing.step(frame);
      CHECK(plain.world.hash() == changing.world.hash());
      if (i == steps / 2) middle = plain.world.snapshot();
    }
    Run later(mode, {0, -gravity, 0}, 4);  // a world that has gone its own way, and a stepper that knows it
    build(later);
    later.step(frame, 3);
    REQUIRE(later.world.restore(middle));
    later.step(frame, steps - 1 - steps / 2);
    CHECK(later.world.hash() == plain.world.hash());
  }
}
