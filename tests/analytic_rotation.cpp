// Pins A3, A4 and A10: free rotation by splitting. Angular momentum is kept to the last digit, symmetric bodies turn
// exactly, asymmetric ones to second order with errors far below those of a Lie midpoint step. cases/rotation.cpp
// holds the cases and their bounds.
#include <algorithm>
#include <cmath>

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

TEST_CASE("free boxes that turn by a third of a radian in a sub-step keep their energy to rounding") {
  // Fourth order alone left the first one's off by 4.5e-7, in double precision too.
  struct Box {
    Vec3 half, spin;
    double dt;
  };
  for (const Mode& mode : precisions())
    for (const Box& box :
         {Box{{0.062, 0.21, 0.4}, {-16, 19, -23}, 1.0 / 30}, Box{{0.0085, 0.009, 0.049}, {-9.9, 48, 34}, 1.0 / 60}}) {
      CAPTURE(mode.name());
      CAPTURE(box.half.x);
      Run run(mode, {}, 4);
      BodyDef def;
      def.shapes = {ShapeDef::box(box.half)};
      def.pose.orientation = axis_angle({0.6, 0, 0.8}, 1);
      def.angular_velocity = box.spin;
      run.add(def);
      const double start = run.world.kinetic_energy();
      double off = 0;
      for (int i = 0; i < 60; i++) {
        run.step(box.dt);
        off = std::max(off, std::fabs(run.world.kinetic_energy() / start - 1));
      }
      MESSAGE(mode.name(), ", a box of ", box.half.x, ": energy off by ", off);
      CHECK(off <= (mode.precision == Precision::f64 ? 1e-12 : 1e-5));
    }
}
