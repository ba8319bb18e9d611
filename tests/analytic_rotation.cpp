// Pins A3, A4 and A10: free rotation by splitting. Angular momentum is kept to the last digit, symmetric bodies turn
// exactly, asymmetric ones to second order with errors far below those of a Lie midpoint step. cases/rotation.cpp
// holds the cases and their bounds.
#include "support_cases.h"

using namespace physics;

TEST_CASE("A3: a symmetric top is exact at every step length, whichever body axis is its own, double") {
  const auto rows = rows_of("A3", {Precision::f64});
  check_rows(rows);
  for (const cases::Row& row : rows)
    if (row.metric == "attitude [rad]") CHECK(row.error <= 1e-9);  // the target, far below the must
}

TEST_CASE("A3: a symmetric top, single") {
  const auto rows = rows_of("A3", {Precision::f32});
  check_rows(rows);
  for (const cases::Row& row : rows)
    if (row.metric == "attitude [rad]") CHECK(row.error <= 1.5e-4);
}

TEST_CASE("A3: the library's cylinder has the moments of the closed form") {
  const auto m = mass_properties(ShapeDef::cylinder(0.2, 0.02), 1000);
  REQUIRE(m);
  CHECK(m->moments.y / m->mass == doctest::Approx(0.04 / 2).epsilon(1e-14));
  CHECK(m->moments.x / m->mass == doctest::Approx(0.020266666666666667 / 2).epsilon(1e-14));
  CHECK(m->moments.z == m->moments.x);
}

TEST_CASE("A4: tumble, flips, energy over 1000 s, 100,000 steps") {
  for (const Mode& mode : precisions()) check_rows(rows_of("A4", mode));
}

TEST_CASE("A4b: on every backend and lane width") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    check_rows(rows_of("A4", mode, 1.0 / 60, "b, tumble"), metric("attitude"));
  }
}

TEST_CASE("A10: a tumble with drag") {
  for (const Mode& mode : precisions()) {
    const auto rows = rows_of("A10", mode);
    check_rows(rows, metric("attitude"));
    check_rows(rows, metric("position"));
  }
}
