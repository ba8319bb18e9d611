// Pins C11 and C12: degenerate shapes and masses, and numbers that no physics can use, are refused by a named
// error that leaves the world as it was, and nobody else notices.
#include <functional>

#include "support_neighbours.h"

using namespace physics;

namespace {

constexpr double dt = frame;

struct BadBody {
  const char* what;
  ErrorCode expected;
  std::function<void(BodyDef&)> spoil;
};

const BadBody bad_bodies[] = {
    {"sphere of radius 0", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(0)}; }},
    {"sphere of negative radius", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(-1)}; }},
    {"sphere of radius NaN", ErrorCode::not_finite, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(not_a_number)}; }},
    {"sphere of infinite radius", ErrorCode::not_finite, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(infinite)}; }},
    {"sphere too small for single precision", ErrorCode::degenerate_shape,
     [](BodyDef& d) { d.shapes = {ShapeDef::sphere(1e-30)}; }},
    {"sphere too large", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(1e30)}; }},
    {"box of zero edge", ErrorCode::degenerate_shape,
     [](BodyDef& d) {
       d.shapes = {ShapeDef::box({0.5, 0, 0.5})};
     }},
    {"flat box", ErrorCode::degenerate_shape,
     [](BodyDef& d) {
       d.shapes = {ShapeDef::box({0.5, 0.5, 1e-9})};
     }},
    {"box of negative edge", ErrorCode::degenerate_shape,
     [](BodyDef& d) {
       d.shapes = {ShapeDef::box({-0.5, 0.5, 0.5})};
     }},
    {"capsule of length 0", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::capsule(0.1, 0)}; }},
    {"capsule of radius 0", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::capsule(0, 0.1)}; }},
    {"cylinder of height 0", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::cylinder(0.1, 0)}; }},
    {"cylinder of radius 0", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::cylinder(0, 0.1)}; }},
    {"plane that moves", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::plane()}; }},
    {"shape at NaN in its body", ErrorCode::not_finite,
     [](BodyDef& d) {
       d.shapes[0].local.position.x = not_a_number;
       d.mass = 1;
       d.moments = Vec3{1, 1, 1};
     }},
    {"shape turned by no rotation", ErrorCode::not_unit_quaternion,
     [](BodyDef& d) {
       d.shapes[0].local.orientation = {0, 0, 0, 0};
       d.mass = 1;
       d.moments = Vec3{1, 1, 1};
     }},
    {"mass 0", ErrorCode::bad_mass, [](BodyDef& d) { d.mass = 0; }},
    {"negative mass", ErrorCode::bad_mass, [](BodyDef& d) { d.mass = -1; }},
    {"mass NaN", ErrorCode::not_finite, [](BodyDef& d) { d.mass = not_a_number; }},
    {"infinite mass", ErrorCode::not_finite, [](BodyDef& d) { d.mass = infinite; }},
    {"density 0", ErrorCode::bad_mass, [](BodyDef& d) { d.density = 0; }},
    {"negative density", ErrorCode::bad_mass, [](BodyDef& d) { d.density = -1; }},
    {"density NaN", ErrorCode::bad_mass, [](BodyDef& d) { d.density = not_a_number; }},
    {"zero inertia", ErrorCode::bad_mass,
     [](BodyDef& d) {
       d.mass = 1;
       d.moments = Vec3{0, 0, 0};
     }},
    {"one moment zero", ErrorCode::bad_mass,
     [](BodyDef& d) {
       d.mass = 1;
       d.moments = Vec3{1, 1, 0};
     }},
    {"negative moment", ErrorCode::bad_mass,
     [](BodyDef& d) {
       d.mass = 1;
       d.moments = Vec3{1, -1, 1};
     }},
    {"moments of no body", ErrorCode::bad_mass,
     [](BodyDef& d) {
       d.mass = 1;
       d.moments = Vec3{1, 1, 3};
     }},
    {"moment NaN", ErrorCode::not_finite,
     [](BodyDef& d) {
       d.mass = 1;
       d.moments = Vec3{1, not_a_number, 1};
     }},
    {"position NaN", ErrorCode::not_finite, [](BodyDef& d) { d.pose.position.y = not_a_number; }},
    {"position infinite", ErrorCode::not_finite, [](BodyDef& d) { d.pose.position.y = -infinite; }},
    {"position 1e30", ErrorCode::not_finite, [](BodyDef& d) { d.pose.position.y = 1e30; }},
    {"velocity NaN", ErrorCode::not_finite, [](BodyDef& d) { d.velocity.x = not_a_number; }},
    {"velocity 1e30", ErrorCode::not_finite, [](BodyDef& d) { d.velocity.x = 1e30; }},
    {"spin infinite", ErrorCode::not_finite, [](BodyDef& d) { d.angular_velocity.z = infinite; }},
    {"orientation NaN", ErrorCode::not_finite, [](BodyDef& d) { d.pose.orientation.w = not_a_number; }},
    {"orientation zero", ErrorCode::not_unit_quaternion,
     [](BodyDef& d) {
       d.pose.orientation = {0, 0, 0, 0};
     }},
    {"orientation of length 2", ErrorCode::not_unit_quaternion,
     [](BodyDef& d) {
       d.pose.orientation = {0, 0, 0, 2};
     }},
    {"restitution above 1", ErrorCode::bad_argument, [](BodyDef& d) { d.material.restitution = 1.1; }},
    {"restitution NaN", ErrorCode::not_finite, [](BodyDef& d) { d.material.restitution = not_a_number; }},
    {"negative friction", ErrorCode::bad_argument, [](BodyDef& d) { d.material.static_friction = -0.1; }},
    {"negative drag", ErrorCode::bad_argument, [](BodyDef& d) { d.linear_drag = -1; }},
    {"drag NaN", ErrorCode::not_finite, [](BodyDef& d) { d.angular_drag = not_a_number; }},
};

}  // namespace

