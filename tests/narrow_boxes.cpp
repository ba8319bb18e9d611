// Pins the manifolds that stacks rest on: corners to the last digits on floors of any size, the same points and
// features from step to step.
#include <doctest/doctest.h>

#include <set>

#include "tests/narrow_support.h"

using namespace narrow_test;

namespace {
using View = ShapeView<float>;
View box(Vec3 h, Vec3 p = {}, Quat q = {}) { return to_float(shape(ShapeKind::box, h, p, q)); }
const Vec3 unit{0.5, 0.5, 0.5};
}  // namespace

TEST_CASE("narrow: a box on a floor of 200 m has its four corners to a millionth") {
  Pairs random(3);
  double worst_point = 0, worst_gap = 0;
  for (int i = 0; i < 20000; i++) {
    const Vec3 h{random.between(0.1, 0.5), random.between(0.1, 0.5), random.between(0.1, 0.5)};
    const float gap = float(random.between(-0.01, 0.01));
    const Quat turn_box =
        axis_angle({0, 1, 0}, random.between(-3, 3)) * axis_angle(random.direction(), random.between(0, 0.01));
    const View a = box(h, {}, turn_box);
    View b = box({100, 0.5, 100}, {random.between(-95, 95), 0, random.between(-95, 95)});
    b.p[1] = -float(h.y) - 0.5f - gap;
    const Manifold<float> m = find(a, b, 0.05f);
    REQUIRE(m.count == 4);
    CHECK(m.normal[1] == -1.0f);
    std::set<int> corners;
    for (std::uint32_t k = 0; k < 4; k++) {
      // against the exact corner of the float shapes
      const Vec3 p = point(m, k) - Vec3{0, m.points[k].separation / 2.0, 0};  // on the floor's top
      const Vec3 corner = point(m, k) + Vec3{0, m.points[k].separation / 2.0, 0};
      double best = 1e30;
      int which = 0;
      for (int c = 0; c < 8; c++) {
        const Shape exact = to_double(a);
        const Vec3 v =
            rotate(turn(exact), {c & 1 ? exact.size[0] : -exact.size[0], c & 2 ? exact.size[1] : -exact.size[1],
                                 c & 4 ? exact.size[2] : -exact.size[2]});
        if (length(v - corner) < best) {
          best = length(v - corner);
          which = c;
        }
      }
      corners.insert(which);
      worst_point = std::max(worst_point, best);
      worst_gap = std::max(worst_gap, std::abs(p.y - (double(b.p[1]) + 0.5)));
    }
    CHECK(corners.size() == 4);
  }
  MESSAGE("corners off by ", worst_point, ", floor by ", worst_gap);
  CHECK(worst_point < 1e-6);
  CHECK(worst_gap < 1e-6);
}

TEST_CASE("narrow: a resting stack of boxes keeps its points and features") {
  Pairs random(4);
  for (const double offset : {0.0, 0.25, 0.5}) {  // towers and bricks
    std::set<std::set<std::uint32_t>> seen;
    for (int i = 0; i < 2000; i++) {
      const double jitter = 1e-5;
      const View a = box(unit, {}, axis_angle(random.direction(), jitter));
      const View b = box(unit, Vec3{offset, -1, 0} + random.ball(jitter), axis_angle(random.direction(), jitter));
      const Manifold<float> m = find(a, b, 0.02f);
      REQUIRE(m.count == 4);
      for (std::uint32_t k = 0; k < 4; k++) {
        CHECK(std::abs(m.points[k].separation) < 4e-5);
        CHECK(std::abs(std::abs(m.points[k].p[2]) - 0.5) < 1e-4);
        const double x = m.points[k].p[0];
        CHECK(std::min(std::abs(x - 0.5), std::abs(x - (offset - 0.5))) < 1e-4);
      }
      CHECK(features(m).size() == 4);
      seen.insert(features(m));
    }
    CHECK(seen.size() == 1);
  }
}

TEST_CASE("narrow: a standing cylinder keeps its points and features") {
  Pairs random(6);
  const View floors[] = {box({2, 0.5, 2}, {0.3, -1, 0}), box({100, 0.5, 100}, {40, -1, 20}),
                         to_float(shape(ShapeKind::cylinder, {0.7, 0.5, 0}, {0.1, -1, 0})),
                         to_float(shape(ShapeKind::plane, {}, {0, -0.5, 0}))};
  for (const View& floor : floors) {
    CAPTURE(kind_names[std::size_t(floor.kind)]);
    std::set<std::set<std::uint32_t>> seen;
    for (int i = 0; i < 1000; i++) {
      const Vec3 shift = random.ball(1e-5);
      const View a = to_float(shape(ShapeKind::cylinder, {0.4, 0.5, 0}, shift, axis_angle(random.direction(), 1e-5)));
      const Manifold<float> m = find(a, floor, 0.02f);
      REQUIRE(m.count == 4);
      double least = 1, most = -1;
      for (std::uint32_t k = 0; k < 4; k++) {
        CHECK(std::abs(m.points[k].separation) < 4e-5);
        CHECK(std::abs(std::hypot(m.points[k].p[0], m.points[k].p[2]) - 0.4) < 1e-4);
        least = std::min(least, double(m.points[k].p[0]));
        most = std::max(most, double(m.points[k].p[0]));
      }
      CHECK(most - least > 0.5);
      seen.insert(features(m));
    }
    CHECK(seen.size() == 1);
  }
}

TEST_CASE("narrow: boxes turned against each other touch in the corners of their octagon") {
  Pairs random(5);
  for (int i = 0; i < 2000; i++) {
    const View a = box(unit, {}, axis_angle({0, 1, 0}, random.between(0.05, 1.5)));
    const View b = box(unit, {random.between(-0.2, 0.2), -0.999, random.between(-0.2, 0.2)});
    const Manifold<float> m = find(a, b, 0.02f);
    REQUIRE(m.count == 4);
    double area = 0;
    for (std::uint32_t k = 0; k < 4; k++) {
      CHECK(std::abs(m.points[k].separation + 0.001) < 1e-6);
      const Vec3 p = point(m, k), q = point(m, (k + 1) % 4);
      area += 0.5 * (p.x * q.z - p.z * q.x);
    }
    CHECK(std::abs(area) > 0.4);  // the octagon's is at least 0.8
  }
}

TEST_CASE("narrow: a box settling on a box passes from corner to edge to face without a jump in depth") {
  double last = 0;
  for (int i = 0; i <= 1000; i++) {
    const double tilt = 0.2 * (1 - i / 1000.0);
    const View a = box(unit, {}, axis_angle({0.6, 0, 0.8}, tilt));
    const View b = box({2, 0.5, 2}, {0, -1.05, 0});
    const Manifold<float> m = find(a, b, 0.1f);
    REQUIRE(m.count >= 1);
    if (i > 0) CHECK(std::abs(deepest(m) - last) < 5e-4);
    last = deepest(m);
  }
}
