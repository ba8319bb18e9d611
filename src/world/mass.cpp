// Mass properties of the shapes (the original's getInertiaMat), and of several shapes as one body.
#include <Eigen/Dense>
#include <numbers>

#include "pcphys/constants.h"
#include "pcphys/world.h"
#include "world/validate.h"

namespace pcphys {
namespace {

using std::numbers::pi;

MassProperties of_sphere(double r, double density) {
  const double m = density * 4.0 / 3.0 * pi * r * r * r, i = 0.4 * m * r * r;
  return {m, {i, i, i}};
}
MassProperties of_box(Vec3 h, double density) {
  const double m = density * 8 * h.x * h.y * h.z, k = m / 3;
  return {m, {k * (h.y * h.y + h.z * h.z), k * (h.x * h.x + h.z * h.z), k * (h.x * h.x + h.y * h.y)}};
}
MassProperties of_cylinder(double r, double half, double density) {
  const double m = density * pi * r * r * 2 * half, across = m * (r * r / 4 + half * half / 3);
  return {m, {across, 0.5 * m * r * r, across}};
}
/// A cylinder and two half spheres, whose centres of mass stand 3 r / 8 beyond the cylinder's ends.
MassProperties of_capsule(double r, double half, double density) {
  const MassProperties body = of_cylinder(r, half, density), caps = of_sphere(r, density);
  const double across = body.moments.x + caps.mass * (0.4 * r * r + half * half + 0.75 * r * half);
  return {body.mass + caps.mass, {across, body.moments.y + caps.moments.y, across}};
}

Eigen::Matrix3d world_inertia(const MassProperties& m, const Eigen::Quaterniond& q) {
  const Eigen::Matrix3d r = q.toRotationMatrix();
  const Eigen::Vector3d moments = m.moments;
  return r * moments.asDiagonal() * r.transpose();
}

}  // namespace

Result<MassProperties> mass_properties(const ShapeDef& shape, double density) try {
  if (Status ok = check(shape); !ok) return ok.error();
  if (!(density >= constants::smallest_mass && density <= constants::largest_mass))
    return Error{ErrorCode::bad_mass, "A density must be above zero, between " + number(constants::smallest_mass) +
                                          " and " + number(constants::largest_mass) + " kg/m^3; it is " +
                                          number(density) + " kg/m^3."};
  switch (shape.kind) {
    case ShapeKind::sphere: return of_sphere(shape.size.x, density);
    case ShapeKind::capsule: return of_capsule(shape.size.x, shape.size.y, density);
    case ShapeKind::box: return of_box(shape.size, density);
    case ShapeKind::cylinder: return of_cylinder(shape.size.x, shape.size.y, density);
    case ShapeKind::hull: return MassProperties{density * shape.convex.volume(), density * shape.convex.moments()};
    case ShapeKind::plane: break;
  }
  return Error{ErrorCode::bad_mass, "A plane has no mass: use it on fixed bodies."};
} catch (...) {
  return caught();
}

Status make_compound(BodyDef& def) try {
  if (def.shapes.empty()) return Error{ErrorCode::degenerate_shape, "A compound needs at least one shape."};
  Quat orientation = def.pose.orientation;
  Status ok = check_finite(def.pose.position, "position of a body");
  if (ok) ok = check_unit(orientation, "orientation of a body");
  if (ok && def.mass) ok = check({*def.mass, {1, 1, 1}});
  if (!ok) return ok;
  std::vector<MassProperties> parts;
  double mass = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const ShapeDef& shape : def.shapes) {
    Result<MassProperties> part = mass_properties(shape, def.density);
    if (!part) return part.error();
    parts.push_back(*part);
    mass += part->mass;
    const Eigen::Vector3d at = shape.local.position;
    centre += part->mass * at;
  }
  centre /= mass;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < parts.size(); i++) {
    const Eigen::Vector3d at = def.shapes[i].local.position, d = at - centre;
    inertia += world_inertia(parts[i], def.shapes[i].local.orientation) +
               parts[i].mass * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  const Eigen::Quaterniond turn(axes);
  const double scale = def.mass ? *def.mass / mass : 1.0;
  const MassProperties whole{scale * mass, Vec3(Eigen::Vector3d(scale * solver.eigenvalues()))};
  if (def.kind == BodyKind::dynamic) ok = check(whole, def.rotates);
  if (!ok) return ok;
  for (ShapeDef& shape : def.shapes) {
    const Eigen::Vector3d at = shape.local.position;
    const Eigen::Quaterniond axes_of_shape = shape.local.orientation;
    shape.local.position = Eigen::Vector3d(turn.conjugate() * (at - centre));
    shape.local.orientation = (turn.conjugate() * axes_of_shape).normalized();
  }
  def.pose.position = transform(def.pose, Vec3(centre));
  def.pose.orientation = def.pose.orientation * Quat(turn);
  def.mass = whole.mass;
  def.moments = whole.moments;
  return {};
} catch (...) {
  return caught();
}

}  // namespace pcphys
