// Overlap of bodies, by definition and without the library's own collision code.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>

#include "hull_overlap.h"
#include "metrics.h"

namespace pcphys::scenes {
namespace {

constexpr double cell_size = 1.05;  // no body of those scenes is longer [m]
constexpr double far_away = 1e5;    // a body beyond is lost and has no cell [m]

/// The core of a round body: a capsule's segment, a sphere's centre twice.
struct Segment {
  Vec3 start, end;
};

Segment core(const ShapeDef& shape, const Pose& pose) {
  const double half = shape.kind == ShapeKind::capsule ? shape.size.y : 0;
  const Vec3 arm = rotate(pose.orientation, {0, half, 0});
  return {pose.position - arm, pose.position + arm};
}

double clamp01(double x) { return std::clamp(x, 0.0, 1.0); }

/// Smallest distance of two segments (Ericson, Real-Time Collision Detection, 5.1.9).
double distance(const Segment& a, const Segment& b) {
  constexpr double point = 1e-12, parallel = 1e-14;
  const Vec3 u = a.end - a.start, v = b.end - b.start, r = a.start - b.start;
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), ur = dot(u, r), vr = dot(v, r);
  double s = 0, t = 0;
  if (uu > point && vv > point) {
    const double determinant = uu * vv - uv * uv;
    s = determinant > parallel ? clamp01((uv * vr - ur * vv) / determinant) : 0;
    t = (uv * s + vr) / vv;
    if (t < 0) s = clamp01(-ur / uu);
    if (t > 1) s = clamp01((uv - ur) / uu);
    t = clamp01(t);
  } else if (uu > point) {
    s = clamp01(-ur / uu);
  } else if (vv > point) {
    t = clamp01(vr / vv);
  }
  return length((a.start + s * u) - (b.start + t * v));
}

/// How far a shape reaches below its centre, and above but for hulls.
double half_height(const ShapeDef& shape, Quat q) {
  const double ax = std::fabs(rotate(q, {1, 0, 0}).y), ay = std::fabs(rotate(q, {0, 1, 0}).y),
               az = std::fabs(rotate(q, {0, 0, 1}).y);
  switch (shape.kind) {
    case ShapeKind::sphere: return shape.size.x;
    case ShapeKind::capsule: return shape.size.x + shape.size.y * ay;
    case ShapeKind::cylinder: return shape.size.x * std::sqrt(std::max(0.0, 1 - ay * ay)) + shape.size.y * ay;
    case ShapeKind::box: return shape.size.x * ax + shape.size.y * ay + shape.size.z * az;
    case ShapeKind::hull: {
      double low = 0;
      for (const Vec3& v : shape.convex.vertices()) low = std::min(low, rotate(q, v).y);
      return -low;
    }
    case ShapeKind::plane: break;
  }
  return 0;
}

Penetration of_supports(const Scene& scene, std::span<const Pose> poses) {
  Penetration result;
  for (const Support& support : scene.supports) {
    const std::size_t upper = std::size_t(support.upper);
    const double bottom = poses[upper].position.y - half_height(scene.bodies[upper].shape, poses[upper].orientation);
    if (support.lower < 0) {
      result.add(-bottom);
      continue;
    }
    const std::size_t lower = std::size_t(support.lower);
    const Vec3 apart = poses[upper].position - poses[lower].position;
    if (std::fabs(apart.x) < 0.9 && std::fabs(apart.z) < 0.9)  // still above one another
      result.add(poses[lower].position.y + half_height(scene.bodies[lower].shape, poses[lower].orientation) - bottom);
  }
  return result;
}

Penetration of_floor(const Scene& scene, std::span<const Pose> poses) {
  Penetration result;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const SceneBody& body = scene.bodies[i];
    if (body.kind != BodyKind::dynamic || body.shape.filter.mask == 0) continue;
    result.add(*scene.floor - (poses[i].position.y - half_height(body.shape, poses[i].orientation)));
  }
  return result;
}

