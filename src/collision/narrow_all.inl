// Instantiates the narrow phase for PC_SCALAR: copies in and out, no arithmetic.
#include "collision/narrow.h"
#include "cpu/prelude.h"
#include "world/hull.h"

namespace pcphys {
namespace PC_NAMESPACE {
// Where a hull's numbers stand: pointers here, offsets into a buffer in GLSL.
struct HullRef {
  const Scalar* reals;
  const uint* indices;
};
PC_FN Real pc_hull_real(HullRef h, uint i) { return h.reals[i]; }
PC_FN uint pc_hull_index(HullRef h, uint i) { return h.indices[i]; }
#include "kernels/narrow/narrow.inl"

static HullRef hull_of(const ShapeView<Scalar>& s) {
  HullRef h{nullptr, nullptr};
  if (s.hull) {
    s.hull->table.reals_of(h.reals);
    h.indices = s.hull->table.indices.data();
  }
  return h;
}
static NarrowShape from_view(const ShapeView<Scalar>& s) {
  return {uint(s.kind),
          {s.size[0], s.size[1], s.size[2]},
          {s.p[0], s.p[1], s.p[2]},
          pc_quaternion({s.q[0], s.q[1], s.q[2]}, s.q[3]),
          hull_of(s)};
}
// What is read of one.
static inline NarrowShape ball_from_view(const ShapeView<Scalar>& s) {
  NarrowShape ball{};
  ball.size.x = s.size[0];
  ball.p = {s.p[0], s.p[1], s.p[2]};
  return ball;
}
}  // namespace PC_NAMESPACE

void narrow(const ShapeView<PC_SCALAR>& a, const ShapeView<PC_SCALAR>& b, PC_SCALAR margin, std::uint32_t& hint,
            Manifold<PC_SCALAR>& out) {
  using namespace PC_NAMESPACE;
  static_assert(PC_SPHERE == uint(ShapeKind::sphere) && PC_CAPSULE == uint(ShapeKind::capsule) &&
                PC_BOX == uint(ShapeKind::box) && PC_CYLINDER == uint(ShapeKind::cylinder) &&
                PC_HULL == uint(ShapeKind::hull) && PC_PLANE == uint(ShapeKind::plane));
  NarrowManifold m;
  m.normal = {0, 1, 0};
  m.count = 0;
  // the two kinds of pairs that piles are made of: handing whole shapes on would take as long as the rest
  if (a.kind == ShapeKind::sphere && b.kind == ShapeKind::sphere)
    pc_sphere_sphere(ball_from_view(a), ball_from_view(b), margin, m);
  else if (a.kind == ShapeKind::capsule && b.kind == ShapeKind::capsule)
    pc_capsule_capsule(from_view(a), from_view(b), margin, m);
  else
    pc_narrow(from_view(a), from_view(b), margin, hint, m);
  out.normal[0] = m.normal.x;
  out.normal[1] = m.normal.y;
  out.normal[2] = m.normal.z;
  out.count = m.count;
  for (uint i = 0; i < m.count; i++) {
    const NarrowPoint& p = m.points[i];
    out.points[i] = {{p.p.x, p.p.y, p.p.z}, p.separation, p.feature};
  }
}

}  // namespace pcphys
