#include "wild/shapes.h"

#include <algorithm>
#include <vector>

namespace pcphys::wild {
namespace {

constexpr double thinnest = 0.05;  // of the outer radius
constexpr ShapeKind kinds[] = {ShapeKind::sphere, ShapeKind::capsule, ShapeKind::box, ShapeKind::cylinder,
                               ShapeKind::hull};

/// Three half extents with a space diagonal of `radius`, of any proportions.
Vec3 random_extents(Dice& dice, double radius) {
  const Vec3 e{dice.by_ratio(0.1, 1), dice.by_ratio(0.1, 1), dice.by_ratio(0.1, 1)};
  return e * (radius / length(e));
}

}  // namespace

Hull random_hull(Dice& dice, double radius) {
  while (true) {
    std::vector<Vec3> points;
    const int count = 4 + dice.one_of(21);
    const Vec3 extents{dice.between(0.3, 1), dice.between(0.3, 1), dice.between(0.3, 1)};
    for (int i = 0; i < count; i++) {
      const Vec3 d = dice.direction();
      points.push_back(Vec3{d.x * extents.x, d.y * extents.y, d.z * extents.z} * radius);
    }
    const auto hull = make_hull(points);
    if (hull && hull->inner_radius() > thinnest * radius) return *hull;
  }
}

ShapeDef random_shape(Dice& dice, ShapeKind kind, double radius) {
  switch (kind) {
    case ShapeKind::capsule: {
      const double thick = radius * dice.between(0.15, 0.8);
      return ShapeDef::capsule(thick, radius - thick);
    }
    case ShapeKind::box: return ShapeDef::box(random_extents(dice, radius));
    case ShapeKind::cylinder: {
      const double angle = dice.between(0.1, 1.45);
      return ShapeDef::cylinder(radius * std::cos(angle), radius * std::sin(angle));
    }
    case ShapeKind::hull: return ShapeDef::hull(random_hull(dice, radius));
    default: break;
  }
  return ShapeDef::sphere(radius);
}

ShapeDef random_shape(Dice& dice, double radius) { return random_shape(dice, kinds[dice.one_of(5)], radius); }

double outer_radius(const ShapeDef& shape) {
  switch (shape.kind) {
    case ShapeKind::capsule: return shape.size.x + shape.size.y;
    case ShapeKind::box: return length(shape.size);
    case ShapeKind::cylinder: return std::hypot(shape.size.x, shape.size.y);
    case ShapeKind::hull: return shape.convex.radius();
    default: break;
  }
  return shape.size.x;
}

double extent_along(const ShapeDef& shape, Quat orientation, Vec3 direction) {
  const Vec3 d = rotate(conjugate(shape.local.orientation), rotate(conjugate(orientation), direction));
  switch (shape.kind) {
    case ShapeKind::capsule: return shape.size.x + std::fabs(d.y) * shape.size.y;
    case ShapeKind::box:
      return std::fabs(d.x) * shape.size.x + std::fabs(d.y) * shape.size.y + std::fabs(d.z) * shape.size.z;
    case ShapeKind::cylinder: return std::hypot(d.x, d.z) * shape.size.x + std::fabs(d.y) * shape.size.y;
    case ShapeKind::hull: {
      double most = 0;
      for (const Vec3 v : shape.convex.vertices()) most = std::max(most, dot(v, d));
      return most;
    }
    default: break;
  }
  return shape.size.x;
}

double random_dt(Dice& dice) {
  constexpr double rates[] = {30, 60, 60, 60, 90, 120, 144, 240};
  return 1 / rates[dice.one_of(8)];
}

Material random_material(Dice& dice) {
  Material m;
  m.static_friction = m.kinetic_friction = dice.chance(0.2) ? 0 : dice.between(0, 1);
  if (dice.chance(0.3)) m.static_friction *= 1.5;
  m.restitution = dice.chance(0.5) ? 0 : dice.between(0, 1);
  return m;
}

}  // namespace pcphys::wild
