// Pins: islands at rest fall asleep as a whole and then do not change by a bit; who sleeps is the same in all lanes,
// threads and places, and across a snapshot; what wakes goes on as what never slept.
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "support_sleep.h"
#include "support_ways.h"
#include "world/state.h"

using namespace worldtest;

TEST_CASE("sleep: what is at rest falls asleep, and then no bit of it changes") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Towers t(2, precision);
    const int steps = t.fall_asleep();
    CHECK(steps >= 30);  // half a second
    CHECK(steps < 240);
    for (const BodyId cube : t.cubes) {
      CHECK(must(t.world.velocity(cube)) == Vec3{});
      CHECK(must(t.world.angular_velocity(cube)) == Vec3{});
    }
    const std::uint64_t hash = t.world.hash();
    const std::size_t contacts = t.world.contact_count();
    CHECK(contacts == 6);
    for (int i = 0; i < 100; i++) {
      const StepReport& report = t.stepper.step(t.world, i < 50 ? frame : frame / 3);
      REQUIRE(report);
      CHECK(report.asleep == 6);
      CHECK(report.islands_asleep == 2);
      CHECK((report.woke == 0 && report.fell_asleep == 0));
      CHECK(report.contacts == contacts);
      CHECK(report.points == 24);
      CHECK(report.transfer_bytes == 0);
      CHECK(t.world.hash() == hash);
    }
    CHECK(t.stepper.plan().entries.empty());
    const auto& out = t.stepper.plan().left_out;
    for (const char* what : {"integrate", "joints", "collision", "impulses"})
      CHECK(std::ranges::any_of(out, [&](const LeftOut& l) { return l.what == what && l.why == "all bodies sleep"; }));
    const StepPlan asked = must(t.stepper.plan_for(t.world, frame));
    CHECK(asked == t.stepper.plan());
  }
}

TEST_CASE("sleep: with it off nothing sleeps, and a step with it off wakes what does") {
  Towers t;
  Stepper awake;
  World other = std::move(Towers().world);
  run(other, awake, 200);
  CHECK(awake.step(other, frame).asleep == 0);

  t.fall_asleep();
  StepSettings s = t.stepper.settings();
  s.sleep = false;
  must(t.stepper.configure(s));
  CHECK(t.stepper.step(t.world, frame).asleep == 0);
  for (int i = 0; i < 6; i++) CHECK(!t.asleep(i));
}

TEST_CASE("sleep: no island sleeps by halves, in a pile that comes to rest") {
  std::uint32_t most = 0, woke = 0;
  for (const auto& pair : {std::pair("hulls", 30), std::pair("dominoes", 20), std::pair("ragdolls", 3)}) {
    const char* scene = pair.first;
    INFO(scene);
    SceneWorld s = scene_world(scene, pair.second);
    StepSettings settings = sleepy();
    settings.sleep_time = 0.1;
    settings.sleep_speed = 0.05;
    settings.sleep_spin = 0.2;
    Stepper stepper(settings);
    for (int i = 0; i < 300; i++) {
      const StepReport& report = stepper.step(s.world, frame);
      REQUIRE(report);
      most = std::max(most, report.asleep);
      woke += report.woke;
      const auto same = [&](BodyId a, BodyId b) {
        if (must(s.world.kind(a)) == BodyKind::fixed || must(s.world.kind(b)) == BodyKind::fixed) return true;
        return must(s.world.is_asleep(a)) == must(s.world.is_asleep(b));
      };
      for (const Contact& c : s.world.contacts()) CHECK(same(c.a, c.b));
      for (const JointId joint : s.world.joints())
        CHECK(same(must(s.world.joint(joint)).a, must(s.world.joint(joint)).b));
    }
  }
  CHECK(most > 10);
  CHECK(woke > 10);
}

TEST_CASE("sleep: equal hashes in lanes, threads, on GL and in all mixes") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    INFO((precision == Precision::f32 ? "float" : "double"));
    std::uint32_t fell = 0, woke = 0;
    const auto hashes_of = [&](const StepSettings& given, int steps) {
      Towers t(2, precision);
      (void)add_chain(t.world, {20, 5, 0}, 3, false, {});
      BodyDef shot = ball({-7, 2.5, 0}, 0.2);
      shot.velocity = {8, 1, 0};
      (void)must(t.world.create_body(shot));
      StepSettings settings = sleepy(given);
      settings.sleep_time = 0.15;
      Stepper stepper(settings);
      std::vector<std::uint64_t> all;
      fell = woke = 0;
      for (int i = 0; i < steps; i++) {
        const StepReport& report = stepper.step(t.world, frame);
        REQUIRE(report);
        fell += report.fell_asleep;
        woke += report.woke;
        all.push_back(t.world.hash());
      }
      return all;
    };
    check_same_bits(hashes_of, 90, 70);
    CHECK(fell > 0);
    CHECK(woke > 0);
  }
}

