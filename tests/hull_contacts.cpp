// Pins how hulls touch and rest: the hull of a box's corners has the box's manifolds and falls, tumbles and stacks as
// the box does; prisms and cylinders of many corners stay where they were stacked; a pile of random hulls comes to rest
// with nothing lost. Caught so far: stacks that walked since rocking chose other corners in every step.
#include <cmath>
#include <vector>

#include "narrow_support.h"
#include "scenes/hull_overlap.h"
#include "scenes/metrics.h"
#include "support_world.h"

using namespace worldtest;
using narrow_test::box_corners;
using narrow_test::hull_shape;
using narrow_test::Shape;

namespace {

/// Every point of m has one of n at the same place with the same separation.
bool same_points(const Manifold<double>& m, const Manifold<double>& n, double tolerance) {
  bool same = m.count == n.count && length(narrow_test::normal(m) - narrow_test::normal(n)) < tolerance;
  for (std::uint32_t i = 0; i < m.count; i++) {
    bool found = false;
    for (std::uint32_t k = 0; k < n.count; k++)
      found = found || (length(narrow_test::point(m, i) - narrow_test::point(n, k)) < tolerance &&
                        std::fabs(m.points[i].separation - n.points[k].separation) < tolerance);
    same = same && found;
  }
  return same;
}

std::vector<Vec3> prism(int sides) {
  std::vector<Vec3> points;
  for (int i = 0; i < 2 * sides; i++) {
    const double t = 6.283185307179586 * (i / 2) / sides;
    points.push_back({0.5 * std::cos(t), i % 2 ? 0.5 : -0.5, 0.5 * std::sin(t)});
  }
  return points;
}

BodyId add(World& world, const ShapeDef& shape, Vec3 position, BodyKind kind = BodyKind::dynamic) {
  BodyDef def;
  def.kind = kind;
  def.pose.position = position;
  def.shapes = {shape};
  def.material = {0.6, 0.6, 0};
  return must(world.create_body(def));
}

struct Rest {
  double sideways = 0, down = 0, speed = 0;  // largest
};
/// Ten of a shape of 1 m on one another, slightly off centre, after 15 s.
Rest stacked(const ShapeDef& shape, const ShapeDef& floor, Precision precision) {
  World world({precision});
  add(world, floor, {0, floor.kind == ShapeKind::plane ? 0.0 : -0.5, 0}, BodyKind::fixed);
  std::vector<BodyId> ids;
  std::vector<Vec3> starts;
  for (int i = 0; i < 10; i++) {
    starts.push_back({0.005 * std::sin(7.0 * i), i + 0.5, 0.005 * std::cos(5.0 * i)});
    ids.push_back(add(world, shape, starts.back()));
  }
  Stepper stepper;
  run(world, stepper, 900);
  Rest rest;
  for (std::size_t i = 0; i < ids.size(); i++) {
    const Vec3 p = must(world.pose(ids[i])).position, from = starts[i];
    rest.sideways = std::max(rest.sideways, std::hypot(p.x - from.x, p.z - from.z));
    rest.down = std::max(rest.down, from.y - p.y);
    rest.speed = std::max(rest.speed, length(must(world.velocity(ids[i]))));
  }
  return rest;
}

}  // namespace

TEST_CASE("hull: the manifolds of a box's corners are the box's") {
  narrow_test::Pairs random(11);
  int pairs = 0, differ = 0;
  for (int i = 0; i < 400; i++) {
    const Vec3 size{random.between(0.2, 0.5), random.between(0.2, 0.5), random.between(0.2, 0.5)};
    // flat on something, turned about the vertical, tilted a little, deep by up to 1 cm
    const double tilt = i % 2 ? 1e-4 : 0.003;
    const Quat q = axis_angle({0, 1, 0}, random.between(0, 6)) * axis_angle(random.direction(), tilt);
    const Vec3 p{random.between(-0.1, 0.1), size.y - random.between(0, 0.01), random.between(-0.1, 0.1)};
    const Shape box = narrow_test::shape(ShapeKind::box, size, p, q), hull = hull_shape(box_corners(size), p, q);
    const Shape others[] = {narrow_test::shape(ShapeKind::plane, {}),
                            narrow_test::shape(ShapeKind::box, {5, 0.5, 5}, {0, -0.5, 0}),
                            hull_shape(box_corners({5, 0.5, 5}), {0, -0.5, 0})};
    const Shape* of_box[] = {&others[0], &others[1], &others[1]};
    for (int k = 0; k < 3; k++) {
      const auto m = narrow_test::find(hull, others[k], 0.02), n = narrow_test::find(box, *of_box[k], 0.02);
      CHECK(m.count == 4);
      pairs++;
      differ += !same_points(m, n, 1e-4);
      for (const double factor : {1.0, 0.5}) {  // the speculative part, and swapped
        const auto swapped = narrow_test::find(others[k], hull, 0.02 * factor);
        CHECK(length(narrow_test::normal(swapped) + narrow_test::normal(m)) < 1e-3);
      }
    }
  }
  CHECK(pairs == 1200);
  CHECK(differ == 0);
}

