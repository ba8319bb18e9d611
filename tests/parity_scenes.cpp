// Pins pcphys's signature: the same scene has the same hash in scalar C++, in 4 and 8 lanes, in any number of threads,
// on GL, in all eight mixes of places, when they change from step to step, and whichever steppers step it; in float and
// in double. It is run again for every change of a kernel, and has to hold on every device that promises parity (see
// `pcphys doctor`).
#include <algorithm>
#include <random>

#include "support_ways.h"
#include "support_world.h"

using namespace worldtest;

namespace {

struct Case {
  const char* scene;
  int count;
  int before;       // steps on the CPU until something touches, made before the comparison on GL begins
  int most = 1000;  // steps on GL at most
};
constexpr Case cases[] = {{"balls", 60, 70}, {"ragdolls", 8, 60},     {"pyramid", 20, 5},
                          {"chain", 20, 5},  {"door", 1, 35},         {"dominoes", 20, 40},
                          {"stack", 10, 5},  {"hulls", 20, 50},       {"chainswing", 20, 40, 15},
                          {"heavy", 2, 5},   {"ballistic", 30, 0, 40}};
constexpr int cpu_steps = 600, gl_steps = 120, gl_mixed_steps = 30;

std::string text(const Case& c, Precision precision) {
  return std::string(c.scene) + " " + std::to_string(c.count) + (precision == Precision::f32 ? ", float" : ", double");
}

/// The hashes after the first, every 60th, and the last step: the first difference tells when.
std::vector<std::uint64_t> hashes(const Case& c, Precision precision, const StepSettings& settings, int steps) {
  SceneWorld s = scene_world(c.scene, c.count, precision);
  Stepper stepper(settings);
  std::vector<std::uint64_t> all;
  for (int i = 0; i < steps; i++) {
    run(s.world, stepper, 1);
    if (i % 60 == 0 || i + 1 == steps) all.push_back(s.world.hash());
  }
  return all;
}

/// A world in the middle of its scene, and the hashes of the steps that follow on the CPU.
struct Middle {
  SceneWorld s;
  std::vector<std::byte> snapshot;
  std::vector<std::uint64_t> hashes;

  Middle(const Case& c, Precision precision, int steps) : s(scene_world(c.scene, c.count, precision)) {
    Stepper stepper(lanes(1));
    run(s.world, stepper, c.before);
    snapshot = s.world.snapshot();
    hashes = hash_each_step(s.world, stepper, steps);
    const bool meets = std::string(c.scene) != "ballistic";
    CHECK((s.world.contact_count() > 0 || s.world.joint_count() > 0) == meets);  // something to solve
    must(s.world.restore(snapshot));
  }
  void rewind() { must(s.world.restore(snapshot)); }
};

/// The first step whose hash differs, or -1.
int first_difference(Middle& m, Stepper& stepper, int steps) {
  m.rewind();
  for (int i = 0; i < steps; i++) {
    run(m.s.world, stepper, 1);
    if (m.s.world.hash() != m.hashes[std::size_t(i)]) return i;
  }
  return -1;
}

void check_mixes(Precision precision, int all_gl, int mixed) {
  require_gl();
  std::vector<Stepper> steppers;  // each compiles its programs once
  for (const Mix& mix : mixes()) steppers.emplace_back(mix.settings());
  for (const Case& c : cases) {
    Middle m(c, precision, std::max(all_gl, mixed));
    for (std::size_t i = 0; i < steppers.size(); i++) {
      INFO(text(c, precision) << ": " << mixes()[i].text());
      CHECK(first_difference(m, steppers[i], std::min(c.most, i == 7 ? all_gl : mixed)) == -1);
    }
  }
}

}  // namespace

TEST_CASE("lanes: 1, 4 and 8 in float have equal hashes over 600 steps") {
  for (const Case& c : cases) {
    INFO(text(c, Precision::f32));
    const auto wanted = hashes(c, Precision::f32, lanes(1), cpu_steps);
    CHECK(hashes(c, Precision::f32, lanes(4), cpu_steps) == wanted);
    CHECK(hashes(c, Precision::f32, lanes(8), cpu_steps) == wanted);
  }
}