TEST_CASE("C11: degenerate shapes and impossible masses are refused, and nobody notices") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Neighbours n(mode);
    const std::uint64_t hash = n.world().hash();
    const std::vector<std::byte> snapshot = n.world().snapshot();
    for (const BadBody& bad : bad_bodies) {
      CAPTURE(std::string(bad.what));
      BodyDef def = good_body();
      bad.spoil(def);
      const auto made = n.world().create_body(def);
      CHECK(code(made) == bad.expected);
      CHECK(has_sentence(made));
      CHECK(n.world().hash() == hash);
    }
    CHECK(n.world().snapshot() == snapshot);
    CHECK(n.world().body_count() == n.count);
    // mass properties that are set later are held to the same
    for (const MassProperties& m : {MassProperties{0, {1, 1, 1}}, MassProperties{-1, {1, 1, 1}},
                                    MassProperties{1, {0, 1, 1}}, MassProperties{1, {1, 1, 2.1}}})
      CHECK(code(n.world().set_mass_properties(n.bodies[1], m)) == ErrorCode::bad_mass);
    CHECK(code(n.world().set_mass_properties(n.bodies[1], {not_a_number, {1, 1, 1}})) == ErrorCode::not_finite);
    CHECK(n.world().hash() == hash);
    n.run.step(dt, 30);
    CHECK(same_bits(n.state(), untouched(mode, 30)));
  }
}

