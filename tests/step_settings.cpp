// Pins what a step answers: its report, and every setting it refuses, by code and sentence, with the world the
// same to the bit; capacities to the pair: one under is refused and says what is needed, exactly enough works.
#include <cmath>
#include <limits>
#include <utility>

#include "collision/hook.h"
#include "pcphys/fcl.h"
#include "support_world.h"

using namespace worldtest;

namespace {

StepSettings with(auto&& change) {
  StepSettings s;
  s.timings = false;
  change(s);
  return s;
}

}  // namespace

TEST_CASE("report: counts of bodies, joints, pairs, contacts, points, colours, steps") {
  World world;
  Stepper stepper;
  const StepReport* report = &stepper.step(world, frame);
  CHECK(*report);
  CHECK(report->step == 1);
  CHECK(report->bodies == 0);
  (void)must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
  BodyDef box;
  box.shapes = {ShapeDef::box({0.5, 0.5, 0.5})};
  box.pose.position = {-2, 0.5, 0};
  (void)must(world.create_body(box));
  const BodyId b = must(world.create_body(ball({2, 0.5, 0})));
  JointDef joint;
  joint.a = world.ground();
  joint.b = b;
  joint.frame_a.position = {2, 0.5, 0};
  (void)must(world.create_joint(joint));
  report = &stepper.step(world, frame);
  CHECK(*report);
  CHECK(report->step == 2);
  CHECK(report->bodies == 3);
  CHECK(report->joints == 1);
  CHECK(report->pairs == 2);
  CHECK(report->contacts == 2);
  CHECK(report->points == 5);   // four corners of the box, one of the ball
  CHECK(report->colours == 2);  // one of trees, one of what is free
  CHECK(world.contact_count() == 2);
  CHECK(report->transfer_bytes == 0);
  CHECK(report->total_ms > 0);
  double sum = 0;
  for (double ms : report->ms) {
    CHECK(ms >= 0);
    sum += ms;
  }
  CHECK(sum <= report->total_ms);
  // a refused step counts for nothing, and the next one goes on
  CHECK_FALSE(stepper.step(world, -1));
  CHECK(stepper.step(world, frame).step == 3);
}

TEST_CASE("report: sub-steps that were made, more of them under a heavy load") {
  const auto substeps = [](double density, std::uint32_t refinement, double height = 1.5) {
    World world;
    (void)must(world.create_body(fixed_box({0, -0.5, 0}, {5, 0.5, 5})));
    BodyDef box;
    box.shapes = {ShapeDef::box({0.5, 0.5, 0.5})};
    box.pose.position = {0, 0.5, 0};
    box.density = 1;
    (void)must(world.create_body(box));
    box.pose.position = {0, height, 0};
    box.density = density;
    (void)must(world.create_body(box));
    Stepper stepper(with([=](StepSettings& s) { s.refinement = refinement; }));
    const StepReport& report = stepper.step(world, frame);
    REQUIRE(report);
    return report.substeps;
  };
  CHECK(substeps(10, 16) == 4);         // little
  CHECK(substeps(100, 16) == 4);        // still less than 15 mm
  CHECK(substeps(300, 16) == 32);       // enough for 0.5 mm
  CHECK(substeps(1000, 16) == 64);      // 16 times at most
  CHECK(substeps(1000, 4) == 16);       // or what the setting says
  CHECK(substeps(1000, 1) == 4);        // never
  CHECK(substeps(1000, 16, 2.5) == 4);  // it does not touch yet
  CHECK(substeps(1e-3, 16) == 4);       // light on heavy
}

TEST_CASE("names of timers") {
  const char* names[] = {"forces", "broad", "narrow", "plan", "upload", "integrate", "joints", "impulses", "download"};
  CHECK(std::size(names) == std::size_t(Timer::count));
  for (std::size_t i = 0; i < std::size(names); i++) CHECK(std::string(name(Timer(i))) == names[i]);
}

