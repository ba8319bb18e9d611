#include "wild/overlaps.h"

#include <algorithm>

#include "collision/narrow.h"
#include "wild/distance.h"
#include "wild/shapes.h"

namespace pcphys::wild {
namespace {

/// How deep two shapes overlap; 0 where they do not [m].
double depth(const Placed& a, const Placed& b) {
  if (distance(a, b) > 0) return 0;
  const auto view = [&](const Placed& p) {
    const Vec3 at = p.pose.position - a.pose.position;
    const Quat q = p.pose.orientation;
    ShapeView<double> v{
        p.shape->kind, {p.shape->size.x, p.shape->size.y, p.shape->size.z}, {at.x, at.y, at.z}, {q.x, q.y, q.z, q.w}};
    if (p.shape->kind != ShapeKind::hull) return v;
    v.size[0] = p.shape->convex.radius();
    v.size[1] = p.shape->convex.inner_radius();
    v.hull = p.shape->convex.data();
    return v;
  };
  std::uint32_t hint = 0;
  Manifold<double> m;
  narrow(view(a), view(b), 0, hint, m);
  double deepest = 0;
  for (std::uint32_t i = 0; i < m.count; i++) deepest = std::max(deepest, -m.points[i].separation);
  return deepest;
}

}  // namespace

void Overlaps::made(const Eye& eye, int number, bool others) {
  const Observation& seen = eye.seen();
  const SeenBody& body = seen.body(number);
  if (!body.there) return;
  for (std::size_t i = 0; i < seen.bodies.size(); i++) {
    const SeenBody& other = seen.bodies[i];
    if (int(i) == number || !other.there || (body.kind != BodyKind::dynamic && other.kind != BodyKind::dynamic))
      continue;
    double deepest = 0;
    for (const ShapeDef& x : eye.shapes(number))
      for (const ShapeDef& y : eye.shapes(int(i)))
        deepest = std::max(deepest, depth(placed(x, body.pose), placed(y, other.pose)));
    if (deepest == 0) continue;
    if (body.kind == BodyKind::dynamic) made_.push_back({body.mass.mass, deepest});
    if (others && other.kind == BodyKind::dynamic) made_.push_back({other.mass.mass, deepest});
  }
}

void Overlaps::made(const Eye& eye) {
  for (std::size_t i = 0; i < eye.seen().bodies.size(); i++) made(eye, int(i), false);
}

double Overlaps::undone(const Eye& eye, const StepSettings& settings, double dt) {
  const double shortest = dt / (double(settings.substeps) * std::max(settings.refinement, 1u));
  double energy = 0;
  for (const Overlap& o : made_) {
    const double push = std::min(settings.push_speed, o.depth / shortest);
    energy += o.mass * (length(eye.seen().gravity) * o.depth + 0.5 * push * push);
  }
  made_.clear();
  return energy;
}

}  // namespace pcphys::wild