TEST_CASE("hull: as deep as the axis of least overlap, of all faces and pairs of edges") {
  const Hull box = must(make_hull(box_corners({0.5, 0.5, 0.5})));
  CHECK(scenes::overlap(box, {}, box, {{0.9, 0.2, 0}, {}}) == doctest::Approx(0.1));
  CHECK(scenes::overlap(box, {}, box, {{0.9, 1.2, 0}, {}}) == 0);
  narrow_test::Pairs random(21);
  double worst = 0, worst_float = 0;
  int overlapping = 0;
  for (int i = 0; i < 600; i++) {
    Hull hulls[2];
    Shape shapes[2];
    for (int k = 0; k < 2; k++) {
      do {
        const auto made = make_hull(random.points());
        if (made) hulls[k] = *made;
      } while (!hulls[k] || hulls[k].inner_radius() < 0.02);
      shapes[k] =
          narrow_test::shape(ShapeKind::hull, {hulls[k].radius(), hulls[k].inner_radius(), 0}, {}, random.rotation());
      shapes[k].hull = hulls[k].data();
    }
    const Vec3 d = random.direction();
    narrow_test::place(
        shapes[1], random.between(0, 1) * (narrow_test::reach(shapes[0], d) + narrow_test::reach(shapes[1], -d)) * d);
    const double depth = scenes::overlap(hulls[0], {{}, narrow_test::turn(shapes[0])}, hulls[1],
                                         {narrow_test::centre(shapes[1]), narrow_test::turn(shapes[1])});
    if (!(depth > 1e-3)) continue;
    overlapping++;
    const double size = narrow_test::scale(shapes[0], shapes[1]);
    const auto m = narrow_test::find(shapes[0], shapes[1], 0.02);
    const auto f = narrow_test::find(narrow_test::to_float(shapes[0]), narrow_test::to_float(shapes[1]), 0.02f);
    worst = std::max(worst, std::fabs(narrow_test::deepest(m) + depth) / size);
    worst_float = std::max(worst_float, std::fabs(narrow_test::deepest(f) + depth) / size);
  }
  MESSAGE(overlapping, " overlapping pairs, depth off by at most ", worst, " of the size, in float ", worst_float);
  CHECK(overlapping > 300);
  CHECK(worst < 2e-3);  // PC_FLAT_SLOP
  CHECK(worst_float < 2e-3);
}

TEST_CASE("hull: the features of four corners on a floor stay") {
  narrow_test::Pairs random(12);
  for (const auto& points : {box_corners({0.5, 0.5, 0.5}), prism(3), prism(12), prism(30)}) {
    const Shape floors[] = {narrow_test::shape(ShapeKind::plane, {}),
                            narrow_test::shape(ShapeKind::box, {5, 0.5, 5}, {0, -0.5, 0}),
                            hull_shape(box_corners({5, 0.5, 5}), {0, -0.5, 0})};
    for (const Shape& floor : floors) {
      const Shape base = hull_shape(points);
      const auto first = narrow_test::find(narrow_test::posed(base, {0, 0.499, 0}), floor, 0.02);
      CHECK(first.count == (points.size() == 6 ? 3 : 4));
      for (int i = 0; i < 50; i++) {
        const Quat q = axis_angle(random.direction(), 1e-4);
        const auto m =
            narrow_test::find(narrow_test::posed(base, Vec3{0, 0.499, 0} + random.ball(1e-4), q), floor, 0.02);
        CHECK(narrow_test::features(m) == narrow_test::features(first));
        for (std::uint32_t k = 0; k < m.count; k++) CHECK(std::fabs(m.points[k].separation + 0.001) < 3e-4);
      }
    }
  }
}

TEST_CASE("hull: a box's corners fly, tumble and land as the box") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    World world({precision}), other({precision});
    const Vec3 size{0.5, 0.3, 0.2};
    const Hull hull = must(make_hull(box_corners(size)));
    BodyId ids[2];
    for (int k = 0; k < 2; k++) {
      World& w = k ? other : world;
      add(w, ShapeDef::plane(), {}, BodyKind::fixed);
      ids[k] = add(w, k ? ShapeDef::hull(hull) : ShapeDef::box(size), {0, 3, 0});
      must(w.set_velocity(ids[k], {1, 0, 0}));
      must(w.set_angular_velocity(ids[k], {3, 1, 2}));
    }
    CHECK(std::fabs(must(world.mass_properties(ids[0])).mass / must(other.mass_properties(ids[1])).mass - 1) < 1e-6);
    Stepper a, b;
    run(world, a, 30);
    run(other, b, 30);
    const double tolerance = precision == Precision::f32 ? 1e-5 : 1e-12;
    CHECK(length(must(world.pose(ids[0])).position - must(other.pose(ids[1])).position) < tolerance);
    CHECK(length(must(world.angular_velocity(ids[0])) - must(other.angular_velocity(ids[1]))) < 10 * tolerance);
    run(world, a, 600);
    run(other, b, 600);
    for (int k = 0; k < 2; k++) {
      World& w = k ? other : world;
      CHECK(length(must(w.velocity(ids[k]))) < 1e-4);
      const double y = must(w.pose(ids[k])).position.y;
      CHECK(std::min({std::fabs(y - 0.5), std::fabs(y - 0.3), std::fabs(y - 0.2)}) < 1e-3);
    }
  }
}

