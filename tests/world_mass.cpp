// Pins: mass and moments of every shape by their closed forms, checked a second time against sums over small
// pieces; several shapes as one body: two half boxes are the whole box, the inertia about world axes and the
// places of the shapes do not change; Eigen's types pass to and from the border without a word.
#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "support_world.h"

using namespace worldtest;
using std::numbers::pi;

namespace {

bool inside(const ShapeDef& s, Vec3 p) {
  const double across = std::hypot(p.x, p.z);
  switch (s.kind) {
    case ShapeKind::sphere: return length(p) <= s.size.x;
    case ShapeKind::box: return std::fabs(p.x) <= s.size.x && std::fabs(p.y) <= s.size.y && std::fabs(p.z) <= s.size.z;
    case ShapeKind::cylinder: return across <= s.size.x && std::fabs(p.y) <= s.size.y;
    case ShapeKind::capsule: return std::hypot(across, std::max(std::fabs(p.y) - s.size.y, 0.0)) <= s.size.x;
    case ShapeKind::hull:
    case ShapeKind::plane: break;
  }
  return false;
}

/// By summing over a grid of small cubes.
MassProperties summed(const ShapeDef& shape, double density, Vec3 half) {
  constexpr int n = 100;
  MassProperties m;
  const double piece = density * 8 * half.x * half.y * half.z / (double(n) * n * n);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++)
      for (int k = 0; k < n; k++) {
        const Vec3 p{half.x * ((2 * i + 1.0) / n - 1), half.y * ((2 * j + 1.0) / n - 1),
                     half.z * ((2 * k + 1.0) / n - 1)};
        if (!inside(shape, p)) continue;
        m.mass += piece;
        m.moments = m.moments + piece * Vec3{p.y * p.y + p.z * p.z, p.x * p.x + p.z * p.z, p.x * p.x + p.y * p.y};
      }
  return m;
}

void check_near(const MassProperties& a, const MassProperties& b, double tolerance) {
  CHECK(a.mass == doctest::Approx(b.mass).epsilon(tolerance));
  CHECK(a.moments.x == doctest::Approx(b.moments.x).epsilon(tolerance));
  CHECK(a.moments.y == doctest::Approx(b.moments.y).epsilon(tolerance));
  CHECK(a.moments.z == doctest::Approx(b.moments.z).epsilon(tolerance));
}

Eigen::Matrix3d world_inertia(const BodyDef& def) {
  const Eigen::Quaterniond q = def.pose.orientation;
  const Eigen::Vector3d moments = *def.moments;
  return q.toRotationMatrix() * moments.asDiagonal() * q.toRotationMatrix().transpose();
}

}  // namespace

TEST_CASE("mass properties: closed forms") {
  const double rho = 800;
  check_near(must(mass_properties(ShapeDef::sphere(0.3), rho)),
             {rho * 4 / 3 * pi * 0.027,
              {0.4 * 0.09 * rho * 4 / 3 * pi * 0.027, 0.4 * 0.09 * rho * 4 / 3 * pi * 0.027,
               0.4 * 0.09 * rho * 4 / 3 * pi * 0.027}},
             1e-14);
  const double box = rho * 0.2 * 0.4 * 0.6;
  check_near(must(mass_properties(ShapeDef::box({0.1, 0.2, 0.3}), rho)),
             {box, {box / 12 * (0.16 + 0.36), box / 12 * (0.04 + 0.36), box / 12 * (0.04 + 0.16)}}, 1e-14);
  const double cylinder = rho * pi * 0.04 * 1.0, across = cylinder / 12 * (3 * 0.04 + 1.0);
  check_near(must(mass_properties(ShapeDef::cylinder(0.2, 0.5), rho)), {cylinder, {across, cylinder * 0.02, across}},
             1e-14);
  // a capsule: the cylinder, and each half ball m by its own m r^2 (2/5 - 9/64) about its centre of mass 3r/8 beyond
  // the end
  const double half_ball = rho * 2 / 3 * pi * 0.008, r = 0.2, reach = 0.5 + 0.375 * r;
  const double capsule_across = across + 2 * half_ball * (r * r * (0.4 - 9.0 / 64) + reach * reach);
  check_near(
      must(mass_properties(ShapeDef::capsule(r, 0.5), rho)),
      {cylinder + 2 * half_ball, {capsule_across, cylinder * 0.02 + 2 * half_ball * 0.4 * r * r, capsule_across}},
      1e-14);
}

