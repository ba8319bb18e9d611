// Several joints between the same two bodies: they are solved as one (src/plan/solved_joints.h), and stay what they
// were to the host.
#include "support_physics.h"

using namespace physics;

namespace {

BodyDef plate(Vec3 at) {
  BodyDef def;
  def.shapes = {ShapeDef::box({0.5, 0.02, 1})};
  def.shapes[0].filter.mask = 0;
  def.mass = 10;
  def.pose.position = at;
  return def;
}
JointId pin(Run& run, BodyId a, Vec3 at_a, BodyId b, Vec3 at_b, const AngleFreedom& freedom = {}, Quat axes = {}) {
  JointDef def;
  def.frame_a.orientation = axes;
  def.frame_b.orientation = axes;
  def.a = a;
  def.b = b;
  def.frame_a.position = at_a;
  def.frame_b.position = at_b;
  def.freedom = freedom;
  const auto made = run.world.create_joint(def);
  REQUIRE(made);
  return *made;
}
std::uint32_t rows(Run& run) { return run.stepper.step(run.world, 1.0 / 240).joints_as_rows; }

}  // namespace

TEST_CASE("merged joints: two pins swing as a hinge does") {
  for (const Mode& mode : precisions()) {
    Run pins(mode, {0, -9.81, 1}), hinge(mode, {0, -9.81, 1});
    const BodyId a = pins.add(plate({0.5, 0, 0})), b = hinge.add(plate({0.5, 0, 0}));
    const JointId top = pin(pins, pins.world.ground(), {0, 0, 0.9}, a, {-0.5, 0, 0.9});
    const JointId low = pin(pins, a, {-0.5, 0, -0.9}, pins.world.ground(), {0, 0, -0.9});  // the other way about
    JointDef def;
    def.a = hinge.world.ground();
    def.b = b;
    def.frame_a.orientation = axis_angle({0, 1, 0}, -std::acos(0.0));
    def.frame_b = {{-0.5, 0, 0}, def.frame_a.orientation};
    def.freedom = AngleFreedom::hinge();
    REQUIRE(hinge.world.create_joint(def));
    pins.step(1.0 / 240, 480);
    hinge.step(1.0 / 240, 480);
    CHECK(rows(pins) == 0);
    CHECK(rows(hinge) == 0);
    CHECK(length(pins.position(a) - hinge.position(b)) <= (mode.is_double() ? 1e-12 : 2e-5));
    for (const JointId joint : {top, low})
      CHECK(*pins.world.joint_separation(joint) <= (mode.is_double() ? 1e-12 : 2e-6));
    CHECK((pins.world.joint(top)->frame_b.position == Vec3{-0.5, 0, 0.9}));
  }
}

TEST_CASE("merged joints: three pins hold as a weld") {
  for (const Mode& mode : precisions()) {
    Run run(mode, {0, -9.81, 0}, 4);
    const BodyId a = run.add(plate({0.5, 0, 0}));
    JointId joints[3];
    int i = 0;
    for (const Vec3 at : {Vec3{0, 0, 0.9}, Vec3{0, 0, -0.9}, Vec3{0.3, 0, 0}})
      joints[i++] = pin(run, run.world.ground(), at, a, at - Vec3{0.5, 0, 0});
    run.step(1.0 / 240, 480);
    CHECK(rows(run) == 0);
    CHECK(length(run.position(a) - Vec3{0.5, 0, 0}) <= 1e-4);
    for (const JointId joint : joints) CHECK(*run.world.joint_separation(joint) <= 1e-4);
  }
}

TEST_CASE("merged joints: pins in one place are one pin, and what does not match meets in the middle") {
  for (const Mode& mode : precisions()) {
    Run one(mode, {1, -9.81, 1}), two(mode, {1, -9.81, 1});
    const BodyId a = one.add(plate({0.5, 0, 0})), b = two.add(plate({0.5, 0, 0}));
    pin(one, one.world.ground(), {}, a, {-0.5, 0, 0});
    for (int i = 0; i < 2; i++) pin(two, two.world.ground(), {}, b, {-0.5, 0, 0});
    one.step(1.0 / 240, 240);
    two.step(1.0 / 240, 240);
    CHECK(one.world.hash() != 0);
    CHECK((one.position(a) == two.position(b)));

    Run uneven(mode, {0, -9.81, 0});
    const BodyId c = uneven.add(plate({0.5, 0, 0}));
    const JointId top = pin(uneven, uneven.world.ground(), {0, 0, 1}, c, {-0.5, 0, 0.9});
    const JointId low = pin(uneven, uneven.world.ground(), {0, 0, -1}, c, {-0.5, 0, -0.9});
    uneven.step(1.0 / 240, 480);
    for (const JointId joint : {top, low})
      CHECK(*uneven.world.joint_separation(joint) == doctest::Approx(0.1).epsilon(1e-4));
  }
}

