// joint_warm with bodies of trees: what lasts goes into the solve of the tree (tree_collect), as it would answer it.
//
// That is the angle rows' couple. Of a pin nothing lasts: its one visit solves it, and where many of them close loops
// in one tree, what each pushed in the sub-step before is more than the visits take back (nets gained 200 times the
// energy of their fall).
#include "tree_math.inl"
#include "joint_way.inl"
#include "node_push.inl"
#include "body_push.inl"
#include "joint_rows.inl"

PC_FN void pc_kernel(PC_IO Slot m) {
  Way w = pc_way(PC_PASS m);
  Index ia = PC_WAY_EACH(m, pc_entry(w, PATH_BODY));
  Index ib = PC_WAY_EACH(m, pc_entry(w, PATH_BODY + 1u));
  Index joint = PC_ORDER(joint_order, m);
  BodyState a = pc_body_state(PC_PASS ia);
  BodyState b = pc_body_state(PC_PASS ib);
  Vec3 couple = pc_snap3(pc_lasting_couple(PC_PASS m, PC_GATHER(joint_impulse, joint, 1u)));
  Mask tree_a = pc_in_tree(PC_PASS w, m, 0u);
  Mask tree_b = pc_in_tree(PC_PASS w, m, 1u);
  pc_apply_free(PC_PASS ia, ib, a, b, tree_a, tree_b, pc_zero3(), couple, couple);
  pc_note_push(PC_PASS w, m, 0u, tree_a, pc_six(pc_zero3(), pc_negate(couple)), PC_REAL(0.0));
  pc_note_push(PC_PASS w, m, 1u, tree_b, pc_six(pc_zero3(), couple), PC_REAL(0.0));
  PC_SCATTER(joint_impulse, joint, 0u, pc_quad(pc_zero3(), PC_REAL(0.0)));
}
