// Pins one hand-computed example of every pair: normal, separations, points midway between the surfaces.
#include <doctest/doctest.h>

#include "tests/narrow_support.h"

using namespace narrow_test;
using doctest::Approx;

namespace {
constexpr double pi = 3.14159265358979323846;
Shape sphere(double r, Vec3 p = {}) { return shape(ShapeKind::sphere, {r, 0, 0}, p); }
Shape capsule(double r, double h, Vec3 p = {}, Quat q = {}) { return shape(ShapeKind::capsule, {r, h, 0}, p, q); }
Shape box(Vec3 h, Vec3 p = {}, Quat q = {}) { return shape(ShapeKind::box, h, p, q); }
Shape cylinder(double r, double h, Vec3 p = {}, Quat q = {}) { return shape(ShapeKind::cylinder, {r, h, 0}, p, q); }
Shape plane(double height, Quat q = {}) { return shape(ShapeKind::plane, {}, {0, height, 0}, q); }

// The same in float and double, and with the shapes swapped.
void expect(const Shape& a, const Shape& b, Vec3 n, std::uint32_t count, double separation, double margin = 0.05) {
  CAPTURE(pair_name(a.kind, b.kind));
  const Manifold<double> m = find(a, b, margin), s = find(b, a, margin);
  const Manifold<float> f = find(to_float(a), to_float(b), float(margin));
  REQUIRE(m.count == count);
  REQUIRE(s.count == count);
  REQUIRE(f.count == count);
  CHECK(length(normal(m) - n) < 1e-6);
  CHECK(length(normal(s) + n) < 1e-6);
  CHECK(length(normal(f) - n) < 1e-5);
  CHECK(deepest(m) == Approx(separation).epsilon(1e-9).scale(1));
  CHECK(deepest(f) == Approx(separation).epsilon(2e-6).scale(1));
  for (std::uint32_t i = 0; i < count; i++) {  // a point midway: half the separation outside either surface
    CHECK(length(nearest(a, point(m, i)) - point(m, i)) <= std::max(0.0, m.points[i].separation) / 2 + 1e-6);
    CHECK(length(nearest(b, point(m, i)) - point(m, i)) <= std::max(0.0, m.points[i].separation) / 2 + 1e-6);
  }
}
}  // namespace

TEST_CASE("narrow: spheres") {
  expect(sphere(0.5), sphere(0.25, {0, 0.7, 0}), {0, 1, 0}, 1, -0.05);
  expect(sphere(0.5), sphere(0.25, {0, 0, 0.79}), {0, 0, 1}, 1, 0.04);
  expect(sphere(0.5), capsule(0.2, 1, {0.6, 0.5, 0}), {1, 0, 0}, 1, -0.1);
  expect(sphere(0.5), capsule(0.2, 1, {0, 1.6, 0}), {0, 1, 0}, 1, -0.1);
  expect(sphere(0.5), box({1, 1, 1}, {0.3, -1.4, 0.2}), {0, -1, 0}, 1, -0.1);
  const double r = std::sqrt(1.0 / 3);
  expect(sphere(0.5, {1.3, 1.3, 1.3}), box({1, 1, 1}), {-r, -r, -r}, 1, 0.3 / r - 0.5);
  expect(sphere(0.5, {0.1, 0.2, 0.8}), box({1, 1, 1}), {0, 0, -1}, 1, -0.7);
  expect(sphere(0.5, {0.3, 1.4, 0}), cylinder(0.6, 1), {0, -1, 0}, 1, -0.1);
  expect(sphere(0.5, {0, 0.2, 1}), cylinder(0.6, 1), {0, 0, -1}, 1, -0.1);
  expect(sphere(0.5, {0, 1.3, 0.9}), cylinder(0.6, 1), {0, -std::sqrt(0.5), -std::sqrt(0.5)}, 1, std::sqrt(0.18) - 0.5);
  expect(sphere(0.5, {3, 0.4, 2}), plane(0), {0, -1, 0}, 1, -0.1);
}

TEST_CASE("narrow: capsules") {
  const Quat lying = axis_angle({0, 0, 1}, pi / 2), across = axis_angle({1, 0, 0}, pi / 2);
  expect(capsule(0.2, 0.5, {}, lying), capsule(0.3, 0.5, {0.2, -0.45, 0}, lying), {0, -1, 0}, 2, -0.05);
  expect(capsule(0.2, 0.5, {}, lying), capsule(0.3, 0.5, {0.2, -0.45, 0}, across), {0, -1, 0}, 1, -0.05);
  expect(capsule(0.2, 0.5, {}, lying), capsule(0.3, 0.5, {1.45, 0, 0}, lying), {1, 0, 0}, 1, -0.05);
  expect(capsule(0.2, 0.5, {0.1, 1.15, 0}, lying), box({1, 1, 1}), {0, -1, 0}, 2, -0.05);
  expect(capsule(0.2, 0.5, {0.8, 1.15, 0}, lying), box({1, 1, 1}), {0, -1, 0}, 2, -0.05);
  expect(capsule(0.2, 0.5, {0.1, 1.65, 0}), box({1, 1, 1}), {0, -1, 0}, 1, -0.05);
  const double r = std::sqrt(0.5);
  expect(capsule(0.2, 0.5, {1.1, 1.1, 0}, across), box({1, 1, 1}), {-r, -r, 0}, 2, 0.1 / r - 0.2);
  expect(capsule(0.2, 0.5, {0, 0.15, 0}, lying), plane(0), {0, -1, 0}, 2, -0.05);
  expect(capsule(0.2, 0.5, {0, 0.65, 0}), plane(0), {0, -1, 0}, 1, -0.05);
}