TEST_CASE("merged joints: joints with angles of their own stay as they are") {
  for (const Mode& mode : precisions()) {
    Run run(mode, {0, -9.81, 0}, 4);
    const BodyId a = run.add(plate({0.5, 0, 0}));
    pin(run, run.world.ground(), {0, 0, 0.9}, a, {-0.5, 0, 0.9});
    const JointId second =
        pin(run, run.world.ground(), {0, 0, -0.9}, a, {-0.5, 0, -0.9}, AngleFreedom::cone_and_twist(1, 1));
    CHECK(rows(run) == 1);
    REQUIRE(run.world.destroy(second));
    pin(run, run.world.ground(), {0, 0, -0.9}, a, {-0.5, 0, -0.9});
    CHECK(rows(run) == 0);
  }
}

TEST_CASE("merged joints: a door on two hinges, one of which has limits, is a door on one") {
  const Quat along_z = axis_angle({0, 1, 0}, -std::acos(0.0));
  for (const Mode& mode : precisions())
    for (const double askew : {0.0, 0.004}) {
      Run two(mode, {0, -9.81, 0}), one(mode, {0, -9.81, 0});
      const AngleFreedom limits = AngleFreedom::hinge(-0.5, 0.5);
      const BodyId a = two.add(plate({0.5, 0, 0})), b = one.add(plate({0.5, 0, 0}));
      const Quat other = axis_angle({1, 0, 0}, askew) * along_z;
      pin(two, two.world.ground(), {0, 0, 0.9}, a, {-0.5, 0, 0.9}, AngleFreedom::hinge(), other);
      pin(two, two.world.ground(), {0, 0, -0.9}, a, {-0.5, 0, -0.9}, limits, along_z);
      pin(one, one.world.ground(), {}, b, {-0.5, 0, 0}, limits, along_z);
      two.step(1.0 / 240, 240);
      one.step(1.0 / 240, 240);
      CHECK(rows(two) == 0);
      CHECK(one.position(b).y < -0.2);
      CHECK(length(two.position(a) - one.position(b)) <= (askew > 0 ? 5e-3 : mode.is_double() ? 1e-7 : 2e-4));
    }
}

TEST_CASE("merged joints: a hinge and a pin beside its axis hold as a weld") {
  for (const Mode& mode : precisions()) {
    Run run(mode, {0, -9.81, 0}, 4);
    const BodyId a = run.add(plate({0.5, 0, 0}));
    pin(run, run.world.ground(), {}, a, {-0.5, 0, 0}, AngleFreedom::hinge(-1, 1),
        axis_angle({0, 1, 0}, -std::acos(0.0)));
    pin(run, run.world.ground(), {0.4, 0, 0}, a, {-0.1, 0, 0});
    run.step(1.0 / 240, 480);
    CHECK(rows(run) == 0);
    CHECK(length(run.position(a) - Vec3{0.5, 0, 0}) <= 1e-4);
  }
}

/// Two bodies at rest without gravity, held by a hinge and a pin whose distances differ by centimetres. When the second
/// was a row 2,600 times the energy of such a scene came of it in one step.
TEST_CASE("merged joints: what contradicts comes to rest in the middle, and makes no energy") {
  for (const Mode& mode : precisions()) {
    Run run(mode, {});
    const BodyId a = run.add(plate({})), b = run.add(plate({1.2, 0.1, 0}));
    pin(run, a, {0.6, 0, 0.5}, b, {-0.6, -0.1, 0.5}, AngleFreedom::hinge());
    pin(run, a, {0.6, 0, -0.5}, b, {-0.58, -0.05, -0.47});
    for (int i = 0; i < 240; i++) {
      run.step(1.0 / 60, 1);
      CHECK(run.world.kinetic_energy() <= (mode.is_double() ? 1e-20 : 1e-9));
    }
    CHECK(rows(run) == 0);
  }
}

/// A snapshot of when a motor kept them apart has impulses of both; of joints that are one again the second stands
/// back.
TEST_CASE(
    "merged joints: a snapshot of when they were two goes on the same for a stepper that knows them and for a new "
    "one") {
  for (const Mode& mode : precisions()) {
    Run run(mode, {0, -9.81, 0}, 4);
    const BodyId a = run.add(plate({0.5, 0, 0}));
    pin(run, run.world.ground(), {0, 0, 0.9}, a, {-0.5, 0, 0.9});
    const JointId second = pin(run, run.world.ground(), {0, 0, -0.9}, a, {-0.5, 0, -0.9});
    REQUIRE(run.world.set_motor(second, {2, 5}));
    run.step(1.0 / 60, 10);
    const std::vector<std::byte> apart = run.world.snapshot();
    REQUIRE(run.world.set_motor(second, {}));
    run.step(1.0 / 60, 2);
    REQUIRE(run.world.restore(apart));
    run.step(1.0 / 60, 2);
    const std::uint64_t known = run.world.hash();
    REQUIRE(run.world.restore(apart));
    Stepper stepper(run.stepper.settings());
    for (int i = 0; i < 2; i++) REQUIRE(stepper.step(run.world, 1.0 / 60));
    CHECK(run.world.hash() == known);
  }
}