TEST_CASE("hull: stacks of ten stay where they are, of many corners too") {
  const Hull box = must(make_hull(box_corners({0.5, 0.5, 0.5})));
  const ShapeDef floor = ShapeDef::box({100, 0.5, 100}), plane = ShapeDef::plane();
  const Rest boxes = stacked(ShapeDef::box({0.5, 0.5, 0.5}), floor, Precision::f32);
  struct Case {
    const char* name;
    ShapeDef shape, floor;
    Precision precision;
  };
  const Case cases[] = {{"box on box", ShapeDef::hull(box), floor, Precision::f32},
                        {"box on plane", ShapeDef::hull(box), plane, Precision::f64},
                        {"prism of 3", ShapeDef::hull(must(make_hull(prism(3)))), floor, Precision::f32},
                        {"prism of 6", ShapeDef::hull(must(make_hull(prism(6)))), floor, Precision::f32},
                        {"prism of 12", ShapeDef::hull(must(make_hull(prism(12)))), plane, Precision::f32},
                        {"prism of 30", ShapeDef::hull(must(make_hull(prism(30)))), floor, Precision::f64},
                        {"cylinder", ShapeDef::cylinder(0.5, 0.5), floor, Precision::f32}};
  for (const Case& c : cases) {
    const std::string name = c.name;
    CAPTURE(name);
    const Rest rest = stacked(c.shape, c.floor, c.precision);
    MESSAGE(name, ": sideways ", 1000 * rest.sideways, " mm (boxes ", 1000 * boxes.sideways, "), down ",
            1000 * rest.down, " mm (", 1000 * boxes.down, "), ", rest.speed, " m/s");
    CHECK(rest.sideways < 0.008);
    CHECK(rest.down < 0.02);
    CHECK(rest.speed < 2e-3);
  }
}

TEST_CASE("hull: parts of a compound touch where they stand") {
  World world;
  add(world, ShapeDef::plane(), {}, BodyKind::fixed);
  BodyDef table;  // a top and two feet, of hulls that were given where they are
  for (const auto& [size, at] : {std::pair<Vec3, Vec3>{{1, 0.1, 0.5}, {0, 0.9, 0}},
                                 {{0.1, 0.4, 0.5}, {-0.8, 0.4, 0}},
                                 {{0.1, 0.4, 0.5}, {0.8, 0.4, 0}}}) {
    std::vector<Vec3> points = box_corners(size);
    for (Vec3& p : points) p = p + at;
    table.shapes.push_back(ShapeDef::hull(must(make_hull(points))));
    table.shapes.back().local = table.shapes.back().convex.frame();
  }
  table.pose.position = {0, 0.05, 0};
  must(make_compound(table));
  const BodyId id = must(world.create_body(table));
  const BodyId load = add(world, ShapeDef::sphere(0.2), {0.3, 1.5, 0});
  Stepper stepper;
  run(world, stepper, 300);
  CHECK(length(must(world.velocity(id))) < 1e-3);
  CHECK(std::fabs(must(world.pose(load)).position.y - 1.2) < 2e-3);
  const Pose pose = must(world.pose(id));
  double lowest = 1e9;
  for (const ShapeDef& shape : must(world.shapes(id)))
    for (const Vec3& v : shape.convex.vertices())
      lowest = std::min(lowest, transform(pose, transform(shape.local, v)).y);
  CHECK(std::fabs(lowest) < 2e-3);
}

TEST_CASE("hull: a pile comes to rest, nothing escapes, run to run the same") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    std::uint64_t hashes[2];
    for (std::uint64_t& hash : hashes) {
      SceneWorld s = scene_world("hulls", 40, precision);
      Stepper stepper;
      scenes::RimWatch rim;
      for (int i = 0; i < 900; i++) {
        run(s.world, stepper, 1);
        rim.look(s.scene, scenes::poses(s.scene, s.world));
      }
      const scenes::Metrics m = scenes::measure(s.scene, s.world, rim);
      CHECK(m.escapes.through == 0);
      CHECK(m.nonfinite == 0);
      CHECK(m.penetration.max < 0.02);
      CHECK(m.kinetic < 0.05);
      hash = s.world.hash();
    }
    CHECK(hashes[0] == hashes[1]);
  }
}