TEST_CASE("a time step that is none is refused") {
  SceneWorld s = scene_world("stack", 2);
  Stepper stepper;
  run(s.world, stepper, 3);
  for (double dt : {0.0, -1.0, std::nan(""), double(INFINITY), -double(INFINITY), -0.0})
    CHECK_REFUSED(s.world, step_status(stepper, s.world, dt), ErrorCode::bad_time_step,
                  "it must be finite and above zero. The world is as it was.");
}

TEST_CASE("settings that are refused, by a step and by configure") {
  struct Case {
    StepSettings settings;
    ErrorCode code;
    const char* words;
  };
  const Case cases[] = {
      {with([](StepSettings& s) { s.substeps = 0; }), ErrorCode::bad_time_step,
       "The number of sub-steps is 0; it must lie between 1 and 1000."},
      {with([](StepSettings& s) { s.substeps = 1001; }), ErrorCode::bad_time_step, "The number of sub-steps is 1001"},
      {with([](StepSettings& s) { s.threads = 257; }), ErrorCode::bad_argument, "The number of threads is 257"},
      {with([](StepSettings& s) { s.lanes = 3; }), ErrorCode::unavailable, "lanes"},
      {with([](StepSettings& s) { s.push_speed = std::nan(""); }), ErrorCode::bad_argument,
       "must be finite and not below zero."},
      {with([](StepSettings& s) { s.push_speed = -1; }), ErrorCode::bad_argument, "must be finite and not below zero."},
      {with([](StepSettings& s) { s.restitution_threshold = -1; }), ErrorCode::bad_argument,
       "must be finite and not below zero."},
      {with([](StepSettings& s) { s.refinement = 0; }), ErrorCode::bad_argument,
       "must lie between 1 (never) and 1000."},
      {with([](StepSettings& s) { s.contact_margin = INFINITY; }), ErrorCode::bad_argument,
       "must be finite and not below zero."},
  };
  for (const Case& c : cases) {
    INFO(std::string(c.words));
    SceneWorld s = scene_world("stack", 2);
    Stepper good;
    run(s.world, good, 3);
    Stepper bad(c.settings);
    CHECK_REFUSED(s.world, step_status(bad, s.world), c.code, c.words);
    CHECK_REFUSED(s.world, good.configure(c.settings), c.code, c.words);
    // the settings are as they were, and steps go on
    CHECK(good.settings().substeps == 4);
    CHECK(good.settings().lanes == 0);
    CHECK(good.settings().threads == 1);
    run(s.world, good, 1);
  }
}

TEST_CASE("lanes that a precision does not have, and devices that are not there") {
  SceneWorld f64 = scene_world("stack", 2, Precision::f64), f32 = scene_world("stack", 2);
  Stepper eight(lanes(8));
  CHECK_REFUSED(f64.world, step_status(eight, f64.world), ErrorCode::unavailable,
                "There are no kernels of 8 lanes in double (1 or 4 with AVX2) for this processor; use lanes 0 for the "
                "widest it has.");
  CHECK(step_status(eight, f32.world));
  for (const Mix& mix : mixes()) {
    StepSettings s = mix.settings();
    s.device = 99;
    Stepper stepper(s);
    if (std::find(mix.places.begin(), mix.places.end(), Place::gl) == mix.places.end()) {
      CHECK(step_status(stepper, f32.world));
    } else {
      INFO(mix.text());
      CHECK_REFUSED(f32.world, step_status(stepper, f32.world), ErrorCode::unavailable, "99");
      CHECK(stepper.device(Place::gl).empty());
    }
  }
}

TEST_CASE("a host's context that is not there is refused, not replaced") {
  SceneWorld s = scene_world("stack", 2);
  StepSettings settings;
  settings.set_all(Place::gl);
  settings.host_context = true;
  Stepper stepper(settings);
  CHECK_REFUSED(s.world, step_status(stepper, s.world), ErrorCode::device_error,
                "No GL context is current on this thread; make the host's context current, or ask for a headless one.");
}

