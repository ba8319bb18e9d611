// Pins convex hulls as shapes: what make_hull makes of points and refuses, mass and frame, merged faces, sharing, and
// that the hull of a box's corners moves as the box does.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "collision/view.h"
#include "narrow_support.h"
#include "support_world.h"

using namespace worldtest;
using narrow_test::box_corners;

namespace {

Error refused(const std::vector<Vec3>& points) {
  const auto hull = make_hull(points);
  REQUIRE_FALSE(hull);
  CHECK(hull.error().message.back() == '.');
  return hull.error();
}
Hull of(const std::vector<Vec3>& points) { return must(make_hull(points)); }

std::vector<Vec3> on_ellipsoid(int count, unsigned seed, Vec3 size = {1, 0.7, 0.4}) {
  narrow_test::Pairs random(seed);
  std::vector<Vec3> points;
  for (int i = 0; i < count; i++) {
    const Vec3 d = random.direction();
    points.push_back({size.x * d.x, size.y * d.y, size.z * d.z});
  }
  return points;
}
/// Every side belongs to two faces, and V - E + F = 2.
void check_closed(const Hull& hull) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (std::size_t f = 0; f < hull.face_count(); f++) {
    const auto face = hull.face(f);
    REQUIRE(face.size() >= 3);
    for (std::size_t k = 0; k < face.size(); k++) sides[{face[k], face[(k + 1) % face.size()]}]++;
  }
  for (const auto& [side, count] : sides) {
    CHECK(count == 1);
    CHECK(sides.contains({side.second, side.first}));
  }
  CHECK(hull.vertices().size() + hull.face_count() == sides.size() / 2 + 2);
}

}  // namespace

TEST_CASE("hull: points that make none are refused with a reason") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  CHECK(refused({}).code == ErrorCode::degenerate_shape);
  CHECK(refused({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).message.find("3 points") != std::string::npos);
  CHECK(refused({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {nan, 0, 1}}).code == ErrorCode::not_finite);
  CHECK(refused({{0, 0, 0}, {1, 0, 0}, {0, inf, 0}, {0, 0, 1}}).code == ErrorCode::not_finite);
  CHECK(refused({{0, 0, 0}, {1, 0, 0}, {0, 1e16, 0}, {0, 0, 1}}).code == ErrorCode::not_finite);
  CHECK(refused({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}}).message.find("one place") !=
        std::string::npos);
  CHECK(refused({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}}).message.find("one line") != std::string::npos);
  CHECK(refused({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {3, 1, 0}}).message.find("one plane") !=
        std::string::npos);
  CHECK(refused({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}}).code == ErrorCode::degenerate_shape);  // twice the same
  CHECK(refused(box_corners({1, 1, 1e-6})).message.find("one plane") != std::string::npos);
  CHECK(refused(box_corners({1e-6, 1e-6, 1e-6})).code == ErrorCode::degenerate_shape);
  CHECK(refused(box_corners({1, 1, 2e6})).code == ErrorCode::degenerate_shape);
  const Error many = refused(on_ellipsoid(1000, 1));
  CHECK(many.code == ErrorCode::buffer_full);
  CHECK(many.message.find("room for 64") != std::string::npos);

  World world;
  BodyDef def;
  def.shapes = {ShapeDef::hull({})};
  const std::uint64_t before = world.hash();
  const auto body = world.create_body(def);
  REQUIRE_FALSE(body);
  CHECK(body.error().code == ErrorCode::degenerate_shape);
  CHECK(world.hash() == before);
  CHECK_FALSE(mass_properties(ShapeDef::hull({}), 1000));
}

TEST_CASE("hull: the smallest and the largest, near and far from the origin") {
  for (const double size : {2e-5, 1e-3, 1.0, 1e3, 4e5})
    for (const Vec3 at : {Vec3{}, Vec3{1e3, -1e4, 1e2}}) {
      if (length(at) > 1e8 * size) continue;
      std::vector<Vec3> points = box_corners({size, 2 * size, 0.5 * size});
      for (Vec3& p : points) p = p + at;
      const Hull hull = of(points);
      CHECK(hull.vertices().size() == 8);
      CHECK(hull.face_count() == 6);
      CHECK(std::fabs(hull.volume() / (8 * size * size * size) - 1) < 1e-9 + 1e-14 * length(at) / size);
      CHECK(length(hull.frame().position - at) < 1e-12 * size + 1e-14 * length(at));
    }
}

