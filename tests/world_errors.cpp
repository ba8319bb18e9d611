// Pins: every error of the world and of the functions around it, by code and sentence; a refused call leaves
// hash, counts, ids, snapshot and the bytes of every table as they were (CHECK_REFUSED).
#include <cmath>
#include <functional>
#include <limits>

#include "support_world.h"

using namespace worldtest;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Two balls, a joint between them, a force on the first, and a step behind them.
struct Populated {
  World world;
  BodyId a, b, fixed, kinematic;
  JointId joint;
  Stepper stepper;

  Populated() {
    a = must(world.create_body(ball({0, 5, 0})));
    b = must(world.create_body(ball({1, 5, 0})));
    fixed = must(world.create_body(fixed_box({0, -1, 0}, {5, 1, 5})));
    BodyDef def = ball({20, 0, 0});
    def.kind = BodyKind::kinematic;
    kinematic = must(world.create_body(def));
    joint = must(world.create_joint(joint_def()));
    (void)must(world.add_force(a, Wrench{{1, 2, 3}, {4, 5, 6}}));
    run(world, stepper, 2);
  }
  JointDef joint_def() const {
    JointDef def;
    def.a = a;
    def.b = b;
    def.frame_a.position = {0.5, 0, 0};
    def.frame_b.position = {-0.5, 0, 0};
    return def;
  }
};

struct BadBody {
  const char* what;
  std::function<void(BodyDef&)> spoil;
  ErrorCode code;
  const char* words;
};

}  // namespace

TEST_CASE("names of error codes") {
  const char* names[] = {"none",          "not_finite",  "bad_mass",    "degenerate_shape", "not_unit_quaternion",
                         "bad_time_step", "stale_id",    "bad_joint",   "bad_argument",     "unknown_name",
                         "name_taken",    "wrong_type",  "unavailable", "buffer_full",      "device_error",
                         "bad_file",      "bad_snapshot"};
  for (int i = 0; i < int(std::size(names)); i++) CHECK(std::string(name(ErrorCode(i))) == names[i]);
  CHECK(int(ErrorCode::bad_snapshot) + 1 == int(std::size(names)));
}

