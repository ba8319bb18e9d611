// Before a sub-step's forces, where a joint of a tree has a motor or a spring: how its bodies turn, and whether the
// velocity of one was just set and is in phase with the position (drive_terms.inl).
#include "tree_math.inl"
#include "tree_shape.inl"
#include "tree_drive_rows.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Index body = PC_ENDS(tree_ends, n, 0u);
    Quad turned = PC_GATHER(pose, body, 1u);
    Quad inverse = PC_GATHER(mass, body, 1u);
    Quad linear = PC_GATHER(motion, body, 0u);
    Quad angular = PC_GATHER(motion, body, 1u);
    pc_st3_drive(PC_PASS n, DRIVE_SPIN,
                 pc_sym_mul(pc_world_inertia(pc_quaternion(turned.v, turned.s), inverse.v), angular.v));
    Mask fresh = pc_and(angular.s<PC_REAL(0.0), linear.s> PC_REAL(0.0));
    PC_ST(tree_drive_rows, n, DRIVE_FRESH, pc_select(fresh, PC_REAL(1.0), PC_REAL(0.0)));
  }
}
