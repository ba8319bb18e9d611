// Start of a sub-step's trees: arms, gaps, inertia, angle rows at the present pose.
#include "joint_angles.inl"
#include "angle_rows.inl"
#include "tree_rows.inl"
#include "tree_store.inl"
#include "tree_stiffness.inl"
#include "tree_gap.inl"
#include "tree_whole.inl"

// What is read of a body, once for its own joint and those of its children. In places that the factor fills later:
// position and its low part, principal moments.
const uint TREE_POSITION = TREE_H;
const uint TREE_PRINCIPAL = TREE_H + 6u;
PC_FN Quaternion pc_facing(PC_IO Slot n) {
  return pc_quaternion(pc_ld3_tree(PC_PASS n, TREE_FACING), PC_LD(tree_rows, n, TREE_FACING + 3u));
}
PC_FN void pc_tree_body(PC_IO Slot n) {
  Index body = PC_ENDS(tree_ends, n, 0u);
  Quad place = PC_GATHER(pose, body, 0u);
  Quad turned = PC_GATHER(pose, body, 1u);
  Quad low = PC_GATHER(pose, body, 2u);
  Quad moments = PC_GATHER(mass, body, 0u);
  Quad inverse = PC_GATHER(mass, body, 1u);
  pc_st3_tree(PC_PASS n, TREE_POSITION, place.v);
  pc_st3_tree(PC_PASS n, TREE_POSITION + 3u, low.v);
  pc_st3_tree(PC_PASS n, TREE_FACING, turned.v);
  PC_ST(tree_rows, n, TREE_FACING + 3u, turned.s);
  pc_st3_tree(PC_PASS n, TREE_MOMENTS, inverse.v);
  PC_ST(tree_rows, n, TREE_MOMENTS + 3u, inverse.s);
  pc_st3_tree(PC_PASS n, TREE_PRINCIPAL, moments.v);
  PC_ST(tree_rows, n, TREE_MASS, moments.s);
}

// One angle row at its nearer limit. It acts from the start where it did in the last sub-step; tree_solve adds others.
PC_FN void pc_tree_angle(PC_IO Slot n, uint row, Vec3 axis, Real flip, Real angle, Real lower, Real upper, Mask exists,
                         Real remembered) {
  NearerLimit limit = pc_nearer_limit(PC_PASS angle, lower, upper, exists);
  Mask locked = limit.locked;
  Real sign = limit.sign;
  Real slack = limit.slack;
  Real one = PC_REAL(1.0);
  Real zero = PC_REAL(0.0);
  precise Real turned = sign * flip;
  precise Real pressed = remembered * sign;
  Vec3 j = pc_select3(exists, pc_scale(axis, turned), pc_zero3());
  pc_st3_tree(PC_PASS n, TREE_AXIS + row * 3u, j);
  PC_ST(tree_rows, n, TREE_SLACK + row, pc_select(exists, slack, zero));
  PC_ST(tree_rows, n, TREE_SIGN + row, pc_select(exists, sign, zero));
  PC_ST(tree_rows, n, TREE_SPRING + row, zero);
  PC_ST(tree_rows, n, TREE_RATE + row, zero);
  PC_ST(tree_rows, n, TREE_KIND + row, pc_select(locked, PC_REAL(2.0), pc_select(exists, one, zero)));
  PC_ST(tree_rows, n, TREE_ON + row, pc_select(locked, one, pc_select(pc_and(exists, pressed > zero), one, zero)));
}

// A hinge that a body turns about comes to its limit at an instant that pivot_turn finds:
// no row acts before it is there.
PC_FN void pc_keep_for_the_turn(PC_IO Slot n, Mask is_angles) {
  Mask locked =
      pc_and(PC_LD(tree_rows, n, TREE_KIND + 1u) > PC_REAL(1.0), PC_LD(tree_rows, n, TREE_KIND + 2u) > PC_REAL(1.0));
  Mask on_its_way =
      pc_and(PC_LD(tree_rows, n, TREE_KIND) < PC_REAL(2.0), PC_LD(tree_rows, n, TREE_SLACK) > PC_INFO(rounding));
  Mask waits = pc_and(pc_and(is_angles, locked), on_its_way);
  PC_ST(tree_rows, n, TREE_KIND, pc_select(waits, PC_REAL(0.0), PC_LD(tree_rows, n, TREE_KIND)));
  PC_ST(tree_rows, n, TREE_ON, pc_select(waits, PC_REAL(0.0), PC_LD(tree_rows, n, TREE_ON)));
}