TEST_CASE("create_body refuses") {
  Populated p;
  const BadBody cases[] = {
      {"NaN position", [](BodyDef& d) { d.pose.position.y = not_a_number; }, ErrorCode::not_finite,
       "The position of a body is (0, nan, 0); every component must be finite"},
      {"infinite position", [](BodyDef& d) { d.pose.position.z = -infinity; }, ErrorCode::not_finite,
       "The position of a body is (0, 0, -inf)"},
      {"position out of range", [](BodyDef& d) { d.pose.position.x = 1e16; }, ErrorCode::not_finite,
       "no larger than 1e+15"},
      {"NaN orientation", [](BodyDef& d) { d.pose.orientation.x = not_a_number; }, ErrorCode::not_finite,
       "The orientation of a body holds NaN or infinity; give a unit quaternion"},
      {"long orientation", [](BodyDef& d) { d.pose.orientation.w = 1.01; }, ErrorCode::not_unit_quaternion,
       "The orientation of a body has length 1.01; normalise it"},
      {"zero orientation", [](BodyDef& d) { d.pose.orientation.w = 0; }, ErrorCode::not_unit_quaternion,
       "has length 0"},
      {"NaN velocity", [](BodyDef& d) { d.velocity.x = not_a_number; }, ErrorCode::not_finite,
       "The velocity of a body is (nan, 0, 0)"},
      {"NaN spin", [](BodyDef& d) { d.angular_velocity.x = not_a_number; }, ErrorCode::not_finite,
       "The angular velocity of a body is (nan, 0, 0)"},
      {"NaN friction", [](BodyDef& d) { d.material.static_friction = not_a_number; }, ErrorCode::not_finite,
       "A coefficient of friction or restitution is not a number"},
      {"infinite friction", [](BodyDef& d) { d.material.kinetic_friction = infinity; }, ErrorCode::not_finite,
       "A coefficient of friction or restitution is not a number"},
      {"negative friction", [](BodyDef& d) { d.material.kinetic_friction = -0.1; }, ErrorCode::bad_argument,
       "A coefficient of friction is below zero; use 0 for none."},
      {"negative restitution", [](BodyDef& d) { d.material.restitution = -0.5; }, ErrorCode::bad_argument,
       "The restitution is -0.5; it must lie between 0 (no bounce) and 1 (no loss)."},
      {"restitution above one", [](BodyDef& d) { d.material.restitution = 1.5; }, ErrorCode::bad_argument,
       "The restitution is 1.5"},
      {"NaN drag", [](BodyDef& d) { d.linear_drag = not_a_number; }, ErrorCode::not_finite,
       "The linear drag of a body is nan"},
      {"infinite drag", [](BodyDef& d) { d.angular_drag = infinity; }, ErrorCode::not_finite,
       "The angular drag of a body is inf"},
      {"negative drag", [](BodyDef& d) { d.angular_drag = -1; }, ErrorCode::bad_argument,
       "A drag is below zero; use 0 for none."},
      {"NaN radius", [](BodyDef& d) { d.shapes[0].size.x = not_a_number; }, ErrorCode::not_finite,
       "The radius of a shape is not a number"},
      {"zero radius", [](BodyDef& d) { d.shapes[0].size.x = 0; }, ErrorCode::degenerate_shape,
       "The radius of a shape is 0 m; it must lie between 1e-05 and 1e+06 m."},
      {"negative radius", [](BodyDef& d) { d.shapes[0].size.x = -1; }, ErrorCode::degenerate_shape,
       "The radius of a shape is -1 m"},
      {"huge radius", [](BodyDef& d) { d.shapes[0].size.x = 2e6; }, ErrorCode::degenerate_shape,
       "The radius of a shape is 2e+06 m"},
      {"flat box x",
       [](BodyDef& d) {
         d.shapes[0] = ShapeDef::box({0, 1, 1});
       },
       ErrorCode::degenerate_shape, "The half extent x of a shape is 0 m"},
      {"flat box y",
       [](BodyDef& d) {
         d.shapes[0] = ShapeDef::box({1, 0, 1});
       },
       ErrorCode::degenerate_shape, "The half extent y of a shape is 0 m"},
      {"flat box z",
       [](BodyDef& d) {
         d.shapes[0] = ShapeDef::box({1, 1, 0});
       },
       ErrorCode::degenerate_shape, "The half extent z of a shape is 0 m"},
      {"flat cylinder", [](BodyDef& d) { d.shapes[0] = ShapeDef::cylinder(1, 0); }, ErrorCode::degenerate_shape,
       "The half length of a shape is 0 m"},
      {"flat capsule", [](BodyDef& d) { d.shapes[0] = ShapeDef::capsule(1, 0); }, ErrorCode::degenerate_shape,
       "The half length of a shape is 0 m"},
      {"unknown shape", [](BodyDef& d) { d.shapes[0].kind = ShapeKind(9); }, ErrorCode::bad_argument,
       "A shape is of no known kind"},
      {"shape at NaN", [](BodyDef& d) { d.shapes[0].local.position.x = not_a_number; }, ErrorCode::not_finite,
       "The local position of a shape is (nan, 0, 0)"},
      {"shape turned wrongly", [](BodyDef& d) { d.shapes[0].local.orientation.w = 2; }, ErrorCode::not_unit_quaternion,
       "The local orientation of a shape has length 2"},
      {"moving plane", [](BodyDef& d) { d.shapes[0] = ShapeDef::plane(); }, ErrorCode::degenerate_shape,
       "A plane is infinite; use it on fixed bodies only."},
      {"kinematic plane",
       [](BodyDef& d) {
         d.kind = BodyKind::kinematic;
         d.shapes[0] = ShapeDef::plane();
       },
       ErrorCode::degenerate_shape, "A plane is infinite"},
      {"zero density", [](BodyDef& d) { d.density = 0; }, ErrorCode::bad_mass,
       "A density must be above zero, between 1e-30 and 1e+30 kg/m^3; it is 0"},
      {"NaN density", [](BodyDef& d) { d.density = not_a_number; }, ErrorCode::bad_mass,
       "A density must be above zero, between"},
      {"zero mass", [](BodyDef& d) { d.mass = 0; }, ErrorCode::bad_mass,
       "The mass is 0 kg; a dynamic body's must be above zero. Use BodyKind::fixed"},
      {"negative mass", [](BodyDef& d) { d.mass = -2; }, ErrorCode::bad_mass, "The mass is -2 kg"},
      {"NaN mass", [](BodyDef& d) { d.mass = not_a_number; }, ErrorCode::not_finite,
       "The mass or a moment of inertia is not a number"},
      {"infinite mass", [](BodyDef& d) { d.mass = infinity; }, ErrorCode::not_finite,
       "The mass or a moment of inertia is not a number"},
      {"moments alone",
       [](BodyDef& d) {
         d.moments = Vec3{1, 1, 1};
       },
       ErrorCode::bad_mass, "Moments of inertia are given without a mass; give both, or neither."},
      {"zero moment",
       [](BodyDef& d) {
         d.mass = 1;
         d.moments = Vec3{1, 0, 1};
       },
       ErrorCode::bad_mass, "A moment of inertia is not above zero"},
      {"NaN moment",
       [](BodyDef& d) {
         d.mass = 1;
         d.moments = Vec3{1, not_a_number, 1};
       },
       ErrorCode::not_finite, "The mass or a moment of inertia is not a number"},
      {"impossible moments",
       [](BodyDef& d) {
         d.mass = 1;
         d.moments = Vec3{1, 1, 3};
       },
       ErrorCode::bad_mass, "The moments of inertia (1, 1, 3) belong to no body"},
      {"no shape and no mass", [](BodyDef& d) { d.shapes.clear(); }, ErrorCode::bad_mass,
       "A dynamic body without shapes needs a mass and moments of inertia."},
      {"several shapes", [](BodyDef& d) { d.shapes.push_back(d.shapes[0]); }, ErrorCode::bad_mass,
       "pass a body of several or displaced shapes through make_compound first"},
      {"displaced shape", [](BodyDef& d) { d.shapes[0].local.position.x = 1; }, ErrorCode::bad_mass, "make_compound"},
  };
  for (const BadBody& bad : cases) {
    INFO(std::string(bad.what));
    BodyDef def = ball({});
    bad.spoil(def);
    CHECK_REFUSED(p.world, p.world.create_body(def), bad.code, bad.words);
  }
}

