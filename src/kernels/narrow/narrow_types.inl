// Narrow phase: shapes, manifolds, tolerances and small helpers shared by all pairs.
//
// Every pair function takes shapes relative to one nearby origin and gives the unit normal from a to b and up
// to four points midway between the surfaces. All tolerances are relative to the shapes, none is a length.
#ifndef PC_FN_LARGE
#define PC_FN_LARGE PC_FN  // functions too large to be inlined at every call
#endif

// values of ShapeKind
const uint PC_SPHERE = 0u;
const uint PC_CAPSULE = 1u;
const uint PC_BOX = 2u;
const uint PC_CYLINDER = 3u;
const uint PC_HULL = 4u;
const uint PC_PLANE = 5u;

// an edge pair must beat the best face by this times the smallest half extent: faces carry four points
#define PC_EDGE_SLOP PC_REAL(4e-3)
// the second face must beat the larger face by this times the smallest half extent
#define PC_FACE_SLOP PC_REAL(1e-3)
// a vertex this far (times the extent) outside a clipping edge still counts as inside: aligned stacks keep
// their corners and feature ids
#define PC_CLIP_SLOP PC_REAL(2e-3)
// gains below these are noise when four points are chosen (length and area, relative)
#define PC_DEEPER_SLOP PC_REAL(1e-4)
// the same of overlapping faces with many corners, since a loaded stack rocks by more:
// another choice loses the impulses
#define PC_FLAT_SLOP PC_REAL(1e-3)
#define PC_WIDER_SLOP PC_REAL(1.01)

struct NarrowShape {
  uint kind;
  Vec3 size;
  Vec3 p;
  Quaternion q;
  HullRef hull;
};
struct NarrowPoint {
  Vec3 p;
  Real separation;
  uint feature;
};
struct NarrowManifold {
  Vec3 normal;
  uint count;
  NarrowPoint points[4];
};

PC_FN Real pc_component(Vec3 v, uint i) { return i == 0u ? v.x : (i == 1u ? v.y : v.z); }
PC_FN Vec3 pc_axis(Axes m, uint i) {
  if (i == 0u) return m.x;
  if (i == 1u) return m.y;
  return m.z;
}
PC_FN Vec3 pc_unit_axis(uint i, Real s) {
  return Vec3(i == 0u ? s : PC_REAL(0.0), i == 1u ? s : PC_REAL(0.0), i == 2u ? s : PC_REAL(0.0));
}
PC_FN uint pc_next(uint i) { return i == 2u ? 0u : i + 1u; }
PC_FN uint pc_greatest_component(Vec3 v) {
  uint i = v.y > v.x ? 1u : 0u;
  return v.z > pc_component(v, i) ? 2u : i;
}
PC_FN uint pc_least_component(Vec3 v) {
  Vec3 s = pc_abs3(v);
  uint i = s.y < s.x ? 1u : 0u;
  return s.z < pc_component(s, i) ? 2u : i;
}
// Middle of that edge of the box |x_i| <= h_i along axis i which lies farthest along n.
PC_FN Vec3 pc_edge_middle(Vec3 h, uint i, Vec3 n) {
  Vec3 c = Vec3(n.x < PC_REAL(0.0) ? -h.x : h.x, n.y < PC_REAL(0.0) ? -h.y : h.y, n.z < PC_REAL(0.0) ? -h.z : h.z);
  return Vec3(i == 0u ? PC_REAL(0.0) : c.x, i == 1u ? PC_REAL(0.0) : c.y, i == 2u ? PC_REAL(0.0) : c.z);
}

PC_FN void pc_push(PC_INOUT(NarrowManifold) m, Vec3 p, Real separation, uint feature) {
  uint i = m.count;
  m.points[i].p = p;
  m.points[i].separation = separation;
  m.points[i].feature = feature;
  m.count = i + 1u;
}
// The point x of shape a's core, whose surface lies `radius` along n and b's surface `separation` beyond.
PC_FN void pc_push_from(PC_INOUT(NarrowManifold) m, Vec3 x, Vec3 n, Real radius, Real separation, Real margin,
                        uint feature) {
  if (separation > margin) return;
  precise Real reach = radius + separation * PC_REAL(0.5);
  pc_push(m, pc_madd(x, n, reach), separation, feature);
}

// GJK stops at this gap, relative to the squared distance; below this squared sine a triangle has no normal.
// EPA stops at this gap, its vertices are rounded by that, and an exact normal may separate less by the last,
// all relative to the size of both shapes.
#ifdef PC_DOUBLE
#define PC_GJK_GAP PC_REAL(1e-12)
#define PC_GJK_SLIVER PC_REAL(1e-20)
#define PC_EPA_GAP PC_REAL(1e-7)
#define PC_EPA_ROUNDING PC_REAL(1e-15)
#define PC_SHARPEN_SLOP PC_REAL(1e-9)
#else
#define PC_GJK_GAP PC_REAL(1e-6)
#define PC_GJK_SLIVER PC_REAL(1e-8)
#define PC_EPA_GAP PC_REAL(3e-6)
#define PC_EPA_ROUNDING PC_REAL(3e-7)
#define PC_SHARPEN_SLOP PC_REAL(1e-6)
#endif