TEST_CASE("hull: a box's corners are the box, whatever lies within and in its faces") {
  std::vector<Vec3> points = box_corners({0.5, 0.3, 0.2});
  narrow_test::Pairs random(3);
  for (int i = 0; i < 200; i++)
    points.push_back({random.between(-0.5, 0.5), random.between(-0.3, 0.3), random.between(-0.2, 0.2)});
  for (int i = 0; i < 200; i++) points.push_back({random.between(-0.5, 0.5), 0.3, random.between(-0.2, 0.2)});
  for (int i = 0; i < 20; i++) points.push_back({random.between(-0.5, 0.5), 0.3, 0.2});
  points.insert(points.end(), points.begin(), points.begin() + 100);
  for (const double noise : {0.0, 1e-8, 1e-7}) {
    std::vector<Vec3> noisy = points;
    for (Vec3& p : noisy) p = p + random.ball(noise);
    const Hull hull = of(noisy);
    CAPTURE(noise);
    CHECK(hull.vertices().size() == 8);
    CHECK(hull.face_count() == 6);
    check_closed(hull);
    const MassProperties m = must(mass_properties(ShapeDef::hull(hull), 1000)),
                         box = must(mass_properties(ShapeDef::box({0.5, 0.3, 0.2}), 1000));
    const double slack = 1e-12 + 20 * noise;
    CHECK(std::fabs(m.mass / box.mass - 1) < slack);
    CHECK(length(m.moments - box.moments) < slack * length(box.moments));
    CHECK(length(hull.frame().position) < slack);
    CHECK(std::fabs(hull.inner_radius() - 0.2) < slack);
    CHECK(std::fabs(hull.radius() - length(Vec3{0.5, 0.3, 0.2})) < slack);
  }
}

TEST_CASE("hull: frame, vertices and moments do not depend on how the points stand") {
  narrow_test::Pairs random(5);
  for (unsigned i = 0; i < 40; i++) {
    const std::vector<Vec3> points = on_ellipsoid(12, i);
    const Pose pose{random.ball(10), random.rotation()};
    std::vector<Vec3> moved;
    for (const Vec3& p : points) moved.push_back(transform(pose, p));
    const Hull a = of(points), b = of(moved);
    REQUIRE(a.vertices().size() == b.vertices().size());
    const auto sorted = [](Vec3 m) {
      double v[3] = {m.x, m.y, m.z};
      std::sort(v, v + 3);
      return Vec3{v[0], v[1], v[2]};
    };
    CHECK(length(sorted(a.moments()) - sorted(b.moments())) < 1e-12 * length(a.moments()));
    CHECK(std::fabs(a.volume() / b.volume() - 1) < 1e-12);
    // the frame leads every vertex back to one of the points
    for (const Hull& hull : {a, b})
      for (const Vec3& v : hull.vertices()) {
        const Vec3 p = transform(hull.frame(), v);
        double best = 1e30;
        for (const Vec3& given : &hull.vertices()[0] == &a.vertices()[0] ? points : moved)
          best = std::min(best, length(given - p));
        CHECK(best < 1e-12);
      }
  }
}