TEST_CASE("create_body takes what is just allowed") {
  World world;
  BodyDef def = ball({1e15, 0, 0}, 1e-5);
  def.pose.orientation.w = 1.0005;
  const BodyId body = must(world.create_body(def));
  CHECK(length(must(world.pose(body)).orientation) == doctest::Approx(1).epsilon(1e-7));
  def = {};
  def.mass = 1;
  def.moments = Vec3{1, 2, 3};  // a flat body: the sum of two is the third
  (void)must(world.create_body(def));
  def.shapes = {ShapeDef::plane()};
  def.kind = BodyKind::fixed;
  (void)must(world.create_body(def));
}

TEST_CASE("set functions refuse") {
  Populated p;
  World& w = p.world;
  CHECK_REFUSED(w, w.set_gravity({0, not_a_number, 0}), ErrorCode::not_finite, "The gravity is (0, nan, 0)");
  CHECK_REFUSED(w, w.set_pose(p.a, {{0, infinity, 0}, {}}), ErrorCode::not_finite,
                "The position of a body is (0, inf, 0)");
  CHECK_REFUSED(w, w.set_pose(p.a, {{}, {0, 0, 0, 2}}), ErrorCode::not_unit_quaternion,
                "The orientation of a body has length 2");
  CHECK_REFUSED(w, w.set_pose(p.a, {{}, {not_a_number, 0, 0, 1}}), ErrorCode::not_finite,
                "The orientation of a body holds NaN");
  CHECK_REFUSED(w, w.set_velocity(p.a, {not_a_number, 0, 0}), ErrorCode::not_finite,
                "The velocity of a body is (nan, 0, 0)");
  CHECK_REFUSED(w, w.set_velocity(p.fixed, {1, 0, 0}), ErrorCode::bad_argument,
                "A fixed body has no velocity; make it kinematic to move it.");
  CHECK_REFUSED(w, w.set_angular_velocity(p.a, {0, 0, infinity}), ErrorCode::not_finite,
                "The angular velocity of a body is (0, 0, inf)");
  CHECK_REFUSED(w, w.set_angular_velocity(p.fixed, {0, 1, 0}), ErrorCode::bad_argument,
                "A fixed body has no angular velocity; make it kinematic to move it.");
  CHECK_REFUSED(w, w.set_position_last(p.a, {not_a_number, 0, 0}), ErrorCode::not_finite,
                "The last position of a body is (nan, 0, 0)");
  CHECK_REFUSED(w, w.set_position_last(p.fixed, {}), ErrorCode::bad_argument, "A fixed body has no last position");
  CHECK_REFUSED(w, w.set_orientation_last(p.a, {0, 0, 0, 0}), ErrorCode::not_unit_quaternion,
                "The last orientation of a body has length 0");
  CHECK_REFUSED(w, w.set_orientation_last(p.fixed, {}), ErrorCode::bad_argument,
                "A fixed body has no last orientation");
  CHECK_REFUSED(w, w.set_mass_properties(p.a, {0, {1, 1, 1}}), ErrorCode::bad_mass, "The mass is 0 kg");
  CHECK_REFUSED(w, w.set_mass_properties(p.a, {1, {1, 1, 5}}), ErrorCode::bad_mass, "belong to no body");
  CHECK_REFUSED(w, w.set_mass_properties(p.a, {not_a_number, {1, 1, 1}}), ErrorCode::not_finite, "not a number");
  CHECK_REFUSED(w, w.set_mass_properties(p.fixed, {1, {1, 1, 1}}), ErrorCode::bad_argument,
                "Only dynamic bodies have a mass.");
  CHECK_REFUSED(w, w.set_mass_properties(p.kinematic, {1, {1, 1, 1}}), ErrorCode::bad_argument,
                "Only dynamic bodies have a mass.");
  CHECK_REFUSED(w, w.set_material(p.a, {-1, 0, 0}), ErrorCode::bad_argument, "below zero");
  CHECK_REFUSED(w, w.set_material(p.a, {0, 0, 2}), ErrorCode::bad_argument, "The restitution is 2");
  CHECK_REFUSED(w, w.set_material(p.a, {0, 0, 0, -0.1}), ErrorCode::bad_argument, "it is a length");
  CHECK_REFUSED(w, w.set_material(p.a, {0, 0, 0, 0, -1}), ErrorCode::bad_argument, "it is a length");
  CHECK_REFUSED(w, w.set_material(p.a, {0, 0, 0, infinity}), ErrorCode::not_finite, "not a number");
  CHECK_REFUSED(w, w.set_material(p.a, {0, 0, 0, 0, 0, Combine(9)}), ErrorCode::bad_argument, "rule");
  CHECK_REFUSED(w, w.set_material(p.a, {0, 0, 0, 0, 0, Combine::mean, Combine(5)}), ErrorCode::bad_argument, "rule");
  CHECK_REFUSED(w, w.set_material(p.a, {1e300, 1e300, 0}), ErrorCode::not_finite, "or larger than 1e+15");
  CHECK_REFUSED(w, w.set_drag(p.a, -1, 0), ErrorCode::bad_argument, "A drag is below zero; use 0 for none.");
  CHECK_REFUSED(w, w.set_drag(p.a, 0, not_a_number), ErrorCode::not_finite, "The angular drag of a body is nan");
  CHECK_REFUSED(w, w.add_force(p.a, Wrench{{not_a_number, 0, 0}, {}}), ErrorCode::not_finite,
                "The force on a body is (nan, 0, 0)");
  CHECK_REFUSED(w, w.add_force(p.a, Wrench{{}, {0, infinity, 0}}), ErrorCode::not_finite,
                "The torque on a body is (0, inf, 0)");
  CHECK_REFUSED(w, w.add_force(p.a, ForceCallback{}), ErrorCode::bad_argument,
                "The force callback is empty; pass a function.");
  CHECK_REFUSED(
      w, w.view("speed of light"), ErrorCode::unknown_name,
      "There is no property \"speed of light\"; docs/properties.md lists those of the library, World::properties all.");
}

