// FCL's types stay in this file: its headers are large, and Eigen's flags must not reach ours.
#include "fcl/fcl_narrow.h"

#ifdef PCPHYS_HAVE_FCL
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "world/hull.h"

namespace pcphys {
namespace {

using Vector = fcl::Vector3d;

struct Object {
  std::shared_ptr<fcl::CollisionGeometryd> geometry;
  fcl::Transform3d pose;
};

// Made anew in each call: FCL's own copy of vertices and faces, with its edges.
std::shared_ptr<fcl::Convexd> convex(const HullData& hull) {
  auto vertices = std::make_shared<std::vector<Vector>>();
  auto faces = std::make_shared<std::vector<int>>();
  for (const Vec3& v : hull.vertices) vertices->emplace_back(v.x, v.y, v.z);
  for (std::size_t f = 0; f + 1 < hull.first.size(); f++) {
    faces->push_back(int(hull.first[f + 1] - hull.first[f]));
    faces->insert(faces->end(), hull.corners.begin() + hull.first[f], hull.corners.begin() + hull.first[f + 1]);
  }
  return std::make_shared<fcl::Convexd>(vertices, int(hull.first.size()) - 1, faces);
}

// FCL's capsules and cylinders stand along z, ours along y; a plane is FCL's half space, raised by `raise`.
Object object(const ShapeView<double>& s, double raise) {
  Object o;
  o.pose.setIdentity();
  const fcl::Quaterniond q(s.q[3], s.q[0], s.q[1], s.q[2]);
  const Vector p(s.p[0], s.p[1], s.p[2]);
  o.pose.linear() = q.normalized().toRotationMatrix();
  o.pose.translation() = p;
  const fcl::Matrix3d y_to_z = fcl::AngleAxisd(-0.5 * 3.14159265358979323846, Vector::UnitX()).toRotationMatrix();
  switch (s.kind) {
    case ShapeKind::sphere: o.geometry = std::make_shared<fcl::Sphered>(s.size[0]); break;
    case ShapeKind::capsule:
      o.geometry = std::make_shared<fcl::Capsuled>(s.size[0], 2 * s.size[1]);
      o.pose.linear() = o.pose.linear() * y_to_z;
      break;
    case ShapeKind::cylinder:
      o.geometry = std::make_shared<fcl::Cylinderd>(s.size[0], 2 * s.size[1]);
      o.pose.linear() = o.pose.linear() * y_to_z;
      break;
    case ShapeKind::box: o.geometry = std::make_shared<fcl::Boxd>(2 * s.size[0], 2 * s.size[1], 2 * s.size[2]); break;
    case ShapeKind::hull: o.geometry = convex(*s.hull); break;
    case ShapeKind::plane: o.geometry = std::make_shared<fcl::Halfspaced>(Vector::UnitY(), raise); break;
  }
  return o;
}

struct Found {
  Vector normal;
  std::vector<std::pair<Vector, double>> points;
};  // points and separations

// Deepest, farthest, largest triangle, opposite, in the order found.
void reduce(std::vector<std::pair<Vector, double>>& points) {
  std::vector<std::pair<Vector, double>> kept;
  const auto take = [&](auto score) {
    const auto best = std::max_element(points.begin(), points.end(),
                                       [&](const auto& x, const auto& y) { return score(x) < score(y); });
    kept.push_back(*best);
    points.erase(best);
  };
  take([](const auto& x) { return -x.second; });
  take([&](const auto& x) { return (x.first - kept[0].first).squaredNorm(); });
  take([&](const auto& x) { return (kept[1].first - kept[0].first).cross(x.first - kept[0].first).squaredNorm(); });
  const Vector side = (kept[1].first - kept[0].first).cross(kept[2].first - kept[0].first);
  take([&](const auto& x) {
    double most = 0;
    for (int i = 0; i < 3; i++)
      most = std::max(most, -side.dot((kept[(i + 1) % 3].first - kept[i].first).cross(x.first - kept[i].first)));
    return most;
  });
  points = kept;
}

bool collide(const Object& a, const Object& b, double raise, Found& found) {
  fcl::CollisionRequestd request(8, true);
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::CollisionResultd result;
  fcl::collide(a.geometry.get(), a.pose, b.geometry.get(), b.pose, request, result);
  for (std::size_t i = 0; i < result.numContacts(); i++) {
    const auto& contact = result.getContact(i);
    if (!contact.pos.allFinite() || !contact.normal.allFinite() || contact.normal.norm() < 0.5) continue;
    if (found.points.empty()) found.normal = contact.normal.normalized();
    found.points.emplace_back(contact.pos, raise - contact.penetration_depth);
  }
  return !found.points.empty();
}

bool apart(const Object& a, const Object& b, double margin, Found& found) {
  fcl::DistanceRequestd request(true, false, 0, 0, 1e-9, fcl::GST_LIBCCD);
  fcl::DistanceResultd result;
  const double distance = fcl::distance(a.geometry.get(), a.pose, b.geometry.get(), b.pose, request, result);
  const Vector d = result.nearest_points[1] - result.nearest_points[0];
  if (!(distance > 0 && distance <= margin) || !d.allFinite() || !(d.norm() > 0)) return false;
  found.normal = d.normalized();
  found.points.emplace_back(0.5 * (result.nearest_points[0] + result.nearest_points[1]), distance);
  return true;
}

}  // namespace

bool fcl_available() { return true; }

bool narrow_fcl(const ShapeView<double>& a, const ShapeView<double>& b, double margin, Manifold<double>& out) {
  out.count = 0;
  const bool plane = a.kind == ShapeKind::plane || b.kind == ShapeKind::plane;
  if (a.kind == ShapeKind::plane && b.kind == ShapeKind::plane) return true;
  const double raise = plane ? margin : 0;
  Found found;
  try {
    const Object first = object(a, raise), second = object(b, raise);
    if (!collide(first, second, raise, found) && !plane) apart(first, second, margin, found);
  } catch (const std::exception&) {
    return false;
  }
  if (found.points.size() > 4) reduce(found.points);
  for (int i = 0; i < 3 && !found.points.empty(); i++) out.normal[i] = found.normal[i];
  for (const auto& [p, separation] : found.points)
    if (separation <= margin) {
      out.points[out.count] = {{p.x(), p.y(), p.z()}, separation, out.count};
      out.count++;
    }
  return true;
}

// FCL's own signed distance is not used: its polytope search stops the program on an assertion now and then.
bool distance_fcl(const ShapeView<double>& a, const ShapeView<double>& b, double& distance) {
  if (a.kind == ShapeKind::plane || b.kind == ShapeKind::plane) return false;
  Found found;
  try {
    const Object first = object(a, 0), second = object(b, 0);
    if (collide(first, second, 0, found)) {
      distance = 0;
      for (const auto& [p, separation] : found.points) distance = std::min(distance, separation);
      return true;
    }
    fcl::DistanceRequestd request(false, false, 0, 0, 1e-9, fcl::GST_LIBCCD);
    fcl::DistanceResultd result;
    distance = fcl::distance(first.geometry.get(), first.pose, second.geometry.get(), second.pose, request, result);
  } catch (const std::exception&) {
    return false;
  }
  return std::isfinite(distance) && distance >= 0;
}

}  // namespace pcphys