// The three angle rows of a joint; a joint without angles has three that never act.
PC_FN void pc_tree_angles(PC_IO Slot n, uint b, uint pivot, Quaternion qc, Quaternion qp, Quad axes_c, Quad axes_p,
                          Quad head, Quad lower, Quad upper, Vec3 remembered) {
  Mask any = head.s > PC_REAL(0.5);
  Mask is_cone = pc_and(any, head.s < PC_REAL(2.0));
  Mask is_angles = head.s > PC_REAL(1.0);
  Mask throws = pc_and(any, upper.s > PC_REAL(0.0));
  PC_ST(tree_rows, n, TREE_HAS_ROWS, pc_select(throws, PC_REAL(2.0), pc_select(any, PC_REAL(1.0), PC_REAL(0.0))));
  if (!PC_ANY(any)) {  // lint: allow (rows of kind 0 are the same whatever their axes)
    for (uint f = TREE_AXIS; f < TREE_C; f++) PC_ST(tree_rows, n, f, PC_REAL(0.0));
    return;
  }
  Quaternion fc = pc_quaternion_mul(qc, pc_quaternion(axes_c.v, axes_c.s));
  Quaternion fp = pc_quaternion_mul(qp, pc_quaternion(axes_p.v, axes_p.s));
  Mask flipped = PC_IS(b);
  Real flip = pc_select(flipped, PC_REAL(-1.0), PC_REAL(1.0));
  Quaternion fa;
  fa.v = pc_select3(flipped, fc.v, fp.v);
  fa.w = pc_select(flipped, fc.w, fp.w);
  Quaternion fb;
  fb.v = pc_select3(flipped, fp.v, fc.v);
  fb.w = pc_select(flipped, fp.w, fc.w);
  Angles a = pc_joint_angles(fa, fb, is_cone);
  pc_tree_angle(PC_PASS n, 0u, a.roll_axis, flip, a.value.x, lower.v.x, upper.v.x, any, remembered.x);
  pc_tree_angle(PC_PASS n, 1u, a.second_axis, flip, a.value.y, lower.v.y, upper.v.y, any, remembered.y);
  pc_tree_angle(PC_PASS n, 2u, a.third_axis, flip, a.value.z, lower.v.z, upper.v.z, is_angles, remembered.z);
  Vec3 span = pc_sub(upper.v, lower.v);
  precise Real across = upper.v.y * PC_REAL(2.0);
  span = Vec3(span.x, pc_select(is_cone, across, span.y), span.z);
  pc_st3_tree(PC_PASS n, TREE_SPAN, pc_select3(any, span, pc_zero3()));
  pc_st3_tree(PC_PASS n, TREE_CONE, pc_select3(is_cone, pc_select3(flipped, a.x_of_a, a.x_of_b), pc_zero3()));
  pc_st3_tree(PC_PASS n, TREE_CONE + 3u, pc_select3(is_cone, pc_select3(flipped, a.x_of_b, a.x_of_a), pc_zero3()));
  if (pivot == 1u) pc_keep_for_the_turn(PC_PASS n, is_angles);
  if (!PC_ANY(throws)) return;  // lint: allow (not read otherwise)
  // what leans on a limit already does not meet it, but may meet the other one
  for (uint i = 0u; i < 3u; i++)
    PC_ST(tree_rows, n, TREE_REBOUND + i,
          pc_select(PC_LD(tree_rows, n, TREE_ON + i) > PC_REAL(0.5), -upper.s, upper.s));
}

// A pin that stands open between two bodies that move acts at one point, midway: impulses at two would turn the pair.
// No further from the body's own end than its arm is long:
// the inertia of a small body is lost beside that of its mass far away.
PC_FN void pc_act_midway(PC_IO Slot n, Slot up, Vec3 rc, Vec3 rp, Vec3 gap) {
  precise Real noise = PC_INFO(rounding) * PC_INFO(rounding);
  Mask open = pc_and(pc_gap_over(PC_PASS n, gap, noise) > PC_REAL(0.5), PC_LD(tree_rows, up, TREE_MASS) > PC_REAL(0.0));
  Vec3 half_gap = pc_scale(gap, PC_REAL(0.5));
  Vec3 shift = pc_scale(half_gap, pc_share_within(pc_length(half_gap), pc_length(rc)));
  pc_st3_tree(PC_PASS n, TREE_RC, pc_select3(open, pc_sub(rc, shift), rc));
  pc_st3_tree(PC_PASS n, TREE_RP, pc_select3(open, pc_add(rp, shift), rp));
}