TEST_CASE("create_joint refuses") {
  Populated p;
  const auto refused = [&](auto&& spoil, ErrorCode code, const char* words) {
    JointDef def = p.joint_def();
    spoil(def);
    CHECK_REFUSED(p.world, p.world.create_joint(def), code, words);
  };
  refused([&](JointDef& d) { d.b = d.a; }, ErrorCode::bad_joint,
          "A joint needs two different bodies; use the world's ground() to hold a body in place.");
  refused([&](JointDef& d) { d.a = p.fixed, d.b = p.kinematic; }, ErrorCode::bad_joint,
          "Neither body of the joint is dynamic");
  refused([&](JointDef& d) { d.a = p.world.ground(), d.b = p.fixed; }, ErrorCode::bad_joint,
          "Neither body of the joint is dynamic");
  refused([&](JointDef& d) { d.frame_a.position.x = not_a_number; }, ErrorCode::not_finite,
          "The pin of a joint in body a is (nan, 0, 0)");
  refused([&](JointDef& d) { d.frame_b.position.x = infinity; }, ErrorCode::not_finite,
          "The pin of a joint in body b is (inf, 0, 0)");
  refused([&](JointDef& d) { d.frame_a.orientation.w = 3; }, ErrorCode::not_unit_quaternion,
          "The frame of a joint in body a has length 3");
  refused([&](JointDef& d) { d.frame_b.orientation.w = not_a_number; }, ErrorCode::not_finite,
          "The frame of a joint in body b holds NaN");
  refused([&](JointDef& d) { d.freedom = AngleFreedom::cone_and_twist(-0.1, 0); }, ErrorCode::bad_joint,
          "The cone and twist of a joint must be zero or above [rad].");
  refused([&](JointDef& d) { d.freedom = AngleFreedom::cone_and_twist(0, not_a_number); }, ErrorCode::bad_joint,
          "The cone and twist of a joint");
  refused(
      [&](JointDef& d) {
        d.freedom = AngleFreedom::between({0, 1, 0}, {0, 0, 0});
      },
      ErrorCode::bad_joint, "An angle limit of a joint has its lower bound above its upper one");
  refused([&](JointDef& d) { d.freedom.upper.y = not_a_number; }, ErrorCode::bad_joint, "is not a number");  // not used
  refused(
      [&](JointDef& d) {
        d.freedom = AngleFreedom::between({0, 0, not_a_number}, {0, 0, 0});
      },
      ErrorCode::bad_joint, "or an angle limit, is not a number");
}