TEST_CASE("sleep: equal hashes whoever steps") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const auto make = [&] {
      Towers t(2, precision);
      (void)add_chain(t.world, {20, 5, 0}, 3, false, {});
      BodyDef shot = ball({-7, 2.5, 0}, 0.2);
      shot.velocity = {8, 1, 0};
      (void)must(t.world.create_body(shot));
      return std::move(t.world);
    };
    StepSettings settings = sleepy();
    settings.sleep_time = 0.15;
    check_same_ways({.make = make, .settings = settings}, 90, 40);
  }
}

TEST_CASE("sleep: a snapshot brings back who sleeps, and goes on alike") {
  const auto shoot = [](World& world) {
    BodyDef shot = ball({-7, 2.5, 0}, 0.2);
    shot.velocity = {12, 2, 0};
    shot.can_sleep = false;
    return must(world.create_body(shot));
  };
  Towers a, b;
  (void)shoot(a.world);
  (void)shoot(b.world);
  StepSettings settings = sleepy();
  settings.sleep_time = 0.2;
  must(a.stepper.configure(settings));
  must(b.stepper.configure(settings));
  for (const int steps : {5, 20, 40, 80}) {
    run(a.world, a.stepper, steps);
    const std::vector<std::byte> now = a.world.snapshot();
    must(b.world.restore(now));
    CHECK(b.world.hash() == a.world.hash());
    Stepper fresh(settings);
    World* world = &b.world;
    for (int i = 0; i < 40; i++) {
      run(*world, fresh, 1);
      run(a.world, a.stepper, 1);
      CHECK(world->hash() == a.world.hash());
    }
    must(a.world.restore(now));
    run(a.world, a.stepper, 40);
    CHECK(world->hash() == a.world.hash());
    CHECK(must(a.world.is_asleep(a.cubes[4])) == must(b.world.is_asleep(b.cubes[4])));
  }
  // the host's change is in it, too
  must(a.world.set_pose(a.floors[1], {{10, -0.6, 0}, {}}));
  must(b.world.restore(a.world.snapshot()));
  CHECK(b.world.hash() == a.world.hash());
  Stepper fresh(settings);
  CHECK(fresh.step(b.world, frame).woke == a.stepper.step(a.world, frame).woke);
  CHECK(b.world.hash() == a.world.hash());
}

TEST_CASE("sleep: the order of ids does not change when what sleeps") {
  const auto towers = [](bool turned) {
    World world;
    std::vector<std::vector<BodyId>> found(3);
    for (int i = 0; i < 3; i++) {
      const int k = turned ? 2 - i : i;
      (void)must(world.create_body(fixed_box({10.0 * k, -0.5, 0}, {2, 0.5, 2})));
      for (int j = 0; j <= k; j++)
        found[std::size_t(k)].push_back(must(world.create_body(cube({10.0 * k, 0.5 + 1.001 * j, 0}))));
    }
    Stepper stepper(sleepy());
    std::vector<int> when(3, 0);
    for (int step = 1; step < 200; step++) {
      run(world, stepper, 1);
      for (std::size_t k = 0; k < 3; k++)
        if (when[k] == 0 && must(world.is_asleep(found[k][0]))) when[k] = step;
    }
    return when;
  };
  const std::vector<int> one = towers(false);
  CHECK(one[2] > 0);
  CHECK(one == towers(true));
}

TEST_CASE("sleep: what a hit wakes goes on as what never slept") {
  const auto hit = [](bool sleep) {
    Towers t(1);
    StepSettings settings = t.stepper.settings();
    settings.sleep = sleep;
    must(t.stepper.configure(settings));
    run(t.world, t.stepper, 180);
    CHECK(t.asleep(0) == sleep);
    BodyDef shot = ball({-3, 1.6, 0.1}, 0.2);
    shot.velocity = {10, 0, 0};
    shot.mass = 400;
    t.cubes.push_back(must(t.world.create_body(shot)));
    run(t.world, t.stepper, 30);
    return states(t.world, t.cubes);
  };
  const std::vector<BodyState> slept = hit(true), never = hit(false);
  CHECK(length(never[2].pose.position - Vec3{0, 2.5, 0}) > 0.1);  // it was one
  for (std::size_t i = 0; i < slept.size(); i++) {
    INFO(i);
    CHECK(length(slept[i].pose.position - never[i].pose.position) < 5e-3);
    CHECK(length(slept[i].velocity - never[i].velocity) < 5e-2);
  }
}

TEST_CASE("sleep: waking keeps the tower where it stood") {
  Towers t;
  t.fall_asleep();
  const std::vector<BodyState> before = states(t.world, t.cubes);
  must(t.world.wake(t.cubes[0]));
  for (int i = 0; i < 60; i++) {
    run(t.world, t.stepper, 1);
    const std::vector<BodyState> now = states(t.world, t.cubes);
    for (std::size_t k = 0; k < now.size(); k++) CHECK(length(now[k].pose.position - before[k].pose.position) < 1e-4);
  }
  CHECK(t.all_asleep());
}

