// Pins what wakes an island that sleeps: whatever the host or another body does to one of it wakes all of it, and
// nothing else does.
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "support_sleep.h"

using namespace worldtest;

TEST_CASE("sleep: whatever the host changes of a body wakes its island, whole, and no other") {
  struct Way {
    const char* name;
    std::function<void(Towers&)> act;
    int woke = 3;
  };
  const MassProperties heavy{2000, {300, 300, 300}};
  const Way ways[] = {
      {"wake", [](Towers& t) { must(t.world.wake(t.cubes[2])); }},
      {"set_pose",
       [](Towers& t) {
         must(t.world.set_pose(t.cubes[2], {{0, 2.5, 0.001}, {}}));
       }},
      {"set_velocity",
       [](Towers& t) {
         must(t.world.set_velocity(t.cubes[1], {0, 0.1, 0}));
       }},
      {"set_angular_velocity",
       [](Towers& t) {
         must(t.world.set_angular_velocity(t.cubes[2], {0, 0.1, 0}));
       }},
      {"set_position_last",
       [](Towers& t) {
         must(t.world.set_position_last(t.cubes[2], {0, 2.49, 0}));
       }},
      {"set_orientation_last",
       [](Towers& t) {
         must(t.world.set_orientation_last(t.cubes[2], {0, 0.001, 0, 1}));
       }},
      {"mass", [&](Towers& t) { must(t.world.set_mass_properties(t.cubes[0], heavy)); }},
      {"material", [](Towers& t) { must(t.world.set_material(t.cubes[0], {.static_friction = 0.1})); }},
      {"material of the floor", [](Towers& t) { must(t.world.set_material(t.floors[0], {.static_friction = 0.1})); }},
      {"drag", [](Towers& t) { must(t.world.set_drag(t.cubes[0], 1, 1)); }},
      {"filter",
       [](Towers& t) {
         must(t.world.set_filter(t.cubes[0], {2, 3, 0}));
       }},
      {"filter of the floor",
       [](Towers& t) {
         must(t.world.set_filter(t.floors[0], {1, 0, 0}));
       }},
      {"collide", [](Towers& t) { must(t.world.set_collide(t.floors[0], t.cubes[0], false)); }},
      {"force",
       [](Towers& t) {
         (void)must(t.world.add_force(t.cubes[2], Wrench{{0, 1, 0}, {}}));
       }},
      {"callback",
       [](Towers& t) {
         (void)must(t.world.add_force(t.cubes[2], [](const World&, BodyId) { return Wrench{{0, 1, 0}, {}}; }));
       }},
      {"gravity",
       [](Towers& t) {
         must(t.world.set_gravity({0, -9, 0}));
       },
       6},
      {"new joint",
       [](Towers& t) {
         (void)must(t.world.create_joint(pin(t.world.ground(), {0, 3, 0}, t.cubes[2], {0, 0.5, 0})));
       }},
      {"new spring",
       [](Towers& t) {
         SpringDef def;
         def.a = t.world.ground();
         def.b = t.cubes[2];
         def.stiffness = 1;
         (void)must(t.world.create_spring(def));
       }},
      {"no joint", [](Towers& t) { must(t.world.destroy(t.joint)); }},
      {"motor",
       [](Towers& t) {
         must(t.world.set_motor(t.joint, {1, 10}));
       }},
      {"spring of a joint",
       [](Towers& t) {
         must(t.world.set_spring(t.joint, AngularSpring{1, 0, {}}));
       }},
      {"may not sleep", [](Towers& t) { must(t.world.set_can_sleep(t.cubes[0], false)); }},
      {"the floor moves",
       [](Towers& t) {
         must(t.world.set_pose(t.floors[0], {{0, -0.6, 0}, {}}));
       }},
      {"the floor goes", [](Towers& t) { must(t.world.destroy(t.floors[0])); }},
      {"the lowest cube goes", [](Towers& t) { must(t.world.destroy(t.cubes[0])); }, 2},
      {"a body comes into touch",
       [](Towers& t) {
         (void)must(t.world.create_body(cube({0, 3.499, 0})));
       }},
      {"a fixed body does",
       [](Towers& t) {
         (void)must(t.world.create_body(fixed_box({0, 3.49, 0}, {0.5, 0.5, 0.5})));
       }},
      {"a fixed body is put there",
       [](Towers& t) {
         must(t.world.set_pose(t.floors[1], {{2.45, 0.5, 0}, {}}));
       },
       6},
      // what wakes nobody
      {"a body comes elsewhere",
       [](Towers& t) {
         (void)must(t.world.create_body(cube({30, 3, 0})));
       },
       0},
      {"a fixed body does",
       [](Towers& t) {
         (void)must(t.world.create_body(fixed_box({30, 3, 0}, {0.5, 0.5, 0.5})));
       },
       0},
      {"boxes that overlap alone",
       [](Towers& t) {
         (void)must(t.world.create_body(ball({0.9, 3.4, 0.9}, 0.5)));
       },
       0},
      {"a body far away may not sleep",
       [](Towers& t) {
         BodyDef def = ball({50, 0, 0});
         def.can_sleep = false;
         (void)must(t.world.create_body(def));
       },
       0},
  };
  for (const Way& way : ways) {
    INFO(way.name);
    Towers t;
    t.fall_asleep();
    way.act(t);
    const StepReport& report = t.stepper.step(t.world, frame);
    REQUIRE(report);
    CHECK(report.woke == std::uint32_t(way.woke));
    CHECK(report.asleep == (t.world.valid(t.cubes[0]) ? 6 : 5) - std::uint32_t(way.woke));
    CHECK(report.islands_asleep == 2 - (way.woke + 1) / 3);
  }
}

