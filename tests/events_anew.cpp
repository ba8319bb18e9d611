// Pins events that are asked for anew, of what touched or slept before: as a new stepper tells them.
#include <cmath>

#include "support_sleep.h"

using namespace worldtest;

TEST_CASE("asked again after it was switched off: as a new stepper tells it") {
  SceneWorld s = scene_world("stack", 3);
  StepSettings all, none;
  all.contact_events = all.hit_events = all.body_events = true;
  all.sleep = none.sleep = true;
  Stepper stepper(all);
  run(s.world, stepper, 60);
  const auto again = [&](bool step_between) {
    must(stepper.configure(none));
    if (step_between) run(s.world, stepper, 1);
    must(stepper.configure(all));
    run(s.world, stepper, 1);
    return stepper.events();
  };
  for (const bool step_between : {true, false}) {
    const StepEvents e = again(step_between);
    CHECK(e.begun.size() == 3);
    CHECK(e.ended.empty());
    for (const ContactBegun& c : e.begun) CHECK(c.normal.y != 0);
  }
  run(s.world, stepper, 1);
  CHECK(stepper.events().begun.empty());
  run(s.world, stepper, 600);
  REQUIRE(must(s.world.is_asleep(s.scene.bodies.back().id)));
  (void)must(s.world.create_body(ball({50, 50, 0})));  // something goes on
  run(s.world, stepper, 1);
  CHECK(stepper.events().slept.empty());
  CHECK(again(false).slept.size() == 3);
}

TEST_CASE("what sleeps when touches are first asked for is told with where it rests, in a restored world too") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    Towers towers(1, precision), twin(1, precision);
    must(towers.world.destroy(towers.joint));
    must(twin.world.destroy(twin.joint));
    (void)towers.fall_asleep();
    must(twin.world.restore(towers.world.snapshot()));
    StepSettings settings = sleepy();
    settings.contact_events = settings.hit_events = true;
    Stepper stepper(settings);
    run(twin.world, stepper, 1);
    REQUIRE(twin.all_asleep());
    const StepEvents events = stepper.events();
    CHECK(events.hits.empty());
    REQUIRE(events.begun.size() == 3);
    for (const ContactBegun& touch : events.begun)
      CHECK(length(touch.point - Vec3{0, std::round(touch.point.y), 0}) < 0.1);
  }
}