PC_FN void pc_tree_joint(PC_IO Tree t, Slot n, uint k) {
  Slot up = PC_NODE(n, t.first + pc_parent(PC_PASS t, k));
  Index joint = PC_ENDS(tree_ends, n, 1u);
  // quads of joint_solved: 0 of body a, 2 of body b
  uint b = pc_is_flipped(PC_PASS t, k);
  uint c_at = (1u - b) * 2u;
  uint p_at = b * 2u;
  Quad anchor_c = PC_GATHER(joint_solved, joint, c_at);
  Quad axes_c = PC_GATHER(joint_solved, joint, c_at + 1u);
  Quad anchor_p = PC_GATHER(joint_solved, joint, p_at);
  Quad axes_p = PC_GATHER(joint_solved, joint, p_at + 1u);
  Quad head = PC_GATHER(joint_solved, joint, 0u);
  Quad lower = PC_GATHER(joint_solved, joint, 4u);
  Quad upper = PC_GATHER(joint_solved, joint, 5u);
  Quad pin = PC_GATHER(joint_impulse, joint, 0u);
  Quad angle = PC_GATHER(joint_impulse, joint, 1u);
  Quaternion qc = pc_facing(PC_PASS n);
  Quaternion qp = pc_facing(PC_PASS up);
  Vec3 rc = pc_rotate(qc, anchor_c.v);
  Vec3 rp = pc_rotate(qp, anchor_p.v);
  Vec3 apart = pc_add(pc_sub(pc_ld3_tree(PC_PASS n, TREE_POSITION), pc_ld3_tree(PC_PASS up, TREE_POSITION)),
                      pc_sub(pc_ld3_tree(PC_PASS n, TREE_POSITION + 3u), pc_ld3_tree(PC_PASS up, TREE_POSITION + 3u)));
  Vec3 gap = pc_add(apart, pc_sub(rc, rp));
  pc_st3_tree(PC_PASS n, TREE_RC, rc);
  pc_st3_tree(PC_PASS n, TREE_RP, rp);
  pc_st3_tree(PC_PASS n, TREE_GAP, gap);
  pc_act_midway(PC_PASS n, up, rc, rp, gap);
  pc_st3_tree(PC_PASS n, TREE_PLACE, apart);
  pc_tree_angles(PC_PASS n, b, pc_is_pivot(PC_PASS t), qc, qp, axes_c, axes_p, head, lower, upper, angle.v);
  Real flip = pc_select(PC_IS(b), PC_REAL(-1.0), PC_REAL(1.0));

  precise Vec3 f = pin.v * flip * PC_INFO(impulse_ratio) * pc_inverse_or_zero(PC_LD(tree_rows, n, TREE_TOTAL));
  // what turns about the pin needs no stiffness of it
  pc_st3_tree(PC_PASS n, TREE_PIN, pc_select3(PC_IS(pc_is_pivot(PC_PASS t)), pc_zero3(), f));
  pc_st3_tree(PC_PASS n, TREE_LIMIT, pc_zero3());  // of a pivot that no tree is solved for
}

// A node's place, from that of its parent and how far it is from there.
PC_FN void pc_tree_place(PC_IO Slot n, Slot up) {
  pc_st3_tree(PC_PASS n, TREE_PLACE, pc_add(pc_ld3_tree(PC_PASS up, TREE_PLACE), pc_ld3_tree(PC_PASS n, TREE_PLACE)));
}

PC_FN void pc_kernel(PC_IO Slot m) {
  Tree t = pc_tree(PC_PASS m);
  PC_ONE {
    pc_st3_tree(PC_PASS PC_NODE(m, t.first), TREE_PLACE, pc_zero3());
    pc_st3_tree(PC_PASS PC_NODE(m, t.first), TREE_RC, pc_zero3());
  }
  // masses in units of the tree's: determinants stay in the range of reals whatever bodies weigh
  Real total = PC_REAL(0.0);
  PC_NODES(k, 0u, t) {
    pc_tree_body(PC_PASS PC_NODE(m, t.first + k));
    PC_THEN(PC_ALL(k, 0u, t)) precise Real sum = total + PC_LD(tree_rows, PC_NODE(m, t.first + k), TREE_MASS);
    total = sum;
  }
  PC_NODES(k, 0u, t) PC_ST(tree_rows, PC_NODE(m, t.first + k), TREE_TOTAL, total);
  Real share = pc_inverse_or_zero(total);
  PC_NODES(k, 1u, t) {
    pc_tree_joint(PC_PASS t, PC_NODE(m, t.first + k), k);
    PC_THEN(PC_DOWN(k, 1u, t))
    pc_tree_place(PC_PASS PC_NODE(m, t.first + k), PC_NODE(m, t.first + pc_parent(PC_PASS t, k)));
  }
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    precise Real own = PC_LD(tree_rows, n, TREE_MASS) * share;
    pc_sts_tree(PC_PASS n, TREE_BODY,
                pc_world_inertia(pc_facing(PC_PASS n), pc_scale(pc_ld3_tree(PC_PASS n, TREE_PRINCIPAL), share)));
    PC_ST(tree_rows, n, TREE_MASS, own);
    PC_ST(tree_rows, n, TREE_TOUCH, PC_REAL(0.0));
    pc_st6_tree(PC_PASS n, TREE_OUTSIDE, pc_six(pc_zero3(), pc_zero3()));
    pc_st3_tree(PC_PASS n, TREE_PUSH_SPEED, pc_zero3());
    pc_st3_tree(PC_PASS n, TREE_PUSH_TURN, pc_zero3());
  }
  PC_ONE pc_st6_tree(PC_PASS PC_NODE(m, t.first), TREE_PUSHED, pc_six(pc_zero3(), pc_zero3()));
  pc_tree_stiffness(PC_PASS m, t);
  pc_tree_whole(PC_PASS m, t);
  Real pivot = pc_select(PC_IS(pc_is_pivot(PC_PASS t)), PC_REAL(1.0), PC_REAL(0.0));
  PC_NODES(k, 1u, t) PC_ST(tree_rows, PC_NODE(m, t.first + k), TREE_PIVOT, pivot);
}