TEST_CASE("narrow: boxes") {
  expect(box({0.5, 0.5, 0.5}), box({0.5, 0.5, 0.5}, {0, -0.95, 0}), {0, -1, 0}, 4, -0.05);
  expect(box({0.5, 0.5, 0.5}), box({0.5, 0.5, 0.5}, {0.5, -0.95, 0}), {0, -1, 0}, 4, -0.05);
  expect(box({0.5, 0.5, 0.5}), box({0.5, 0.5, 0.5}, {0, -1.02, 0}), {0, -1, 0}, 4, 0.02);
  expect(box({0.5, 0.5, 0.5}), box({0.5, 0.5, 0.5}, {0, -0.95, 0}, axis_angle({0, 1, 0}, pi / 4)), {0, -1, 0}, 4,
         -0.05);
  // standing on an edge, on a corner
  expect(box({0.5, 0.5, 0.5}, {}, axis_angle({0, 0, 1}, pi / 4)), box({2, 0.5, 2}, {0, -1.15, 0}), {0, -1, 0}, 2,
         0.65 - std::sqrt(0.5));
  const Quat corner = axis_angle({std::sqrt(0.5), 0, -std::sqrt(0.5)}, std::acos(1 / std::sqrt(3.0)));
  expect(box({0.5, 0.5, 0.5}, {}, corner), box({2, 0.5, 2}, {0, -1.34, 0}), {0, -1, 0}, 1, 0.84 - std::sqrt(0.75));
  // two edges across: x edge of a over z edge of b
  const Quat about_x = axis_angle({1, 0, 0}, pi / 4), about_z = axis_angle({0, 0, 1}, pi / 4);
  expect(box({0.5, 0.5, 0.5}, {}, about_x), box({0.5, 0.5, 0.5}, {0, 1.4, 0}, about_z), {0, 1, 0}, 1,
         1.4 - std::sqrt(2.0));
  // corners apart: the distance of two corners
  const double r = std::sqrt(1.0 / 3);
  expect(box({0.5, 0.5, 0.5}), box({0.5, 0.5, 0.5}, {1.02, 1.02, 1.02}), {r, r, r}, 1, 0.02 / r);
  expect(box({0.5, 0.5, 0.5}, {0, 0.45, 0}), plane(0), {0, -1, 0}, 4, -0.05);
}

TEST_CASE("narrow: cylinders") {
  const Quat lying = axis_angle({0, 0, 1}, pi / 2);
  expect(cylinder(0.5, 1, {0, 0.95, 0}), plane(0), {0, -1, 0}, 4, -0.05);
  expect(cylinder(0.5, 1, {0, 0.45, 0}, lying), plane(0), {0, -1, 0}, 2, -0.05);
  const double t = 0.3, height = std::cos(t) + 0.5 * std::sin(t);
  expect(cylinder(0.5, 1, {0, height, 0}, axis_angle({0, 0, 1}, t)), plane(0), {0, -1, 0}, 1, 0);
  expect(cylinder(0.5, 1, {0, 1.95, 0}), box({1, 1, 1}), {0, -1, 0}, 4, -0.05);
  expect(cylinder(0.5, 0.7, {0, 1.45, 0}, lying), box({1, 1, 1}), {0, -1, 0}, 2, -0.05);
  expect(cylinder(0.5, 1, {0, 1.95, 0}), cylinder(0.5, 1), {0, -1, 0}, 4, -0.05);
  expect(cylinder(0.5, 1, {0.95, 0.5, 0}), cylinder(0.5, 1), {-1, 0, 0}, 2, -0.05);
  expect(capsule(0.2, 0.5, {0, 1.15, 0}, lying), cylinder(0.6, 1), {0, -1, 0}, 2, -0.05);
  expect(capsule(0.2, 0.5, {0.75, 0, 0}), cylinder(0.6, 1), {-1, 0, 0}, 2, -0.05);
}

TEST_CASE("narrow: nothing beyond the margin, a point within it") {
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < 5; b++) {
      Pairs pairs(unsigned(a * 5 + b));
      const Shape s = pairs.random_shape(ShapeKind(a));
      Shape t = b == 4 ? plane(0) : pairs.random_shape(ShapeKind(b));
      const double touch = -(reach(s, {0, -1, 0}) + reach(t, {0, 1, 0}));
      CAPTURE(pair_name(s.kind, t.kind));
      place(t, {0, touch - 0.011, 0});
      CHECK(find(s, t, 0.01).count == 0);
      place(t, {0, touch - 1.0, 0});
      CHECK(find(s, t, 0.01).count == 0);
      if (b < 4) {
        const auto [x, y] = pairs.pair(ShapeKind(std::min(a, b)), ShapeKind(std::max(a, b)), Stratum::near_touching);
        CHECK(find(x, y, 0.05).count > 0);
      }
    }
}