TEST_CASE("create_ragdoll refuses, whole") {
  Populated p;
  const auto refused = [&](auto&& spoil, ErrorCode code, const char* words) {
    RagdollDef def = RagdollDef::human();
    Pose pose;
    Vec3 velocity;
    spoil(def, pose, velocity);
    CHECK_REFUSED(p.world, p.world.create_ragdoll(def, pose, velocity), code, words);
  };
  refused([](RagdollDef& d, Pose&, Vec3&) { d.bones[5].parent = 7; }, ErrorCode::bad_joint,
          "Bone 5 of a ragdoll must have a parent that stands before it.");
  refused([](RagdollDef& d, Pose&, Vec3&) { d.bones[3].parent = -1; }, ErrorCode::bad_joint, "Bone 3 of a ragdoll");
  refused([](RagdollDef& d, Pose&, Vec3&) { d.bones[11].shape.size.x = 0; }, ErrorCode::degenerate_shape,
          "The radius of a shape is 0 m");
  refused([](RagdollDef& d, Pose&, Vec3&) { d.bones[11].joint.x = not_a_number; }, ErrorCode::not_finite,
          "The pin of a joint in body a");
  refused([](RagdollDef& d, Pose&, Vec3&) { d.bones[11].joint_axes.w = 5; }, ErrorCode::not_unit_quaternion,
          "The frame of a joint in body a");
  refused([](RagdollDef& d, Pose&, Vec3&) { d.bones[11].pose.position.y = infinity; }, ErrorCode::not_finite,
          "The position of a body");
  refused([](RagdollDef& d, Pose&, Vec3&) { d.bones[11].freedom = AngleFreedom::cone_and_twist(-1, 0); },
          ErrorCode::bad_joint, "The cone and twist");
  refused([](RagdollDef& d, Pose&, Vec3&) { d.density = 0; }, ErrorCode::bad_mass, "A density must be above zero");
  refused([](RagdollDef& d, Pose&, Vec3&) { d.material.restitution = 3; }, ErrorCode::bad_argument,
          "The restitution is 3");
  refused([](RagdollDef&, Pose& pose, Vec3&) { pose.position.x = not_a_number; }, ErrorCode::not_finite,
          "The position of a body");
  refused([](RagdollDef&, Pose& pose, Vec3&) { pose.orientation.w = 0; }, ErrorCode::not_unit_quaternion,
          "The orientation of a ragdoll has length 0");
  refused([](RagdollDef&, Pose&, Vec3& velocity) { velocity.z = not_a_number; }, ErrorCode::not_finite,
          "The velocity of a body");
}

