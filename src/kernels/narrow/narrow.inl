// The narrow phase: two shapes in, a manifold out. A pure function of shapes and margin.
#include "narrow_lines.inl"
#include "narrow_over_box.inl"
#include "narrow_types.inl"
#include "narrow_round.inl"
#include "narrow_clip.inl"
#include "narrow_hull.inl"
#include "narrow_box.inl"
#include "narrow_capsule_box.inl"
#include "narrow_core.inl"
#include "narrow_gjk.inl"
#include "narrow_epa.inl"
#include "narrow_face.inl"
#include "narrow_convex.inl"

// Shapes in the order of their kinds; the normal points from a to b.
PC_FN void pc_narrow_ordered(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(uint) hint,
                             PC_INOUT(NarrowManifold) m) {
  m.normal = Vec3(PC_REAL(0.0), PC_REAL(1.0), PC_REAL(0.0));
  m.count = 0u;
  if (a.kind == PC_SPHERE) {
    if (b.kind == PC_SPHERE) {
      pc_sphere_sphere(a, b, margin, m);
      return;
    }
    if (b.kind == PC_CAPSULE) {
      pc_sphere_capsule(a, b, margin, m);
      return;
    }
    if (b.kind == PC_BOX) {
      pc_sphere_box(a, b, margin, m);
      return;
    }
    if (b.kind == PC_CYLINDER) {
      pc_sphere_cylinder(a, b, margin, m);
      return;
    }
    if (b.kind == PC_PLANE) {
      pc_sphere_plane(a, b, margin, m);
      return;
    }
  }
  if (b.kind == PC_PLANE) {
    if (a.kind == PC_CAPSULE) {
      pc_capsule_plane(a, b, margin, m);
      return;
    }
    if (a.kind == PC_BOX) {
      pc_box_plane(a, b, margin, m);
      return;
    }
    if (a.kind == PC_CYLINDER) {
      pc_cylinder_plane(a, b, margin, m);
      return;
    }
    if (a.kind == PC_HULL) {
      pc_hull_plane(a, b, margin, m);
      return;
    }
    return;  // two planes never meet: only fixed bodies have them
  }
  if (b.kind == PC_CAPSULE) {
    pc_capsule_capsule(a, b, margin, m);
    return;
  }
  if (b.kind == PC_BOX) {
    if (a.kind == PC_CAPSULE) {
      pc_capsule_box(a, b, margin, m);
      return;
    }
    if (pc_box_box(a, b, margin, hint, m)) return;
    m.count = 0u;
    hint = 0u;
  }
  pc_convex(a, b, margin, hint, m);
}

PC_FN void pc_narrow(NarrowShape a, NarrowShape b, Real margin, PC_INOUT(uint) hint, PC_INOUT(NarrowManifold) m) {
  if (a.kind <= b.kind) {
    pc_narrow_ordered(a, b, margin, hint, m);
    return;
  }
  pc_narrow_ordered(b, a, margin, hint, m);
  m.normal = pc_negate(m.normal);
}
