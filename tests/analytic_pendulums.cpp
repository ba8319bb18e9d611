// Pins A6 to A8: what turns about a pin, solved directly. Second order in the step, twice the error of converged
// SHAKE at most, one sub-step a step. cases/pendulums.cpp holds the cases and their bounds.
#include "pcphys/constants.h"
#include "support_cases.h"

using namespace physics;

TEST_CASE("A7: a compound pendulum") {
  for (const Mode& mode : precisions()) {
    const auto rows = rows_of("A7", mode);
    check_rows(rows, metric("position"));
    check_rows(rows, metric("pivot force"));
    if (!mode.is_double()) check_rows(rows, metric("joint gap"));
    if (mode.is_double()) check_rows(rows, metric("2 - order"));
    check_rows(rows, [](const cases::Row& row) {
      return row.metric.starts_with("energy /") && row.variant == "90 deg" && row.substeps == 1;
    });
  }
}

TEST_CASE("A8: a double pendulum from horizontal") {
  for (const Mode& mode : precisions()) check_rows(rows_of("A8", mode));
}

// They turn about their pins between impulses, under gravity, in fourth order (kernels/pivot_turn.inl).
TEST_CASE("A6: a heavy top keeps its spin and its angular momentum, and its axis to fourth order") {
  for (const Mode& mode : precisions()) check_rows(rows_of("A6", mode));
}

TEST_CASE("A9: a door on a hinge or on two pins, let go and with drag") {
  for (const Mode& mode : precisions())
    for (const char* variant : {"a, free, hinge", "b, drag, hinge", "a, free, two pins", "b, drag, two pins"})
      check_rows(rows_of("A9", mode, {}, variant));
}

TEST_CASE("A20: a pendulum under steps of changing length") {
  for (const Mode& mode : precisions()) check_rows(rows_of("A20", mode));
}

TEST_CASE("a body on a pin that stands apart from it is drawn there at the push speed, without a velocity") {
  for (const Mode& mode : precisions()) {
    Run run(mode, {}, 4);
    BodyDef body;
    body.shapes = {ShapeDef::sphere(0.1)};
    body.mass = 1;
    const BodyId id = run.add(body);
    JointDef joint;
    joint.a = run.world.ground();
    joint.b = id;
    joint.frame_a.position = {1, 0, 0};
    joint.frame_b.position = {0.5, 0, 0};
    const auto made = run.world.create_joint(joint);
    REQUIRE(made);
    run.step(1.0 / 60);
    const double gap = *run.world.joint_separation(*made);
    CHECK(gap == doctest::Approx(0.5 - constants::joint_push_speed / 60).epsilon(1e-5));
    CHECK(length(*run.world.velocity(id)) <= 1e-6);
    run.step(1.0 / 60, 60);
    CHECK(*run.world.joint_separation(*made) <= 1e-6);
  }
}
