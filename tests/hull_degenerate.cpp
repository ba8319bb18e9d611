// Pins that make_hull either refuses points or makes a sound hull of them, however thin, small, far away or large they
// are, and that it decides alike of the same points turned.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "narrow_support.h"
#include "pcphys/constants.h"
#include "support_world.h"
#include "wild/dice.h"

using namespace worldtest;

namespace {

using Points = std::vector<Vec3>;

struct Dice : wild::Dice {
  explicit Dice(unsigned seed) : wild::Dice("hulls", seed) {}
};

/// Points of a body of the extents `size` about the origin: corners of its box, or points in it, on an ellipsoid, on
/// the two sides of a plate, or of a wedge that ends in an edge.
Points some_points(Dice& dice, Vec3 size) {
  const int kind = dice.one_of(5), count = 4 + dice.one_of(kind == 2 ? 40 : 60);
  Points points;
  if (kind == 0) points = narrow_test::box_corners(0.5 * size);
  for (int i = 0; kind != 0 && i < count; i++) {
    Vec3 p{dice.between(-0.5, 0.5), dice.between(-0.5, 0.5), dice.between(-0.5, 0.5)};
    if (kind == 2) p = 0.5 * dice.direction();
    if (kind == 3) p.z = i % 2 ? 0.5 : -0.5;
    if (kind == 4) p.z *= 0.5 - p.x;
    points.push_back({size.x * p.x, size.y * p.y, size.z * p.z});
  }
  for (int copies = dice.one_of(3) * dice.one_of(30); copies > 0; copies--) {
    const Vec3 copy = points[std::size_t(dice.one_of(int(points.size())))];
    points.push_back(copy);
  }
  for (std::size_t i = points.size() - 1; i > 0; i--)
    std::swap(points[i], points[std::size_t(dice.one_of(int(i + 1)))]);
  return points;
}

/// Plates, needles, slivers and lumps, the thin ones from a tenth of their length to nothing.
Vec3 some_extents(Dice& dice) {
  const double thin = dice.one_of(12) ? dice.by_ratio(1e-10, 0.1) : 0.0, wide = dice.by_ratio(0.1, 1);
  switch (dice.one_of(4)) {
    case 0: return {1, wide, thin};
    case 1: return {1, thin, thin};
    case 2: return {1, std::max(dice.by_ratio(1e-6, 1), thin), thin};
    default: return {1, wide, dice.between(0.1, 1)};
  }
}

Points moved(const Points& points, const Pose& pose) {
  Points at;
  for (const Vec3& p : points) at.push_back(transform(pose, p));
  return at;
}
Points scaled(Points points, double scale) {
  for (Vec3& p : points) p = scale * p;
  return points;
}
bool finite_extent(double x) { return std::isfinite(x) && x > 0; }

/// What is wrong with a hull, or null.
const char* fault_of(const Hull& hull) {
  const Vec3 i = hull.moments();
  const double slack = 1 + 1e-9;
  const Quat q = hull.frame().orientation;
  if (!finite_extent(hull.volume())) return "volume";
  if (!finite_extent(hull.inner_radius())) return "inner radius";
  if (!std::isfinite(hull.radius()) || hull.radius() < hull.inner_radius()) return "radius";
  if (!finite_extent(i.x) || !finite_extent(i.y) || !finite_extent(i.z)) return "moments";
  if (i.x > (i.y + i.z) * slack || i.y > (i.x + i.z) * slack || i.z > (i.x + i.y) * slack) return "moments of no body";
  if (!finite(hull.frame().position) || !(std::fabs(length(q) - 1) < 1e-12)) return "frame";
  if (hull.vertices().size() < 4 || hull.face_count() < 4) return "faces";
  for (std::size_t f = 0; f < hull.face_count(); f++) {
    const Vec3 n = hull.data()->normals[f], on = hull.vertices()[hull.face(f)[0]];
    if (!(std::fabs(length(n) - 1) < 1e-9)) return "normal";
    for (const Vec3& v : hull.vertices())
      if (!(dot(v - on, n) < 1e-4 * hull.radius())) return "not convex";
  }
  for (const float x : hull.data()->table.f32)
    if (!std::isfinite(x)) return "table";
  return nullptr;
}

/// How far points lie outside of it, as a share of its radius, beyond what rounding makes of how far away they are.
double sticks_out(const Hull& hull, const Points& points) {
  const Pose frame = hull.frame();
  double most = 0;
  for (const Vec3& p : points) {
    const Vec3 own = rotate(conjugate(frame.orientation), p - frame.position);
    for (std::size_t f = 0; f < hull.face_count(); f++)
      most = std::max(
          most, dot(own - hull.vertices()[hull.face(f)[0]], hull.data()->normals[f]) - 1e-14 * length(frame.position));
  }
  return most / hull.radius();
}

/// Whether a hull was made; it must be sound then, and the reason one of those that there are if not.
bool made_or_refused(const Points& points) {
  const auto hull = make_hull(points);
  if (!hull) {
    const ErrorCode code = hull.error().code;
    CHECK_MESSAGE(
        (code == ErrorCode::degenerate_shape || code == ErrorCode::buffer_full || code == ErrorCode::not_finite),
        hull.error().message);
    return false;
  }
  const char* const fault = fault_of(*hull);
  CHECK_MESSAGE(fault == nullptr, (fault ? fault : "") << " of a hull of " << points.size() << " points, volume "
                                                       << hull->volume() << ", inner radius " << hull->inner_radius());
  CHECK(sticks_out(*hull, points) < 10 * constants::hull_planarity);
  return true;
}

}  // namespace

