// Pins: every peer that was found holds the bodies, joints, limits, drag and forces of the world it was made of, so
// that what a comparison shows is the engine and not the translation. A peer that is missing says so.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "peers/peer.h"
#include "scenes/metrics.h"

using namespace pcphys;
using doctest::Approx;
using std::numbers::pi;

namespace {

constexpr double g = 9.81;

/// Runs `check` for each variant that was found.
template <class Check> void for_each_peer(Check check) {
  for (const peers::Variant& variant : peers::variants()) {
    if (!variant.found) continue;
    CAPTURE(std::string(variant.name));
    check(variant);
  }
}

std::unique_ptr<peers::Peer> make(const peers::Variant& variant, const World& world, peers::Options options = {}) {
  auto peer = peers::make(variant.name, world, world.bodies(), options);
  REQUIRE_MESSAGE(peer, (peer ? "" : peer.error().message));
  return std::move(*peer);
}

peers::Options one_substep() {
  peers::Options options;
  options.substeps = 1;
  return options;
}

double rounding(const peers::Variant& variant) { return variant.precision == "float" ? 2e-5 : 1e-11; }

void run(peers::Peer& peer, int steps, double dt) {
  for (int i = 0; i < steps; ++i) {
    const Status status = peer.step(dt);
    REQUIRE_MESSAGE(status, (status ? "" : status.error().message));
  }
}

BodyId must(Result<BodyId> id) {
  REQUIRE(id);
  return *id;
}

/// Degrees by which `pose` is turned about the world's z axis.
double turned(const Pose& pose) {
  const Vec3 x = rotate(pose.orientation, {1, 0, 0});
  return std::atan2(x.y, x.x) * 180 / pi;
}

}  // namespace

TEST_CASE("peers: a missing engine is named with its package, an unknown one with the choices") {
  World world;
  CHECK(peers::variants().size() == 5);
  for (const peers::Variant& variant : peers::variants()) {
    CHECK_FALSE(variant.package.empty());
    CHECK(variant.version.empty() != variant.found);
    const auto peer = peers::make(variant.name, world, {});
    CHECK(bool(peer) == variant.found);
    if (!peer) CHECK(peer.error().message.find(variant.package) != std::string::npos);
  }
  const auto none = peers::make("havok", world, {});
  REQUIRE_FALSE(none);
  CHECK(none.error().code == ErrorCode::unknown_name);
  CHECK(none.error().message.find("mujoco-rk4") != std::string::npos);
}

TEST_CASE("peers: free fall as each method's own formula says") {
  World world;
  BodyDef ball;
  ball.shapes = {ShapeDef::sphere(0.1)};
  ball.pose.position = {0.5, 3, -1};
  ball.velocity = {1, 2, -0.5};
  must(world.create_body(ball));
  constexpr double dt = 1.0 / 240;
  constexpr int steps = 240;
  for_each_peer([&](const peers::Variant& variant) {
    const auto peer = make(variant, world, one_substep());
    run(*peer, steps, dt);
    const double t = steps * dt, fallen = 0.5 * g * t * t;
    // semi-implicit Euler falls g dt t / 2 further than the parabola, which Runge and Kutta's method follows
    const double euler = variant.name == "mujoco-rk4" ? 0 : 0.5 * g * dt * t;
    CHECK(peer->pose(0).position.x == Approx(1.5).epsilon(rounding(variant)));
    CHECK(std::fabs(peer->pose(0).position.y - (3 + 2 * t - fallen - euler)) < 10 * rounding(variant));
    CHECK(peer->pose(0).position.z == Approx(-1.5).epsilon(rounding(variant)));
    CHECK(peer->velocity(0).y == Approx(2 - g * t).epsilon(rounding(variant)));
  });
}