TEST_CASE("C12: NaN, infinity, 1e30 and quaternions that are no rotation are refused by every setter") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Neighbours n(mode);
    World& w = n.world();
    const BodyId id = n.bodies[1];
    const std::uint64_t hash = w.hash();
    const std::vector<std::byte> snapshot = w.snapshot();
    const Pose pose = *w.pose(id);
    for (double bad : {not_a_number, infinite, -infinite, 1e30, -1e30}) {
      CAPTURE(bad);
      for (const Vec3& v : {Vec3{bad, 0, 0}, Vec3{0, bad, 0}, Vec3{0, 0, bad}}) {
        CHECK(code(w.set_pose(id, {v, {}})) == ErrorCode::not_finite);
        CHECK(code(w.set_velocity(id, v)) == ErrorCode::not_finite);
        CHECK(code(w.set_angular_velocity(id, v)) == ErrorCode::not_finite);
        CHECK(code(w.set_position_last(id, v)) == ErrorCode::not_finite);
        CHECK(code(w.set_gravity(v)) == ErrorCode::not_finite);
        CHECK(code(w.add_force(id, Wrench{v, {}})) == ErrorCode::not_finite);
        CHECK(code(w.add_force(id, Wrench{{}, v})) == ErrorCode::not_finite);
        JointDef joint;
        joint.a = n.bodies[1];
        joint.b = n.bodies[3];
        joint.frame_a.position = v;
        CHECK(code(w.create_joint(joint)) == ErrorCode::not_finite);
      }
      CHECK(code(w.set_drag(id, bad, 0)) != ErrorCode::none);
      CHECK(code(w.set_drag(id, 0, bad)) != ErrorCode::none);
    }
    for (double bad : {not_a_number, infinite}) {
      CHECK(code(w.set_pose(id, {pose.position, {0, 0, bad, 1}})) == ErrorCode::not_finite);
      CHECK(code(w.set_orientation_last(id, {bad, 0, 0, 1})) == ErrorCode::not_finite);
      CHECK(code(w.set_material(id, {bad, 0.5, 0})) == ErrorCode::not_finite);
    }
    for (const Quat& q : {Quat{0, 0, 0, 0}, Quat{0, 0, 0, 2}, Quat{0.1, 0, 0, 1}, Quat{0, 1e-310, 0, 0}}) {
      CHECK(code(w.set_pose(id, {pose.position, q})) == ErrorCode::not_unit_quaternion);
      CHECK(code(w.set_orientation_last(id, q)) == ErrorCode::not_unit_quaternion);
    }
    AngleFreedom crossed = AngleFreedom::hinge(1, -1), nan = AngleFreedom::cone_and_twist(not_a_number, 1);
    JointDef joint;
    joint.a = n.bodies[1];
    joint.b = n.bodies[3];
    for (const AngleFreedom& freedom : {crossed, nan}) {
      joint.freedom = freedom;
      CHECK(code(w.create_joint(joint)) == ErrorCode::bad_joint);
    }
    CHECK(w.hash() == hash);
    CHECK(w.snapshot() == snapshot);
    n.run.step(dt, 30);
    CHECK(same_bits(n.state(), untouched(mode, 30)));
  }
}

TEST_CASE("C12: a time step of zero, below zero, NaN or infinity leaves the state bit for bit") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    Neighbours n(mode);
    const std::vector<std::byte> snapshot = n.world().snapshot();
    for (double bad : {0.0, -0.0, -1.0 / 60, not_a_number, infinite, -infinite}) {
      CAPTURE(bad);
      const StepReport& report = n.run.stepper.step(n.world(), bad);
      CHECK(report.error.code == ErrorCode::bad_time_step);
      CHECK(n.world().snapshot() == snapshot);
    }
    n.run.step(dt, 3);
    CHECK(same_bits(n.state(), untouched(mode, 3)));
  }
}

TEST_CASE("C12: a time step that is far too short or too long is refused, or leaves a world that goes on") {
  for (const Mode& mode : precisions())
    for (double extreme : {1e-310, 1e-40, 1e-30, 1e-20, 1e20, 1e30, 1e300}) {
      CAPTURE(mode.name());
      CAPTURE(extreme);
      Neighbours n(mode);
      const std::vector<std::byte> snapshot = n.world().snapshot();
      const bool made = bool(n.run.stepper.step(n.world(), extreme));
      if (!made) CHECK(n.world().snapshot() == snapshot);
      bool finite_state = true;
      for (double x : n.state()) finite_state &= std::isfinite(x);
      CHECK(finite_state);
    }
}

TEST_CASE("C12: a callback's NaN refuses the step, which leaves the state") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Neighbours n(mode);
    bool bad = true;
    const auto force = n.world().add_force(n.bodies[1], [&bad](const World&, BodyId) {
      return Wrench{{bad ? not_a_number : 0.0, 0, 0}, {}};
    });
    REQUIRE(force);
    const std::vector<std::byte> snapshot = n.world().snapshot();
    CHECK(n.run.stepper.step(n.world(), dt).error.code == ErrorCode::not_finite);
    CHECK(n.world().snapshot() == snapshot);
    bad = false;
    n.run.step(dt, 3);
    Neighbours never(mode);
    REQUIRE(never.world().add_force(never.bodies[1], [](const World&, BodyId) { return Wrench{}; }));
    never.run.step(dt, 3);
    CHECK(same_bits(n.state(), never.state()));
  }
}