TEST_CASE(
    "FCL as the narrow phase is refused until it was asked for; then a scene stands, and native steps may follow") {
  const NarrowHook kept = std::exchange(fcl_hook(), NarrowHook{});
  SceneWorld s = scene_world("stack", 4);
  const StepSettings fcl = with([](StepSettings& x) { x.narrow = NarrowPhase::fcl; });
  Stepper stepper(fcl), native;
  run(s.world, native, 2);
  const char* words = "FCL is not in use: link pcphys::fcl and call pcphys::use_fcl()";
  CHECK_REFUSED(s.world, step_status(stepper, s.world), ErrorCode::unavailable, words);
  CHECK_REFUSED(s.world, native.configure(fcl), ErrorCode::unavailable, words);
  if (const Status there = use_fcl()) {
    run(s.world, stepper, 120);
    for (const scenes::SceneBody& b : s.scene.bodies)
      CHECK(length(must(s.world.pose(b.id)).position - b.start.position) < 0.05);
    must(stepper.configure(with([](StepSettings&) {})));
    run(s.world, stepper, 30);
  } else {
    check_refused(false, there.error(), ErrorCode::unavailable, "FCL");
  }
  fcl_hook() = kept;
}

TEST_CASE("pairs: one more than there is room for is refused and says the number; exactly enough works") {
  for (const char* name : {"pyramid", "ragdolls"}) {
    SceneWorld s = scene_world(name, name[0] == 'p' ? 5 : 1);
    Stepper before;
    run(s.world, before, 60);
    const std::vector<std::byte> here = s.world.snapshot();
    // how many a stepper lists depends on what it has seen: these are a fresh one's
    Stepper free_stepper;
    const std::uint32_t needed = free_stepper.step(s.world, frame).pairs;
    const std::uint64_t wanted = s.world.hash();
    REQUIRE(needed > 3);
    for (const std::size_t capacity : {std::size_t(0), std::size_t(1), std::size_t(needed) - 1}) {
      must(s.world.restore(here));
      StepSettings settings;
      settings.max_pairs = capacity;
      Stepper stepper(settings);
      CHECK_REFUSED(s.world, step_status(stepper, s.world), ErrorCode::buffer_full,
                    "raise StepSettings::max_pairs, or spread the bodies. The world is as before the step.");
      // "The scene has N [or fewer] pairs of shapes close together and room for M"
      const StepReport& report = stepper.step(s.world, frame);
      const std::string text = report.error.message;
      INFO(text);
      CHECK(report.step == 0);
      CHECK(text.find("room for " + std::to_string(capacity) + ";") != std::string::npos);
      const std::size_t said = std::stoul(text.substr(text.find("has ") + 4));
      CHECK(said >= needed);
      if (text.find("or fewer") == std::string::npos) CHECK(said == needed);
      // raised to what it said, the same stepper goes on as if nothing had been
      settings.max_pairs = said;
      must(stepper.configure(settings));
      run(s.world, stepper, 1);
      CHECK(s.world.hash() == wanted);
    }
    for (const std::size_t capacity : {std::size_t(needed), std::size_t(needed) + 1}) {
      must(s.world.restore(here));
      StepSettings settings;
      settings.max_pairs = capacity;
      Stepper stepper(settings);
      run(s.world, stepper, 1);
      CHECK(s.world.hash() == wanted);
    }
  }
}

TEST_CASE("configure takes effect at the next step, in the middle of a run") {
  SceneWorld s = scene_world("stack", 3);
  Stepper stepper;
  run(s.world, stepper, 5);
  CHECK(stepper.plan().substeps == 4);
  must(stepper.configure(with([](StepSettings& x) {
    x.substeps = 8;
    x.lanes = 1;
  })));
  CHECK(stepper.plan().substeps == 4);
  run(s.world, stepper, 1);
  CHECK(stepper.plan().substeps == 8);
  CHECK(stepper.device(Place::cpu) == "cpu, scalar");
  CHECK(stepper.step(s.world, frame).step == 7);
}