TEST_CASE("sleep: what hangs on a fixed body by a joint or a spring wakes when that one is moved") {
  for (const bool spring : {false, true}) {
    World world;
    const BodyId hook = must(world.create_body(fixed_box({0, 5, 0}, {0.1, 0.1, 0.1})));
    const BodyId weight = must(world.create_body(cube({0, 3, 0}))), far = must(world.create_body(cube({10, 3, 0})));
    (void)must(world.create_joint(pin(world.ground(), {10, 5, 0}, far, {0, 2, 0})));
    if (spring) {
      SpringDef def;
      def.a = hook;
      def.b = weight;
      def.rest_length = 2;
      def.stiffness = 1e5;
      def.damping = 1e4;
      (void)must(world.create_spring(def));
    } else {
      (void)must(world.create_joint(pin(hook, {}, weight, {0, 2, 0})));
    }
    Stepper stepper(sleepy());
    run(world, stepper, 300);
    REQUIRE(must(world.is_asleep(weight)));
    must(world.set_pose(hook, {{0.5, 5, 0}, {}}));
    run(world, stepper, 30);
    CHECK(!must(world.is_asleep(weight)));
    CHECK(must(world.pose(weight)).position.x > 0.1);
    CHECK(must(world.is_asleep(far)));
  }
}

TEST_CASE("sleep: a body that the host has woken says so before the step") {
  Towers t;
  t.fall_asleep();
  must(t.world.set_velocity(t.cubes[0], {1, 0, 0}));
  CHECK(!t.asleep(0));
  run(t.world, t.stepper, 1);
  CHECK(!t.asleep(2));
  CHECK(t.asleep(3));
}

TEST_CASE("sleep: a hit wakes, a miss does not") {
  for (const double height : {2.5, 4.2}) {
    Towers t;
    t.fall_asleep();
    BodyDef shot = ball({-8, height, 0}, 0.2);
    shot.velocity = {30, 1, 0};
    (void)must(t.world.create_body(shot));
    std::uint32_t woke = 0;
    for (int i = 0; i < 18; i++) woke += t.stepper.step(t.world, frame).woke;
    CHECK(woke == (height < 3 ? 3 : 0));
    CHECK(t.asleep(3));
  }
}

TEST_CASE("sleep: kinematic bodies carry islands, and sleep only where they stand still") {
  World world;
  BodyDef platform = fixed_box({0, -0.5, 0}, {2, 0.5, 2});
  platform.kind = BodyKind::kinematic;
  const BodyId floor = must(world.create_body(platform)), box = must(world.create_body(cube({0, 0.5, 0})));
  Stepper stepper(sleepy());
  must(world.set_velocity(floor, {0, 0.001, 0}));
  run(world, stepper, 120);
  CHECK(!must(world.is_asleep(box)));
  must(world.set_velocity(floor, {}));
  run(world, stepper, 120);
  CHECK(must(world.is_asleep(box)));
  CHECK(must(world.is_asleep(floor)));
  must(world.set_velocity(floor, {0.5, 0, 0}));
  run(world, stepper, 60);
  CHECK(must(world.pose(box)).position.x == doctest::Approx(0.5).epsilon(0.05));

  must(world.set_velocity(floor, {}));
  run(world, stepper, 120);
  CHECK(must(world.is_asleep(box)));
  BodyDef pusher = fixed_box({-1.6, 0.5, 0}, {0.5, 0.4, 0.4});
  pusher.kind = BodyKind::kinematic;
  pusher.velocity = {0.5, 0, 0};
  (void)must(world.create_body(pusher));
  const double x = must(world.pose(box)).position.x;
  run(world, stepper, 100);
  CHECK(must(world.is_asleep(box)));  // it is not there yet
  run(world, stepper, 100);
  CHECK(must(world.pose(box)).position.x > x + 0.2);
  CHECK(!must(world.is_asleep(box)));
}

TEST_CASE("sleep: what is driven, or may not sleep, keeps its whole island awake") {
  const std::function<void(Towers&)> ways[] = {
      [](Towers& t) { must(t.world.set_can_sleep(t.cubes[2], false)); },
      [](Towers& t) {
        must(t.world.set_motor(t.joint, {1e-6, 1}));
      },
      [](Towers& t) { (void)must(t.world.add_force(t.cubes[2], [](const World&, BodyId) { return Wrench{}; })); },
  };
  for (const auto& act : ways) {
    Towers t;
    act(t);
    run(t.world, t.stepper, 240);
    for (int i = 0; i < 3; i++) CHECK(!t.asleep(i));
    for (int i = 3; i < 6; i++) CHECK(t.asleep(i));
  }
}
