// Pins: what random scenes are judged with. Distances agree with closed forms, energy that is made is seen and what
// drives put in is not, a family and a seed are one scene, and every call of a scene but a host's is one that the
// library takes.
#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "wild/balance.h"
#include "wild/closings.h"
#include "wild/distance.h"
#include "wild/overlaps.h"
#include "wild/play.h"
#include "wild/scene.h"
#include "wild/shapes.h"
#include "wild/verdict.h"

using namespace pcphys;
using namespace pcphys::wild;

TEST_SUITE_BEGIN("wild_judge");

TEST_CASE("distance: closed forms of round shapes, boxes and planes") {
  Dice dice("distance", 1);
  for (int i = 0; i < 200; i++) {
    const ShapeDef ball = ShapeDef::sphere(dice.between(0.1, 1)), other = ShapeDef::sphere(dice.between(0.1, 1));
    const Vec3 towards = dice.direction();
    const double apart = dice.between(0, 3);
    const Pose a{{1, 2, 3}, dice.orientation()}, b{Vec3{1, 2, 3} + towards * apart, dice.orientation()};
    const double expected = std::fmax(0.0, apart - ball.size.x - other.size.x);
    CHECK(distance(placed(ball, a), placed(other, b)) == doctest::Approx(expected).epsilon(1e-9));

    // A box seen along one of its own axes from beyond its face.
    const ShapeDef box = ShapeDef::box({0.5, 0.3, 0.2});
    const Vec3 along = rotate(a.orientation, {1, 0, 0});
    const Pose beyond{a.position + along * (0.5 + ball.size.x + apart), dice.orientation()};
    CHECK(distance(placed(box, a), placed(ball, beyond)) == doctest::Approx(apart).epsilon(1e-8));
    const ShapeDef plane = ShapeDef::plane();
    const double above = std::fmax(0.0, b.position.y - ball.size.x);
    CHECK(distance(placed(plane, {}), placed(ball, b)) == doctest::Approx(above).epsilon(1e-9));
  }
}

TEST_CASE("distance: hulls and cylinders are apart by what their extents say along the line of their nearest points") {
  Dice dice("distance", 2);
  for (int i = 0; i < 200; i++) {
    const ShapeDef a = random_shape(dice, 0.5), b = random_shape(dice, 0.5);
    const Quat turned = dice.orientation(), other = dice.orientation();
    const Vec3 n = dice.direction();
    const double gap = dice.between(0.01, 1);
    // Two support planes with a gap between them: no distance is less than that.
    const double between = extent_along(a, turned, n) + gap + extent_along(b, other, -n);
    const double found = distance(placed(a, {{}, turned}), placed(b, {n * between, other}));
    CHECK(found >= gap * (1 - 1e-9));
  }
}

TEST_CASE("least distance: bodies that pass, and bodies that meet on their way") {
  const ShapeDef ball = ShapeDef::sphere(0.5);
  const Moving still{&ball, {}, {}, {}};
  const Moving passing{&ball, {{-3, 1.25, 0}, {}}, {10, 0, 0}, {0, 40, 0}};
  const Moving meeting{&ball, {{-3, 0.5, 0}, {}}, {10, 0, 0}, {}};
  CHECK(least_distance(still, passing, 0.6, 1e-4) == doctest::Approx(0.25).epsilon(1e-2));
  CHECK(least_distance(still, meeting, 0.6, 1e-4) <= 1e-4);
  CHECK(least_distance(still, meeting, 0.1, 1e-4) > 0.5);
}

namespace {

Observation one_body(double speed, double height) {
  Observation seen;
  seen.gravity = {0, -10, 0};
  SeenBody body;
  body.there = true;
  body.kind = BodyKind::dynamic;
  body.mass = {2, {1e-6, 1e-6, 1e-6}};
  body.velocity = {0, speed, 0};
  body.pose.position = {0, height, 0};
  seen.bodies = {body};
  return seen;
}

}  // namespace

TEST_CASE("balance: a fall makes nothing, a kick does, and what the host or a drive puts in is no rise") {
  Balance fall(0), kick(0), driven(0), host(0);
  constexpr double dt = 0.1;
  for (Balance* b : {&fall, &kick, &driven, &host}) b->begin(one_body(0, 5));
  fall.stepped(one_body(-10, 0), 0, dt);
  CHECK(fall.rise() < 1e-12);
  kick.stepped(one_body(-10, 0), 0, dt);
  kick.stepped(one_body(11, 0), 0, dt);  // 121 J in place of 100
  CHECK(kick.rise() == doctest::Approx(0.21 / 2).epsilon(0.01));
  driven.stepped(one_body(-11, 0), 21, dt);
  CHECK(driven.rise() < 1e-12);
  host.changed(one_body(0, 5), one_body(8, 5));
  host.stepped(one_body(8, 5), 0, dt);
  CHECK(host.rise() < 1e-12);
}