TEST_CASE("peers: a chain and ragdolls have the masses, inertias and poses of the world") {
  for (const char* name : {"chain", "chainswing", "ragdolls", "door"}) {
    CAPTURE(name);
    World world({Precision::f64});
    scenes::SceneOptions options;
    options.count = 3;
    const auto scene = scenes::make(name, options, world);
    REQUIRE(scene);
    for_each_peer([&](const peers::Variant& variant) {
      const auto peer = make(variant, world);
      const double epsilon = 100 * rounding(variant);
      for (std::size_t i = 0; i < scene->bodies.size(); ++i) {
        const scenes::SceneBody& body = scene->bodies[i];
        CHECK(length(peer->pose(i).position - body.start.position) < epsilon);
        if (body.kind != BodyKind::dynamic) continue;
        CHECK(std::fabs(std::fabs((conjugate(body.start.orientation) * peer->pose(i).orientation).w) - 1) < epsilon);
        const MassProperties has = peer->mass_properties(i), should = *world.mass_properties(body.id);
        CHECK(has.mass == Approx(should.mass).epsilon(epsilon));
        CHECK(has.moments.x == Approx(should.moments.x).epsilon(epsilon));
        CHECK(has.moments.y == Approx(should.moments.y).epsilon(epsilon));
        CHECK(has.moments.z == Approx(should.moments.z).epsilon(epsilon));
      }
    });
  }
}

TEST_CASE("peers: joints hold, hinges keep their axis, and what collides stays in the box") {
  struct Case {
    const char* scene;
    int count;
    double separation, limit;  // after 2 s of 1/240 s [m], [degrees]
  };
  for (const Case& c : {Case{"ragdolls", 2, 0.05, 60}, Case{"door", 2, 0.02, 5}, Case{"chain", 5, 0.06, 1e-9}}) {
    CAPTURE(c.scene);
    World world({Precision::f64});
    scenes::SceneOptions options;
    options.count = c.count;
    options.ratio = 2;
    const auto scene = scenes::make(c.scene, options, world);
    REQUIRE(scene);
    for_each_peer([&](const peers::Variant& variant) {
      const auto peer = make(variant, world);
      run(*peer, 480, 1.0 / 240);
      scenes::State state;
      for (std::size_t i = 0; i < scene->bodies.size(); ++i) {
        state.poses.push_back(peer->pose(i));
        state.velocities.push_back(peer->velocity(i));
        state.angular_velocities.push_back(peer->angular_velocity(i));
      }
      const scenes::Metrics metrics = scenes::measure(*scene, world, state);
      CHECK(metrics.nonfinite == 0);
      CHECK(metrics.escapes.through == 0);
      CHECK(metrics.separation.max < c.separation);
      CHECK(metrics.limit_excess.any * 180 / pi < c.limit);
    });
  }
}

TEST_CASE("peers: limits act on the side they were given for, about each axis, whichever body is a") {
  // A rod hangs on a joint whose axis lies along the world's z, starts 75 degrees off, and may come back to 20.
  enum Arrangement { post_is_a, post_is_b, post_moves };
  for (Arrangement arrangement : {post_is_a, post_is_b, post_moves})
    for (int axis : {0, 1, 2})
      for (double side : {1.0, -1.0}) {
        CAPTURE(int(arrangement));
        CAPTURE(axis);
        CAPTURE(side);
        World world({Precision::f64});
        BodyDef post, rod;
        post.kind = arrangement == post_moves ? BodyKind::dynamic : BodyKind::fixed;
        post.shapes = {ShapeDef::sphere(0.2)};
        post.shapes[0].filter.mask = 0;
        rod.shapes = {ShapeDef::box({0.02, 0.5, 0.02})};
        rod.shapes[0].filter.mask = 0;
        rod.pose.orientation = axis_angle({0, 0, 1}, side * 75 * pi / 180);
        rod.pose.position = rotate(rod.pose.orientation, {0, -0.5, 0});
        rod.linear_drag = rod.angular_drag = 2;
        const BodyId standing = must(world.create_body(post)), moving = must(world.create_body(rod));
        if (arrangement == post_moves) {
          JointDef held;
          held.a = world.ground();
          held.b = standing;
          held.freedom = AngleFreedom::locked();
          REQUIRE(world.create_joint(held));
        }
        // x, y or z of the joint's frames is the world's z when the rod hangs straight
        const Quat axes = axis == 0   ? axis_angle({0, 1, 0}, -0.5 * pi)
                          : axis == 1 ? axis_angle({1, 0, 0}, 0.5 * pi)
                                      : Quat{};
        const Pose at_post{{}, axes}, at_rod{{0, 0.5, 0}, axes};
        const bool swapped = arrangement == post_is_b;
        JointDef joint;
        joint.a = swapped ? moving : standing;
        joint.b = swapped ? standing : moving;
        joint.frame_a = swapped ? at_rod : at_post;
        joint.frame_b = swapped ? at_post : at_rod;
        const bool positive = (side > 0) != swapped;  // the angles of b relative to a
        double lower[3] = {}, upper[3] = {};
        lower[axis] = (positive ? 20 : -80) * pi / 180;
        upper[axis] = (positive ? 80 : -20) * pi / 180;
        joint.freedom = AngleFreedom::between({lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]});
        REQUIRE(world.create_joint(joint));
        for_each_peer([&](const peers::Variant& variant) {
          const auto peer = make(variant, world);
          run(*peer, 1200, 1.0 / 240);
          CHECK(turned(peer->pose(1)) == Approx(side * 20).epsilon(0.05));
        });
      }
}