TEST_CASE("hull: thin, small, large and distant points make a sound hull or none") {
  for (unsigned seed = 0; seed < 20000; seed++) {
    CAPTURE(seed);
    Dice dice(seed);
    const double scale = dice.one_of(2) ? 1 : dice.by_ratio(1e-4, 1e5);
    const double far = dice.one_of(2) ? 0 : dice.by_ratio(1e-3, 1e3);
    const Points points = scaled(some_points(dice, some_extents(dice)), scale);
    made_or_refused(moved(points, {far * dice.direction(), dice.orientation()}));
  }
}

TEST_CASE("hull: points that each lie near what is left of the others are not cut off one after the other") {
  CHECK(made_or_refused({{0, 0, 0},
                         {1000, 0, 0},
                         {0, 1000, 0},
                         {0, 0, 2},
                         {1000, 0, 3},
                         {0, -256, -1},
                         {-1, -1, -1},
                         {-1, 1, 0},
                         {-1, 0, 0},
                         {0, 0, -6143},
                         {2560, 3, 0}}));
}

TEST_CASE("hull: points in a plane, on a line or in one place make none, however they are turned") {
  for (unsigned seed = 0; seed < 2000; seed++) {
    CAPTURE(seed);
    Dice dice(seed);
    const double scale = dice.by_ratio(1e-4, 1e5), thin = dice.by_ratio(1e-12, 2e-5);
    const Vec3 extents = seed % 3 == 0   ? Vec3{1, 1, thin}
                         : seed % 3 == 1 ? Vec3{1, thin, thin}
                                         : Vec3{1, dice.by_ratio(1e-3, 1), 0};
    const Points points = scaled(some_points(dice, extents), scale);
    CHECK_FALSE(made_or_refused(moved(points, {scale * dice.between(0, 100) * dice.direction(), dice.orientation()})));
  }
}

TEST_CASE("hull: whether there is one does not depend on how the points are turned") {
  int made = 0, refused = 0, split = 0;
  for (unsigned seed = 0; seed < 3000; seed++) {
    CAPTURE(seed);
    Dice dice(seed);
    const Points points = some_points(dice, some_extents(dice));
    std::array<int, 2> answers{};
    std::optional<double> thickness;
    for (int i = 0; i < 4; i++) {
      const auto hull = make_hull(i == 0 ? points : moved(points, {{}, dice.orientation()}));
      answers[bool(hull)]++;
      if (hull) thickness = hull->inner_radius() / hull->radius();
    }
    made += answers[1] == 4;
    refused += answers[0] == 4;
    if (answers[0] == 0 || answers[1] == 0) continue;
    split++;
    CHECK_MESSAGE(*thickness < 2e-4, "inner radius " << *thickness << " of the radius");
  }
  CHECK(made > 500);
  CHECK(refused > 500);
  CHECK(split < 30);
  MESSAGE(made << " made, " << refused << " refused, " << split << " neither");
}

TEST_CASE("hull: a box makes one from the thickness on that is named, at any size and place and however it is turned") {
  for (unsigned seed = 0; seed < 4000; seed++) {
    CAPTURE(seed);
    Dice dice(seed);
    const double wide = dice.one_of(2) ? dice.by_ratio(0.01, 1) : 0, thin = dice.by_ratio(3e-5, 3e-4),
                 scale = dice.by_ratio(0.5, 1e5);
    const Vec3 extents{1, std::max(wide, thin), thin};
    const double share = thin / length(extents) / constants::hull_flatness;
    if (std::fabs(share - 1) < 0.02) continue;
    const Points box = narrow_test::box_corners(0.5 * scale * extents);
    CAPTURE(share);
    const Pose pose{dice.between(0, 10) * scale * dice.direction(), dice.orientation()};
    CHECK(made_or_refused(moved(box, pose)) == (share > 1));
  }
}

TEST_CASE("hull: the corners of a box are found among points that lie in its faces and edges but for rounding") {
  for (unsigned seed = 0; seed < 1000; seed++) {
    CAPTURE(seed);
    Dice dice(seed);
    Points points = narrow_test::box_corners({0.5, 0.5, 0.5});
    for (int i = dice.one_of(200); i > 0; i--) {
      const double x = dice.one_of(7) / 6.0, y = dice.one_of(7) / 6.0;
      points.push_back({x - 0.5, y - 0.5, dice.one_of(2) - 0.5});
    }
    const double noise = dice.by_ratio(1e-16, 1e-8);
    for (Vec3& p : points) p = p + noise * dice.direction();
    const auto hull = make_hull(moved(points, {{}, seed % 2 ? dice.orientation() : Quat{}}));
    REQUIRE_MESSAGE(hull, hull.error().message);
    CHECK(hull->vertices().size() == 8);
  }
}

TEST_CASE("hull: numbers that none can be made of are refused") {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const double odd[] = {0,   -0.0, 5e-324, -1e-310, 1e-300, 1e-30,  1e-5, 1,    -1,
                        1e5, 1e15, -1e15,  1e30,    1e300,  -1e308, inf,  -inf, nan};
  for (unsigned seed = 0; seed < 5000; seed++) {
    CAPTURE(seed);
    Dice dice(seed);
    const int count = dice.one_of(30), all = seed % 2 ? 11 : int(std::size(odd));
    Points points;
    const auto number = [&] { return odd[dice.one_of(all)] * (dice.one_of(3) ? 1 : dice.between(0.5, 1)); };
    for (int i = 0; i < count; i++) points.push_back({number(), number(), number()});
    made_or_refused(points);
  }
}