#else

namespace pcphys {
bool fcl_available() { return false; }
bool narrow_fcl(const ShapeView<double>&, const ShapeView<double>&, double, Manifold<double>& out) {
  out.count = 0;
  return false;
}
bool distance_fcl(const ShapeView<double>&, const ShapeView<double>&, double&) { return false; }
}  // namespace pcphys

#endif

namespace pcphys {

bool narrow_fcl(const ShapeView<float>& a, const ShapeView<float>& b, float margin, Manifold<float>& out) {
  const auto widen = [](const ShapeView<float>& s) {
    return ShapeView<double>{
        s.kind, {s.size[0], s.size[1], s.size[2]}, {s.p[0], s.p[1], s.p[2]}, {s.q[0], s.q[1], s.q[2], s.q[3]}, s.hull};
  };
  Manifold<double> wide;
  const bool done = narrow_fcl(widen(a), widen(b), double(margin), wide);
  out.count = wide.count;
  for (int i = 0; i < 3 && wide.count > 0; i++) out.normal[i] = float(wide.normal[i]);
  for (std::uint32_t i = 0; i < wide.count; i++) {
    const auto& p = wide.points[i];
    out.points[i] = {{float(p.p[0]), float(p.p[1]), float(p.p[2])}, float(p.separation), p.feature};
  }
  return done;
}

}  // namespace pcphys