TEST_CASE("a change of the time step or of sub-steps in the middle of a run: rest stays rest, fall stays fall") {
  // remembered impulses scale with the sub-step: a stack that stands does not notice
  SceneWorld s = scene_world("stack", 4);
  Stepper stepper;
  run(s.world, stepper, 240);
  std::vector<Vec3> before;
  for (BodyId body : s.world.bodies()) before.push_back(must(s.world.pose(body)).position);
  for (std::uint32_t substeps : {2u, 8u, 4u}) {
    must(stepper.configure(with([&](StepSettings& x) { x.substeps = substeps; })));
    run(s.world, stepper, 20, substeps == 4 ? frame : frame / 2);
  }
  std::size_t i = 0;
  for (BodyId body : s.world.bodies()) CHECK(length(must(s.world.pose(body)).position - before[i++]) < 5e-3);

  World world(WorldDef{Precision::f64, {0, -10, 0}});
  const BodyId body = must(world.create_body(ball({})));
  Stepper falling;
  double t = 0;
  for (double dt : {0.01, 0.02, 0.005, 0.03}) {
    must(falling.configure(with([&](StepSettings& x) { x.substeps = dt > 0.015 ? 3 : 1; })));
    run(world, falling, 3, dt);
    t += 3 * dt;
  }
  CHECK(must(world.velocity(body)).y == doctest::Approx(-10 * t).epsilon(1e-12));
  CHECK(must(world.pose(body)).position.y == doctest::Approx(-5 * t * t).epsilon(1e-12));
}

TEST_CASE("one stepper may serve several worlds in turn, cpu and gl, and worlds that come and go") {
  require_gl();
  for (const Place place : {Place::cpu, Place::gl}) {
    StepSettings settings;
    settings.set_all(place);
    const auto alone = [&](const char* name, int count, int steps) {
      SceneWorld s = scene_world(name, count);
      Stepper own(settings);
      run(s.world, own, steps);
      return s.world.hash();
    };
    const auto push = [](World& world) {
      for (BodyId body : world.bodies())
        if (must(world.kind(body)) == BodyKind::dynamic) must(world.set_velocity(body, {0.5, 0, 0}));
    };
    Stepper shared(settings);
    // the same structure at other places in the same steps: what was kept for one must not serve the other
    SceneWorld a = scene_world("stack", 3), b = scene_world("stack", 3);
    push(b.world);
    SceneWorld b_alone = scene_world("stack", 3);
    push(b_alone.world);
    for (int i = 0; i < 15; i++) {
      run(a.world, shared, 1);
      run(b.world, shared, 1);
    }
    Stepper own(settings);
    run(b_alone.world, own, 15);
    CHECK(a.world.hash() == alone("stack", 3, 15));
    CHECK(b.world.hash() == b_alone.world.hash());
    // one after the other, at the same address as likely as not
    for (const char* name : {"stack", "pyramid", "stack", "chain"}) {
      SceneWorld s = scene_world(name, 3);
      run(s.world, shared, 10);
      CHECK(s.world.hash() == alone(name, 3, 10));
    }
  }
}

TEST_CASE("one stepper may serve both precisions in turn") {
  Stepper shared;
  SceneWorld f = scene_world("stack", 3), d = scene_world("stack", 3, Precision::f64),
             f_alone = scene_world("stack", 3), d_alone = scene_world("stack", 3, Precision::f64);
  for (int i = 0; i < 10; i++) {
    run(f.world, shared, 1);
    run(d.world, shared, 1);
  }
  Stepper own_f, own_d;
  run(f_alone.world, own_f, 10);
  run(d_alone.world, own_d, 10);
  CHECK(f.world.hash() == f_alone.world.hash());
  CHECK(d.world.hash() == d_alone.world.hash());
}