/// Round bodies, or hulls, in the open-lidded box, found through a grid.
class Container {
 public:
  Container(const Scene& scene, const World& world, std::span<const Pose> poses) : scene_(scene), poses_(poses) {
    std::unordered_map<std::uint64_t, std::uint64_t> place;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) place[key(scene.bodies[i].id)] = i;
    for (JointId id : scene.joints) {
      const auto joint = world.joint(id);
      if (!joint || !place.contains(key(joint->a)) || !place.contains(key(joint->b))) continue;
      adjacent_.insert(pair_key(place[key(joint->a)], place[key(joint->b)]));
    }
  }

  Penetration measure() {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (!counts(i)) continue;
      against_walls(i);
      against_neighbours(i);  // those that are in the grid already: each pair once
      grid_[cell_key(cell(i))].push_back(i);
    }
    return result_;
  }

 private:
  struct Cell {
    long x, y, z;
  };

  static std::uint64_t key(BodyId id) { return std::uint64_t(id.generation) << 32 | id.index; }
  static std::uint64_t pair_key(std::uint64_t a, std::uint64_t b) { return std::min(a, b) << 32 | std::max(a, b); }
  static std::uint64_t cell_key(Cell c) {
    return (std::uint64_t(c.x & 0x1fffff) << 42) | (std::uint64_t(c.y & 0x1fffff) << 21) |
           std::uint64_t(c.z & 0x1fffff);
  }

  bool counts(std::size_t i) const {
    const Vec3 p = poses_[i].position;
    return scene_.bodies[i].kind == BodyKind::dynamic && std::fabs(p.x) < far_away && std::fabs(p.y) < far_away &&
           std::fabs(p.z) < far_away;
  }

  Cell cell(std::size_t i) const {
    const Vec3 p = poses_[i].position;
    return {long(std::floor(p.x / cell_size)), long(std::floor(p.y / cell_size)), long(std::floor(p.z / cell_size))};
  }

  void against_walls(std::size_t i) {
    const Vec3 p = poses_[i].position;
    const double half = 0.5 * scene_.inner_width, reach = half + 0.5;  // within the walls' thickness
    if (!(p.y > -0.5 && std::fabs(p.x) < reach && std::fabs(p.z) < reach && p.y < scene_.wall_height)) return;
    if (scene_.bodies[i].shape.kind == ShapeKind::hull) return hull_against_walls(i, half);
    const Segment s = core(scene_.bodies[i].shape, poses_[i]);
    const double radius = scene_.bodies[i].shape.size.x;
    result_.add(radius - std::min(s.start.y, s.end.y));
    result_.add(radius - (half - std::max(s.start.x, s.end.x)));
    result_.add(radius - (std::min(s.start.x, s.end.x) + half));
    result_.add(radius - (half - std::max(s.start.z, s.end.z)));
    result_.add(radius - (std::min(s.start.z, s.end.z) + half));
  }

  void hull_against_walls(std::size_t i, double half) {
    Vec3 low{1e300, 1e300, 1e300}, high = -low;
    for (const Vec3& v : scene_.bodies[i].shape.convex.vertices()) {
      const Vec3 p = transform(poses_[i], v);
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    for (double depth : {-low.y, high.x - half, -low.x - half, high.z - half, -low.z - half}) result_.add(depth);
  }

  double overlap_of(std::size_t i, std::size_t k) const {
    const ShapeDef &a = scene_.bodies[i].shape, &b = scene_.bodies[k].shape;
    if (a.kind == ShapeKind::hull && b.kind == ShapeKind::hull)
      return overlap(a.convex, poses_[i], b.convex, poses_[k]);
    return a.size.x + b.size.x - distance(core(a, poses_[i]), core(b, poses_[k]));
  }

  void against_neighbours(std::size_t i) {
    const Cell centre = cell(i);
    for (long x = -1; x <= 1; ++x)
      for (long y = -1; y <= 1; ++y)
        for (long z = -1; z <= 1; ++z) {
          const auto found = grid_.find(cell_key({centre.x + x, centre.y + y, centre.z + z}));
          if (found == grid_.end()) continue;
          for (std::size_t k : found->second) {
            if (!adjacent_.contains(pair_key(i, k))) result_.add(overlap_of(i, k));
          }
        }
  }

  const Scene& scene_;
  std::span<const Pose> poses_;
  std::unordered_set<std::uint64_t> adjacent_;  // pairs that a joint connects
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> grid_;
  Penetration result_;
};

}  // namespace

void Penetration::add(double depth) {
  if (!(depth > 0)) return;
  max = std::max(max, depth);
  sum += depth;
  ++count;
}

Penetration penetration(const Scene& scene, const World& world, std::span<const Pose> poses) {
  if (!scene.supports.empty()) return of_supports(scene, poses);
  if (scene.inner_width > 0) return Container(scene, world, poses).measure();
  if (scene.floor) return of_floor(scene, poses);
  return {};
}

}  // namespace pcphys::scenes