TEST_CASE("hull: volume, centre and moments agree with a sum over random points") {
  const Hull hull = of(on_ellipsoid(20, 9));
  narrow_test::Pairs random(1);
  const int count = 400000;
  double in = 0;
  Vec3 first, second, mixed;
  for (int i = 0; i < count; i++) {
    const Vec3 p{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    bool inside = true;
    for (std::size_t f = 0; inside && f < hull.face_count(); f++)
      inside = dot(p - hull.data()->vertices[hull.face(f)[0]], hull.data()->normals[f]) <= 0;
    if (!inside) continue;
    in++;
    first = first + p;
    second = second + Vec3{p.y * p.y + p.z * p.z, p.x * p.x + p.z * p.z, p.x * p.x + p.y * p.y};
    mixed = mixed + Vec3{p.y * p.z, p.x * p.z, p.x * p.y};
  }
  const double cell = 8.0 / count;
  CHECK(std::fabs(in * cell / hull.volume() - 1) < 0.01);
  CHECK(length(1 / in * first) < 0.003);
  CHECK(length(cell * second - hull.moments()) < 0.01 * length(hull.moments()));
  CHECK(length(cell * mixed) < 0.003 * length(hull.moments()));
}

TEST_CASE("hull: random points give closed polyhedra that hold all of them") {
  for (unsigned i = 0; i < 300; i++) {
    narrow_test::Pairs random(i);
    std::vector<Vec3> points = random.points();
    if (i % 3 == 0)
      for (Vec3& p : points) p = {double(float(p.x)), double(float(p.y)), double(float(p.z))};
    const auto made = make_hull(points);
    if (!made) {
      CHECK(made.error().code == ErrorCode::degenerate_shape);
      continue;
    }
    check_closed(*made);
    const Hull& hull = *made;
    for (const Vec3& p : points) {
      const Vec3 l = rotate(conjugate(hull.frame().orientation), p - hull.frame().position);
      for (std::size_t f = 0; f < hull.face_count(); f++)
        CHECK(dot(l - hull.vertices()[hull.face(f)[0]], hull.data()->normals[f]) < 4e-5 * hull.radius());
    }
  }
}

TEST_CASE("hull: given points stand where they were given, through make_compound or through the frame") {
  std::vector<Vec3> points = on_ellipsoid(10, 4);
  for (Vec3& p : points) p = p + Vec3{3, 0, -2};
  const Hull hull = of(points);
  const Pose at{{1, 2, 3}, axis_angle({0, 0, 1}, 0.4)};
  BodyDef compound;
  compound.pose = at;
  compound.shapes = {ShapeDef::hull(hull)};
  compound.shapes[0].local = hull.frame();
  must(make_compound(compound));
  World world({Precision::f64});
  const BodyId a = must(world.create_body(compound));
  BodyDef alone;
  alone.pose = {transform(at, hull.frame().position), at.orientation * hull.frame().orientation};
  alone.shapes = {ShapeDef::hull(hull)};
  const BodyId b = must(world.create_body(alone));
  CHECK(length(must(world.pose(a)).position - must(world.pose(b)).position) < 1e-12);
  CHECK(std::fabs(must(world.mass_properties(a)).mass / must(world.mass_properties(b)).mass - 1) < 1e-12);
  const ShapeDef shape = must(world.shapes(a))[0];
  for (const Vec3& v : hull.vertices()) {
    const Vec3 p = transform(must(world.pose(a)), transform(shape.local, v)), q = transform(must(world.pose(b)), v);
    CHECK(length(p - q) < 1e-12);
  }
}

TEST_CASE("hull: shared by bodies and worlds, freed with the last of them, no part of snapshots") {
  Hull hull = of(box_corners({0.5, 0.5, 0.5}));
  World world, other({Precision::f64});
  BodyDef def;
  def.shapes = {ShapeDef::hull(hull)};
  const BodyId a = must(world.create_body(def)), b = must(world.create_body(def)), c = must(other.create_body(def));
  CHECK(must(world.shapes(a))[0].convex == must(other.shapes(c))[0].convex);
  const auto snapshot = world.snapshot();
  hull = {};
  def.shapes.clear();
  must(world.destroy(a));
  CHECK(must(world.shapes(b))[0].convex.vertices().size() == 8);
  Stepper stepper;
  run(world, stepper, 10);
  must(world.destroy(b));
  run(world, stepper, 1);
  CHECK(must(other.shapes(c))[0].convex.vertices().size() == 8);
  def.shapes = {ShapeDef::hull(of(box_corners({0.5, 0.5, 0.5})))};
  (void)must(world.create_body(def));
  (void)must(world.create_body(def));
  CHECK_FALSE(world.restore(snapshot));  // other generations
}

TEST_CASE("hull: the broad phase's box holds every vertex and is tight") {
  narrow_test::Pairs random(8);
  for (int i = 0; i < 200; i++) {
    const narrow_test::Shape view = random.random_hull();
    const Vec3 centre = random.ball(100);
    const float more = 0.01f;
    for (const Aabb& box : {box_of_hull(view, centre, more), box_of_hull(narrow_test::to_float(view), centre, more)}) {
      double low[3] = {1e30, 1e30, 1e30}, high[3] = {-1e30, -1e30, -1e30};
      for (const Vec3& v : view.hull->vertices) {
        const Vec3 p = centre + rotate(narrow_test::turn(view), v);
        const double at[3] = {p.x, p.y, p.z};
        for (int k = 0; k < 3; k++) {
          low[k] = std::min(low[k], at[k] - double(more));
          high[k] = std::max(high[k], at[k] + double(more));
        }
      }
      for (int k = 0; k < 3; k++) {
        CHECK(double(box.min[k]) <= low[k]);
        CHECK(double(box.max[k]) >= high[k]);
        CHECK(high[k] - low[k] > double(box.max[k] - box.min[k]) - 1e-4);
      }
    }
  }
}