TEST_CASE("mass properties: sums over small cubes") {
  check_near(must(mass_properties(ShapeDef::sphere(0.3), 1000)), summed(ShapeDef::sphere(0.3), 1000, {0.3, 0.3, 0.3}),
             2e-3);
  check_near(must(mass_properties(ShapeDef::box({0.1, 0.2, 0.3}), 1000)),
             summed(ShapeDef::box({0.1, 0.2, 0.3}), 1000, {0.1, 0.2, 0.3}), 2e-3);
  check_near(must(mass_properties(ShapeDef::cylinder(0.2, 0.5), 1000)),
             summed(ShapeDef::cylinder(0.2, 0.5), 1000, {0.2, 0.5, 0.2}), 2e-3);
  check_near(must(mass_properties(ShapeDef::capsule(0.2, 0.5), 1000)),
             summed(ShapeDef::capsule(0.2, 0.5), 1000, {0.2, 0.7, 0.2}), 2e-3);
}

TEST_CASE("mass properties of a body: from density, from mass, as given, none") {
  World world(WorldDef{Precision::f64, {}});
  BodyDef def;
  def.shapes = {ShapeDef::box({0.1, 0.2, 0.3})};
  def.density = 500;
  const MassProperties own = must(mass_properties(def.shapes[0], 500));
  check_near(must(world.mass_properties(must(world.create_body(def)))), own, 1e-14);
  def.mass = 7;
  check_near(must(world.mass_properties(must(world.create_body(def)))), {7, 7 / own.mass * own.moments}, 1e-14);
  def.moments = Vec3{1, 2, 2.5};
  const BodyId given = must(world.create_body(def));
  check_near(must(world.mass_properties(given)), {7, {1, 2, 2.5}}, 1e-14);
  const std::uint32_t row = must(world.row_of(given));
  CHECK(must(world.view("inverse_mass")).at(row) == 1.0 / 7);
  CHECK(must(world.view("inverse_moments")).at(row, 2) == 1 / 2.5);
  CHECK(must(world.view("middle_axis")).at(row) == 1);
  for (const BodyKind kind : {BodyKind::fixed, BodyKind::kinematic}) {
    def.kind = kind;
    const BodyId unmoved = must(world.create_body(def));
    CHECK(must(world.mass_properties(unmoved)).mass == 0);
    CHECK(must(world.view("inverse_mass")).at(must(world.row_of(unmoved))) == 0);
  }
}

TEST_CASE("the axis of the middle moment, ties included") {
  World world;
  const auto middle = [&](Vec3 moments) {
    BodyDef def;
    def.mass = 1;
    def.moments = moments;
    const std::uint32_t row = must(world.row_of(must(world.create_body(def))));
    return must(world.view("middle_axis")).at(row);
  };
  CHECK(middle({1, 2, 2.5}) == 1);
  CHECK(middle({2, 1, 2.5}) == 0);
  CHECK(middle({1, 2.5, 2}) == 2);
  CHECK(middle({2.5, 1, 2}) == 2);
  CHECK(middle({2, 2.5, 1}) == 0);
  CHECK(middle({2.5, 2, 1}) == 1);
  for (const Vec3 tie :
       {Vec3{1, 1, 1}, Vec3{1, 1, 2}, Vec3{2, 1, 1}, Vec3{1, 2, 1}, Vec3{2, 2, 1}, Vec3{1, 2, 2}, Vec3{2, 1, 2}}) {
    const double m[3] = {tie.x, tie.y, tie.z};
    const int axis = int(middle(tie));
    const int others[2] = {(axis + 1) % 3, (axis + 2) % 3};
    CHECK(std::min(m[others[0]], m[others[1]]) <= m[axis]);
    CHECK(m[axis] <= std::max(m[others[0]], m[others[1]]));
  }
}

TEST_CASE("compound: two half boxes are the box") {
  BodyDef def;
  def.pose = {{1, 2, 3}, axis_angle({0, 0, 1}, 0.3)};
  def.shapes = {ShapeDef::box({0.25, 0.2, 0.3}), ShapeDef::box({0.25, 0.2, 0.3})};
  def.shapes[0].local.position = {-0.25, 0, 0};
  def.shapes[1].local.position = {0.25, 0, 0};
  BodyDef whole;
  whole.pose = def.pose;
  const MassProperties box = must(mass_properties(ShapeDef::box({0.5, 0.2, 0.3}), def.density));
  whole.moments = box.moments;
  must(make_compound(def));
  CHECK(*def.mass == doctest::Approx(box.mass).epsilon(1e-14));
  CHECK(length(def.pose.position - whole.pose.position) < 1e-14);
  CHECK((world_inertia(def) - world_inertia(whole)).norm() < 1e-12 * box.mass);
  CHECK(def.moments->x <= def.moments->y);
  CHECK(def.moments->y <= def.moments->z);
}