// From about step 90 on blocks hold idle contacts beside others, some of which a blow closes within their sub-step
// while they still have the mean of what they held before.
TEST_CASE("lanes: a heap of ragdolls, in which blocks mix contacts of all kinds") {
  const Case heap{"ragdolls", 20, 0};
  const auto wanted = hashes(heap, Precision::f32, lanes(1), 180);
  CHECK(hashes(heap, Precision::f32, lanes(4), 180) == wanted);
  CHECK(hashes(heap, Precision::f32, lanes(8), 180) == wanted);
  CHECK(hashes(heap, Precision::f64, lanes(4), 180) == hashes(heap, Precision::f64, lanes(1), 180));
}

TEST_CASE("lanes: 1 and 4 in double have equal hashes over 600 steps") {
  for (const Case& c : cases) {
    INFO(text(c, Precision::f64));
    CHECK(hashes(c, Precision::f64, lanes(4), cpu_steps) == hashes(c, Precision::f64, lanes(1), cpu_steps));
  }
}

TEST_CASE("threads: 2, 3, 5 and all there are have the hashes of one") {
  constexpr Case large[] = {{"balls", 300, 0}, {"ragdolls", 40, 0}, {"pyramid", 20, 0}, {"hulls", 60, 0}};
  for (const Case& c : large)
    for (const Precision precision : {Precision::f32, Precision::f64}) {
      const auto wanted = hashes(c, precision, lanes(1), 120);
      for (const std::uint32_t threads : {2u, 3u, 5u, 0u}) {
        StepSettings settings = lanes(1);  // short lanes make many pieces
        settings.threads = threads;
        INFO(text(c, precision) << ", threads " << threads);
        CHECK(hashes(c, precision, settings, 120) == wanted);
      }
    }
}

TEST_CASE("run to run: the same hashes, and every step changes them") {
  const auto a = hashes(cases[1], Precision::f32, lanes(0), 200);
  CHECK(a == hashes(cases[1], Precision::f32, lanes(0), 200));
  CHECK(std::adjacent_find(a.begin(), a.end()) == a.end());
}

TEST_CASE("all eight mixes of cpu and gl have equal hashes in float") {
  check_mixes(Precision::f32, gl_steps, gl_mixed_steps);
}
TEST_CASE("all eight mixes of cpu and gl have equal hashes in double") { check_mixes(Precision::f64, 60, 15); }

/// The most sub-steps of a step that it took there.
std::uint32_t check_there(World (*make)(Precision), int steps) {
  std::uint32_t most = 0;
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World here = make(precision), there = make(precision);
    StepSettings settings = lanes(1);
    Stepper cpu(settings);
    settings.set_all(Place::gl);
    Stepper gl(settings);
    for (int i = 0; i < steps; i++) {
      run(here, cpu, 1);
      most = std::max(most, gl.step(there, frame).substeps);
      CHECK(here.hash() == there.hash());
    }
  }
  return most;
}

TEST_CASE("a step of thousands of dispatches: equal hashes") {
  require_gl();
  (void)check_there(crowd_world, 2);
}

TEST_CASE("a step that is made again, for a loop that snaps: equal hashes") {
  require_gl();
  CHECK(check_there(roof_world, 30) == constants::most_loop_substeps);
}

TEST_CASE("another mix and another lane width at every step: the same hash") {
  require_gl();
  const std::vector<Mix> all = mixes();
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const std::uint32_t widths[] = {1, 4, precision == Precision::f32 ? 8u : 0u};
    for (const Case& c : cases) {
      constexpr int steps = 32;
      Middle m(c, precision, steps);
      std::mt19937 random(7);
      Stepper stepper;
      for (int i = 0; i < steps; i++) {
        StepSettings settings = all[random() % 8].settings();
        settings.lanes = widths[i / 8 % 3];
        must(stepper.configure(settings));
        run(m.s.world, stepper, 1);
        INFO(text(c, precision) << ", step " << i);
        REQUIRE(m.s.world.hash() == m.hashes[std::size_t(i)]);
      }
    }
  }
}