TEST_CASE("peers: drag, constant force and constant torque") {
  World world({Precision::f64, {0, 0, 0}});
  BodyDef box;
  box.shapes = {ShapeDef::box({0.1, 0.2, 0.3})};
  box.mass = 2;
  const BodyId pushed = must(world.create_body(box));
  REQUIRE(world.add_force(pushed, {{4, 0, 0}, {0, 0, 1}}));
  box.pose.position = {0, 5, 0};
  box.velocity = {3, 0, 0};
  box.angular_velocity = {0, 2, 0};
  box.linear_drag = 0.5;
  box.angular_drag = 0.8;
  must(world.create_body(box));
  const double moment = world.mass_properties(pushed)->moments.z;
  for_each_peer([&](const peers::Variant& variant) {
    const auto peer = make(variant, world, one_substep());
    run(*peer, 500, 1e-3);
    CHECK(peer->velocity(0).x == Approx(1).epsilon(1e-4));
    CHECK(peer->angular_velocity(0).z == Approx(0.5 / moment).epsilon(1e-4));
    CHECK(peer->velocity(1).x == Approx(3 * std::exp(-0.25)).epsilon(1e-3));
    CHECK(peer->angular_velocity(1).y == Approx(2 * std::exp(-0.4)).epsilon(1e-3));
    // what may be changed on the way
    CHECK(peer->set_wrench(0, {{0, 2, 0}, {}}));
    CHECK(peer->set_velocity(0, {1, 0, 0}, {0, 0, 3}));
    CHECK(peer->set_gravity({0, 0, 5}));
    run(*peer, 100, 1e-3);
    CHECK(peer->velocity(0).x == Approx(1).epsilon(1e-4));
    CHECK(peer->velocity(0).y == Approx(0.1).epsilon(1e-4));
    CHECK(peer->velocity(0).z == Approx(0.5).epsilon(1e-4));
    CHECK(peer->angular_velocity(0).z == Approx(3).epsilon(1e-4));
  });
}

TEST_CASE("peers: every shape rests on a plane and on a box, and filters keep bodies apart") {
  for (bool plane : {true, false}) {
    World world({Precision::f64});
    BodyDef floor;
    floor.kind = BodyKind::fixed;
    floor.pose.position = {0, plane ? 1.0 : 0.5, 0};
    floor.shapes = {plane ? ShapeDef::plane() : ShapeDef::box({20, 0.5, 20})};
    must(world.create_body(floor));
    const ShapeDef shapes[] = {ShapeDef::sphere(0.3), ShapeDef::capsule(0.2, 0.4), ShapeDef::box({0.3, 0.2, 0.4}),
                               ShapeDef::cylinder(0.3, 0.2)};
    const double heights[] = {0.3, 0.6, 0.2, 0.2};
    for (int i = 0; i < 4; ++i) {
      BodyDef body;
      body.shapes = {shapes[i]};
      body.pose.position = {3.0 * i, 1.02 + heights[i], 0};
      must(world.create_body(body));
      body.pose.position.z = 6;
      body.shapes[0].filter.mask = 0;  // falls through
      must(world.create_body(body));
    }
    for_each_peer([&](const peers::Variant& variant) {
      const auto peer = make(variant, world);
      run(*peer, 240, 1.0 / 240);
      CHECK(peer->contacts() > 0);
      for (std::size_t i = 0; i < 4; ++i) {
        CAPTURE(i);
        const double margin = 0.045;  // a capsule on its end may begin to topple, Bullet rests with a margin
        CHECK(std::fabs(peer->pose(1 + 2 * i).position.y - 1 - heights[i]) < margin);
        CHECK(peer->pose(2 + 2 * i).position.y < -2);
      }
      CHECK(*peer->deepest() < 0.05);
      CHECK(peer->failures() == 0);
    });
  }
}