namespace {

/// A body at `place` along x, which a pin draws to the origin and a spring of 100 N/m to 2 m, where it began; and
/// another one at 5 m on a spring of its own.
Observation drawn_to_pin(double place, double other) {
  Observation seen = one_body(0, 0);
  seen.bodies.push_back(seen.bodies[0]);
  seen.bodies[0].pose.position = {place, 0, 0};
  seen.bodies[1].pose.position = {other, 0, 0};
  SeenJoint pin;
  pin.there = true;
  pin.a = 0;
  seen.joints = {pin};
  SeenSpring spring;
  spring.there = true;
  spring.a = 0;
  spring.def.anchor_b = {2, 0, 0};
  spring.def.stiffness = 100;
  seen.springs = {spring, spring};
  seen.springs[1].a = 1;
  seen.springs[1].def.anchor_b = {5, 0, 0};
  return seen;
}

}  // namespace

TEST_CASE("closings: a pin that the host opened may stretch springs of what it draws, by as much as it closes, once") {
  const Observation open = drawn_to_pin(2, 5), half = drawn_to_pin(1, 5), closed = drawn_to_pin(0, 5);
  Closings none, closings;
  CHECK(none.work(open, half, 50) == 0);
  closings.opened(0, 2);
  CHECK(closings.work(open, half, 50) == doctest::Approx(50));
  CHECK(closings.work(open, half, 20) == doctest::Approx(20));  // no more than energy rose, and that was the last metre
  CHECK(closings.work(half, closed, 150) == 0);
  // Springs of others gain nothing by it, whatever they do.
  closings.opened(0, 2);
  CHECK(closings.work(open, drawn_to_pin(1, 9), 850) == doctest::Approx(50));
  // What springs gain beyond the way that the pin went is not its.
  closings.opened(0, 0.5);
  CHECK(closings.work(open, half, 50) == doctest::Approx(12.5));
}

TEST_CASE("overlaps: what touches to rounding is given nothing, what is made to overlap its weight and a push") {
  const StepSettings settings;
  const double dt = 1.0 / 60, weight = 9.81;
  const auto given = [&](double depth) {
    Eye eye;
    Observation& seen = eye.seen();
    seen.gravity = {0, -weight, 0};
    for (int i = 0; i < 2; i++) {
      BodyDef def;
      def.shapes = {ShapeDef::box({0.5, 0.5, 0.5})};
      eye.follow(MakeBody{i, def});
      SeenBody& body = seen.bodies[std::size_t(i)];
      body.there = true;
      body.kind = i == 0 ? BodyKind::fixed : BodyKind::dynamic;
      body.pose.position.y = i * (1 - depth);
      body.mass.mass = 2;
    }
    Overlaps overlaps;
    overlaps.made(eye);
    const double energy = overlaps.undone(eye, settings, dt);
    CHECK(overlaps.undone(eye, settings, dt) == 0);
    return energy;
  };
  CHECK(given(-0.1) == 0);
  CHECK(given(1e-8) < 1e-6);
  const double push = settings.push_speed;
  CHECK(given(0.1) == doctest::Approx(2 * (weight * 0.1 + 0.5 * push * push)).epsilon(1e-6));
}

TEST_CASE("a family and a seed are one scene, and the library takes its calls") {
  struct Refusals final : Watcher {
    std::string first;
    void after_call(const Player&, const Call&, const Status& status) override {
      if (!status && first.empty()) first = status.error().message;
    }
    bool after_step(const Player&, double, const StepReport&) override { return false; }
  };
  for (const Family& family : families())
    for (std::uint64_t seed = 1; seed <= 20; seed++) {
      const auto scene = draw(family.name, seed), again = draw(family.name, seed);
      REQUIRE(scene);
      REQUIRE(again);
      CHECK(scene->calls.size() == again->calls.size());
      Player player(*scene, {}), other(*again, {});
      Refusals refusals;
      CHECK(player.play(&refusals));
      CHECK(other.play(&refusals));
      INFO(family.name << ", seed " << seed << ": " << refusals.first);
      CHECK(refusals.first.empty());
      CHECK(player.own_hash() == other.own_hash());
    }
  CHECK(!draw("meadow", 1));
}

TEST_SUITE_END();

// ODE throws where it would end the process. In the middle of a step that leaves a space locked, and to destroy it
// threw once more, out of a destructor.
TEST_CASE("wild: a peer that gives up in the middle of a step breaks its scene, not the program") {
  const auto scene = draw("pile", 448);
  REQUIRE(scene);
  const auto verdict = judge_peer(*scene, "ode-dantzig");
  if (!verdict) {
    CHECK(verdict.error().code == ErrorCode::unavailable);
    return;
  }
  CHECK(verdict->steps > 0);
  CHECK(verdict->broken());
}