TEST_CASE("mass_properties and make_compound refuse") {
  const auto refused = [](const auto& answer, ErrorCode code, const char* words) {
    check_refused(bool(answer), answer ? Error{} : answer.error(), code, words);
  };
  refused(mass_properties(ShapeDef::sphere(0), 1), ErrorCode::degenerate_shape, "The radius of a shape is 0 m");
  refused(mass_properties(ShapeDef::sphere(1), 0), ErrorCode::bad_mass, "A density must be above zero");
  refused(mass_properties(ShapeDef::sphere(1), infinity), ErrorCode::bad_mass, "A density must be above zero");
  refused(mass_properties(ShapeDef::sphere(1), 1e300), ErrorCode::bad_mass, "between 1e-30 and 1e+30 kg/m^3");
  refused(mass_properties(ShapeDef::sphere(1), 1e-300), ErrorCode::bad_mass, "between 1e-30 and 1e+30 kg/m^3");
  ShapeDef odd = ShapeDef::sphere(1);
  odd.size.z = infinity;
  refused(mass_properties(odd, 1), ErrorCode::not_finite, "The size of a shape is (1, 0, inf)");
  refused(mass_properties(ShapeDef::plane(), 1), ErrorCode::bad_mass, "A plane has no mass: use it on fixed bodies.");
  BodyDef def;
  refused(make_compound(def), ErrorCode::degenerate_shape, "A compound needs at least one shape.");
  def = ball({1, 2, 3});
  def.shapes.push_back(ShapeDef::plane());
  refused(make_compound(def), ErrorCode::bad_mass, "A plane has no mass");
  CHECK(def.shapes.size() == 2);
  CHECK(def.pose.position == Vec3{1, 2, 3});
  CHECK_FALSE(def.mass.has_value());
  def = ball({1, 2, not_a_number});
  refused(make_compound(def), ErrorCode::not_finite, "The position of a body");
  def = ball({});
  def.mass = 1e300;
  refused(make_compound(def), ErrorCode::bad_mass, "A mass or moment of inertia is 1e+300");
  def = ball({});
  def.density = 1e30;
  def.shapes.push_back(ShapeDef::sphere(1));
  def.shapes[1].local.position = {1e15, 0, 0};
  refused(make_compound(def), ErrorCode::bad_mass, "A mass or moment of inertia");
}