TEST_CASE("compound: shapes stay where they were, axes are principal, the mass may be given") {
  BodyDef def;
  def.pose = {{-1, 0.5, 2}, axis_angle({0, 1, 0}, 1.1)};
  def.shapes = {ShapeDef::sphere(0.3), ShapeDef::capsule(0.1, 0.4), ShapeDef::box({0.2, 0.1, 0.3}),
                ShapeDef::cylinder(0.15, 0.2)};
  def.shapes[1].local = {{0.5, 0.2, 0}, axis_angle({1, 0, 0}, 0.7)};
  def.shapes[2].local = {{-0.3, 0.6, 0.1}, axis_angle({0, 0, 1}, -0.4)};
  def.shapes[3].local = {{0.1, -0.4, -0.5}, axis_angle({0, 0.6, 0.8}, 2.0)};
  const BodyDef before = def;
  // the oracle: mass, centre and inertia about world axes, straight from the definition
  double mass = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  const auto place = [&](const BodyDef& d, std::size_t i) -> Pose {
    return {transform(d.pose, d.shapes[i].local.position), d.pose.orientation * d.shapes[i].local.orientation};
  };
  for (std::size_t i = 0; i < before.shapes.size(); i++) {
    const double m = must(mass_properties(before.shapes[i], before.density)).mass;
    const Eigen::Vector3d at = place(before, i).position;
    mass += m;
    centre += m * at;
  }
  centre /= mass;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < before.shapes.size(); i++) {
    const MassProperties m = must(mass_properties(before.shapes[i], before.density));
    const Eigen::Vector3d d = Eigen::Vector3d(place(before, i).position) - centre;
    BodyDef part;
    part.pose = place(before, i);
    part.moments = m.moments;
    inertia += world_inertia(part) + m.mass * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  }
  must(make_compound(def));
  CHECK(*def.mass == doctest::Approx(mass).epsilon(1e-13));
  CHECK((Eigen::Vector3d(def.pose.position) - centre).norm() < 1e-13);
  CHECK((world_inertia(def) - inertia).norm() < 1e-12 * inertia.norm());
  for (std::size_t i = 0; i < def.shapes.size(); i++) {
    const Pose was = place(before, i), is = place(def, i);
    CHECK(length(was.position - is.position) < 1e-13);
    CHECK(std::fabs((conjugate(was.orientation) * is.orientation).w) == doctest::Approx(1).epsilon(1e-13));
  }
  World world;
  (void)must(world.create_body(def));

  BodyDef heavier = before;
  heavier.mass = 2 * mass;
  must(make_compound(heavier));
  CHECK(*heavier.mass == doctest::Approx(2 * mass).epsilon(1e-13));
  CHECK(heavier.moments->x == doctest::Approx(2 * def.moments->x).epsilon(1e-12));
}

TEST_CASE("Eigen's types convert implicitly both ways") {
  World world(WorldDef{Precision::f64, Eigen::Vector3d(0, -1, 0)});
  BodyDef def = ball({});
  def.pose.position = Eigen::Vector3d(1, 2, 3);
  def.pose.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()));
  def.velocity = Eigen::Vector3f(4, 5, 6);
  const BodyId body = must(world.create_body(def));
  must(world.set_angular_velocity(body, Eigen::Vector3d(7, 8, 9)));
  const Eigen::Vector3d p = must(world.pose(body)).position, v = must(world.velocity(body)), g = world.gravity();
  const Eigen::Quaterniond q = must(world.pose(body)).orientation;
  const Eigen::Vector3f w = must(world.angular_velocity(body));
  CHECK(p == Eigen::Vector3d(1, 2, 3));
  CHECK(v == Eigen::Vector3d(4, 5, 6));
  CHECK(g == Eigen::Vector3d(0, -1, 0));
  CHECK(w.isApprox(Eigen::Vector3f(7, 8, 9), 1e-6f));
  CHECK(q.angularDistance(Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()))) < 1e-15);
  // components keep their places: w first in Eigen's constructor, last in ours
  const Quat ours(0.1, 0.2, 0.3, 0.4);
  const Eigen::Quaterniond theirs = ours;
  CHECK(theirs.w() == 0.4);
  CHECK(theirs.x() == 0.1);
  CHECK(Quat(theirs) == ours);
}