TEST_CASE("peers: a ring of links, whose last joint closes a loop") {
  World world({Precision::f64, {0, 0, 0}});
  constexpr int links = 8;
  const double length_of_link = 0.5, radius = 0.5 * length_of_link / std::tan(pi / links);
  std::vector<BodyId> ring;
  for (int i = 0; i < links; ++i) {
    const double angle = 2 * pi * i / links;
    BodyDef link;
    link.shapes = {ShapeDef::box({0.5 * length_of_link, 0.03, 0.03})};
    link.shapes[0].filter.mask = 0;
    link.pose = {{radius * std::cos(angle), radius * std::sin(angle), 0}, axis_angle({0, 0, 1}, angle + 0.5 * pi)};
    link.velocity = cross({0, 0, 2}, link.pose.position);
    link.angular_velocity = {0, 0, 2};
    ring.push_back(must(world.create_body(link)));
  }
  for (int i = 0; i < links; ++i) {
    JointDef joint;
    joint.a = ring[std::size_t(i)];
    joint.b = ring[std::size_t((i + 1) % links)];
    joint.frame_a.position = {0.5 * length_of_link, 0, 0};
    joint.frame_b.position = {-0.5 * length_of_link, 0, 0};
    REQUIRE(world.create_joint(joint));
  }
  for_each_peer([&](const peers::Variant& variant) {
    const auto peer = make(variant, world);
    run(*peer, 240, 1.0 / 240);
    for (std::size_t i = 0; i < links; ++i) {
      CHECK(length(peer->pose(i).position) == Approx(radius).epsilon(0.05));
      CHECK(peer->angular_velocity(i).z == Approx(2).epsilon(0.1));
    }
  });
}

TEST_CASE("peers: what no engine can hold is refused, and what it holds differently is said") {
  World world;
  BodyDef body;
  body.shapes = {ShapeDef::sphere(0.1)};
  body.material.restitution = 0.5;
  must(world.create_body(body));
  for_each_peer([&](const peers::Variant& variant) {
    const auto peer = make(variant, world);
    CHECK(peer->untranslated().empty() == (variant.engine != "MuJoCo"));  // its contacts have no restitution
  });
  body.kind = BodyKind::kinematic;
  must(world.create_body(body));
  for_each_peer([&](const peers::Variant& variant) {
    const auto peer = peers::make(variant.name, world, world.bodies());
    REQUIRE_FALSE(peer);
    CHECK(peer.error().code == ErrorCode::unavailable);
  });
}

TEST_CASE("peers: MuJoCo's joints have the damping of the world's, and those without say so") {
  World world;
  REQUIRE(world.set_gravity({}));
  BodyDef def;
  def.mass = 2;
  def.moments = Vec3{0.1, 0.1, 0.1};
  def.angular_velocity = {0, 0, 3};
  const BodyId body = must(world.create_body(def));
  JointDef joint;
  joint.a = world.ground();
  joint.b = body;
  joint.spring.damping = 0.2;  // the spin falls by exp(-2) in a second
  REQUIRE(world.create_joint(joint));
  for_each_peer([&](const peers::Variant& variant) {
    const auto peer = make(variant, world);
    run(*peer, 1000, 1e-3);
    const bool damped = variant.name.starts_with("mujoco");
    CHECK(length(peer->angular_velocity(0)) == Approx(damped ? 3 * std::exp(-2.0) : 3).epsilon(0.01));
    const auto& said = peer->untranslated();
    CHECK(std::ranges::any_of(said, [](const std::string& s) { return s.find("damping") != std::string::npos; }) !=
          damped);
  });
}