TEST_CASE("sleep: a step that fails wakes nobody") {
  Towers t;
  t.fall_asleep();
  (void)must(t.world.create_body(ball({30, 0, 0})));  // a world that sleeps as a whole looks for no pairs
  must(t.world.wake(t.cubes[0]));
  StepSettings settings = t.stepper.settings();
  settings.max_pairs = 1;
  must(t.stepper.configure(settings));
  const Fingerprint before = fingerprint(t.world);
  CHECK(step_status(t.stepper, t.world).error().code == ErrorCode::buffer_full);
  CHECK(fingerprint(t.world) == before);
  settings.max_pairs = 1000;
  must(t.stepper.configure(settings));
  const StepReport& report = t.stepper.step(t.world, frame);
  CHECK(report.woke == 3);
  CHECK(report.asleep == 3);
}

TEST_CASE("sleep: settings out of range are refused") {
  Stepper stepper;
  for (double StepSettings::*const field :
       {&StepSettings::sleep_speed, &StepSettings::sleep_spin, &StepSettings::sleep_time})
    for (const double value : {-1.0, std::nan(""), HUGE_VAL}) {
      StepSettings s;
      s.*field = value;
      const Status status = stepper.configure(s);
      REQUIRE(!status);
      CHECK(status.error().code == ErrorCode::bad_argument);
    }
  StepSettings s;
  s.sleep_time = 0;
  CHECK(!stepper.configure(s));
}

TEST_CASE("sleep: bodies that float at rest sleep, on every backend alike; those that drift do not") {
  require_gl();
  for (const Place place : {Place::cpu, Place::gl}) {
    World world({Precision::f32, {}});
    const BodyId still = must(world.create_body(ball({}))), drifts = must(world.create_body(ball({5, 0, 0})));
    must(world.set_velocity(drifts, {0, 0.03, 0}));
    StepSettings settings = sleepy();
    settings.set_all(place);
    Stepper stepper(settings);
    run(world, stepper, 29);
    CHECK(!must(world.is_asleep(still)));
    run(world, stepper, 2);
    CHECK(must(world.is_asleep(still)));
    run(world, stepper, 100);
    CHECK(!must(world.is_asleep(drifts)));
  }
}

// The time that a body had been quiet for was one that the next snapshot could not hold.
TEST_CASE("sleep: a time too short for a step to see is none") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world({precision, {}});
    const BodyId still = must(world.create_body(ball({})));
    StepSettings settings = sleepy();
    settings.sleep_time = 1e-320;
    Stepper stepper(settings);
    run(world, stepper, 2);
    CHECK(must(world.is_asleep(still)));
    must(world.restore(world.snapshot()));
  }
}

// A step that is made anew, since a body left the range of numbers in it, took whom the host had stirred for woken:
// they slept on, and moved.
TEST_CASE("sleep: who is stirred wakes in a step that freezes another") {
  World world({Precision::f32, {}});
  const BodyId still = must(world.create_body(ball({}))), odd = must(world.create_body(ball({5, 0, 0})));
  const BodyId one = must(world.create_body(ball({20, 0, 0}))), two = must(world.create_body(ball({22, 0, 0})));
  (void)must(world.create_joint(pin(one, {1, 0, 0}, two, {-1, 0, 0})));  // the step is no flight
  must(world.set_can_sleep(one, false));
  must(world.set_mass_properties(odd, {1e-30, {1e-30, 1e-30, 1e-30}}));
  StepSettings settings = sleepy();
  settings.sleep_time = 0.01;
  Stepper stepper(settings);
  run(world, stepper, 2);
  REQUIRE(must(world.is_asleep(still)));
  must(world.set_velocity(still, {1, 0, 0}));
  (void)must(world.add_force(odd, Wrench{{1e15, 0, 0}, {}}));
  const StepReport& report = stepper.step(world, frame);
  REQUIRE(report);
  CHECK(report.frozen == std::vector{odd});
  CHECK(!must(world.is_asleep(still)));
  CHECK(must(world.pose(still)).position.x > 0.9 * frame);
}

// What a step freezes was counted among what moved in it and came to rest: it slept and stood, and steps reported it
// asleep.
TEST_CASE("sleep: what is frozen stands, and does not sleep") {
  require_gl();
  for (const Place place : {Place::cpu, Place::gl}) {
    World world({Precision::f32, {}});
    const BodyId still = must(world.create_body(ball({}))), odd = must(world.create_body(ball({5, 0, 0})));
    must(world.set_mass_properties(odd, {1e-30, {1e-30, 1e-30, 1e-30}}));
    (void)must(world.add_force(odd, Wrench{{1e15, 0, 0}, {}}));
    StepSettings settings = sleepy();
    settings.sleep_time = 0.01;
    settings.set_all(place);
    Stepper stepper(settings);
    const StepReport& report = stepper.step(world, frame);
    REQUIRE(report);
    CHECK(report.frozen == std::vector{odd});
    CHECK(report.asleep == 1);
    CHECK(must(world.is_asleep(still)));
    CHECK(!must(world.is_asleep(odd)));
    WorldState& state = world.state();
    state.freeze(state.body_ids.row(still.index));  // as a step does with one that slept when it began
    CHECK(!must(world.is_asleep(still)));
    CHECK(state.sleepers == 0);
  }
}