TEST_CASE("what is created far away changes nothing here") {
  for (const char* name : {"balls", "ragdolls", "pyramid", "dominoes", "hulls"}) {
    const int count = 6;
    for (const Precision precision : {Precision::f32, Precision::f64}) {
      SceneWorld alone = scene_world(name, count, precision), accompanied = scene_world(name, count, precision);
      const std::vector<BodyId> bodies = alone.world.bodies(), same = accompanied.world.bodies();
      // far away: a pile of its own, spinning, with drag, restitution, a joint, and a body that went again
      World& w = accompanied.world;
      (void)must(w.create_body(fixed_box({1000, -0.5, 0}, {3, 0.5, 3})));
      BodyDef brick;
      brick.shapes = {ShapeDef::box({0.2, 0.3, 0.4})};
      brick.pose.position = {1000, 1, 0};
      brick.angular_velocity = {3, 1, 2};
      brick.linear_drag = brick.angular_drag = 0.1;
      brick.material.restitution = 0.5;
      const BodyId first = must(w.create_body(brick));
      brick.pose.position.y = 2;
      const BodyId second = must(w.create_body(brick));
      JointDef joint;
      joint.a = first;
      joint.b = second;
      joint.frame_a.position = {0, 0.5, 0};
      joint.frame_b.position = {0, -0.5, 0};
      (void)must(w.create_joint(joint));
      const BodyId third = must(w.create_body(brick));
      Stepper a(lanes(0)), b(lanes(0));
      for (int i = 0; i < 150; i++) {
        if (i == 40) must(w.destroy(third));
        if (i == 80) must(w.set_velocity(first, {0, 5, 0}));
        run(alone.world, a, 1);
        run(w, b, 1);
        INFO(std::string(name) << std::string(precision == Precision::f32 ? ", float" : ", double") << ", step " << i);
        REQUIRE((states(alone.world, bodies) == states(w, same)));
      }
    }
  }
}

TEST_CASE("a stepper's past changes nothing: a fresh one goes on alike, at any step") {
  for (const Case& c : cases) {
    SceneWorld kept = scene_world(c.scene, c.count), changed = scene_world(c.scene, c.count);
    Stepper one(lanes(0));
    for (int part = 0; part < 5; part++) {
      Stepper fresh(lanes(0));
      run(kept.world, one, 31);
      run(changed.world, fresh, 31);
      INFO(std::string(c.scene) << ", part " << part);
      REQUIRE(kept.world.hash() == changed.world.hash());
    }
  }
}

TEST_CASE("parity of the scene whose forces are its own kernel: magnets, in all lanes, threads and places") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    check_same_bits(
        [&](const StepSettings& settings, int steps) {
          SceneWorld s = scene_world("magnets", 72, precision);
          Stepper stepper(settings);
          must(scenes::add_kernels(s.scene, s.world, stepper));
          return hash_each_step(s.world, stepper, steps);
        },
        150, 8);
}

TEST_CASE(
    "who steps a world changes nothing: new steppers, steppers in turns, snapshots, lanes, threads and places that "
    "change") {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const Case& c : cases) {
      INFO(text(c, precision));
      const auto in_the_middle = [&] {
        SceneWorld s = scene_world(c.scene, c.count, precision);
        Stepper stepper(lanes(0));
        run(s.world, stepper, c.before);
        return std::move(s.world);
      };
      check_same_ways({.make = in_the_middle}, 120, 16);
    }
}

TEST_CASE("who steps the scene whose forces are its own kernel changes nothing") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    scenes::Scene scene;
    const auto make = [&] {
      SceneWorld s = scene_world("magnets", 72, precision);
      scene = std::move(s.scene);
      return std::move(s.world);
    };
    const auto give = [&](Stepper& stepper, World& world) { must(scenes::add_kernels(scene, world, stepper)); };
    check_same_ways({make, give}, 60, 8);
  }
}

TEST_CASE("steps so short that products come to be subnormal have the same bits on GL") {
  require_gl();
  for (const double dt : {1e-7, 1e-9, 1e-11, 1e-13}) {
    CAPTURE(dt);
    SceneWorld there = scene_world("ragdolls", 2), here = scene_world("ragdolls", 2);
    StepSettings on_gl;
    on_gl.set_all(Place::gl);
    Stepper gl(on_gl), cpu;
    for (SceneWorld* s : {&there, &here})
      must(s->world.set_angular_velocity(s->world.bodies().back(), {1e-12, 3, 1e-20}));
    CHECK(hash_each_step(there.world, gl, 6, dt) == hash_each_step(here.world, cpu, 6, dt));
  }
}
