// Where the sub-step will take the bodies of a tree, and what that leaves for its pins to undo.
#include "free_rotation.inl"
#include "roll_axis.inl"

// How much of the sub-step a body is seen ahead: until it has turned by `most` [rad]. Rates of what comes later are
// those of until then.
PC_FN Real pc_seen_ahead(PC_IO Vec3 spin, Real most) {
  precise Real turn = pc_length(spin) * PC_INFO(h);
  return pc_share_within(turn, most);
}
// The turn of a node in the sub-step.
PC_FN Quaternion pc_turn_of(PC_IO Slot n) {
  precise Real w = PC_LD(tree_rows, n, TREE_TURN + 3u) + PC_REAL(1.0);
  return pc_quaternion(pc_ld3_tree(PC_PASS n, TREE_TURN), w);
}
// How fast an arm of a node moves until then, as a mean.
PC_FN Vec3 pc_swing_rate(PC_IO Slot n, Vec3 arm, Real most) {
  precise Real rate =
      PC_INFO(inverse_h) * pc_inverse_or_zero(pc_seen_ahead(PC_PASS pc_ld3_tree(PC_PASS n, TREE_X + 3u), most));
  return pc_scale(pc_swing(pc_turn_of(PC_PASS n), arm), rate);
}

// An arm halfway through the sub-step.
PC_FN Vec3 pc_halfway(PC_IO Slot n, Vec3 arm) {
  Vec3 v = pc_ld3_tree(PC_PASS n, TREE_TURN);
  precise Real w = PC_LD(tree_rows, n, TREE_TURN + 3u) + PC_REAL(2.0);
  precise Real squared = pc_dot(v, v) + w * w;
  Real share = pc_div(PC_REAL(1.0), pc_sqrt(squared));
  precise Real half_w = w * share;
  return pc_rotate(pc_quaternion(pc_scale(v, share), half_w), arm);
}
// How a body turns over what is seen of the sub-step, as a mean: its spin changes as it turns.
PC_FN Vec3 pc_mean_turn(PC_IO Slot n) {
  Vec3 v = pc_ld3_tree(PC_PASS n, TREE_TURN);
  precise Real w = PC_LD(tree_rows, n, TREE_TURN + 3u) + PC_REAL(1.0);
  Real sine = pc_length(v);
  precise Real both = pc_angle(sine, w) * pc_inverse_or_zero(sine) * PC_REAL(2.0) * PC_INFO(inverse_h);
  return pc_scale(v, both);
}
// An angle row over the sub-step: its axis as it is halfway, and the mean rate of its slack. Along that axis a limb
// keeps its angle, where along that of now it would leave the rim of a cone on a tangent; and an impulse along it makes
// no energy. All is as of now where the limit is out of reach of all turning (as it is in most joints), where a body
// turns further than is seen, and where the axis turns by more than 60 degrees till then.
// `turn`: the relative angular velocity.
struct Ahead {
  Vec3 axis;
  Real rate;
};
PC_FN Ahead pc_row_ahead(PC_IO Slot n, Slot up, uint i, Vec3 turn, Real most) {
  Vec3 now = pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u);
  Ahead r;
  r.axis = now;
  r.rate = pc_dot(now, turn);
  Real kind = PC_LD(tree_rows, n, TREE_KIND + i);
  Mask is_limit = pc_and(kind > PC_REAL(0.5), kind < PC_REAL(2.0));
  precise Real gap_rate = pc_max(PC_LD(tree_rows, n, TREE_SLACK + i), PC_REAL(0.0)) * PC_INFO(inverse_h);
  precise Real out_of_reach = gap_rate * gap_rate;
  Vec3 inner = pc_ld3_tree(PC_PASS n, TREE_CONE);
  Mask is_cone = pc_and(pc_nonzero(pc_dot(inner, inner)), PC_LD(tree_rows, n, TREE_PIVOT) < PC_REAL(0.5));
  Mask wanted = pc_and(pc_and(is_limit, is_cone), pc_dot(turn, turn) > out_of_reach);
  if (!PC_ANY(wanted)) return r;  // lint: allow (as it is otherwise)
  Real seen = pc_min(pc_seen_ahead(PC_PASS pc_ld3_tree(PC_PASS n, TREE_X + 3u), most),
                     pc_seen_ahead(PC_PASS pc_ld3_tree(PC_PASS up, TREE_X + 3u), most));
  inner = pc_halfway(PC_PASS n, inner);
  Vec3 outer = pc_halfway(PC_PASS up, pc_ld3_tree(PC_PASS n, TREE_CONE + 3u));
  Vec3 axis = pc_unit_or_zero(pc_cross(outer, inner));
  if (i == 0u) axis = pc_roll_axis(outer, inner);
  Real along = pc_dot(now, axis);
  axis = pc_select3(along < PC_REAL(0.0), pc_negate(axis), axis);
  precise Real least = pc_length(now) * pc_length(axis) * PC_REAL(0.5);
  Mask holds = pc_and(wanted, pc_abs(along) > least);
  Real mean = pc_dot(axis, pc_sub(pc_mean_turn(PC_PASS n), pc_mean_turn(PC_PASS up)));
  Mask unseen = seen < PC_REAL(1.0);
  r.axis = pc_select3(unseen, now, pc_select3(holds, axis, now));
  r.rate = pc_select(unseen, r.rate, pc_select(holds, mean, r.rate));
  return r;
}
// Rate of an angle row's slack over the sub-step, once its axis is that of where the sub-step was foreseen to go first.
// What has changed since is seen so far that the limit is left no faster than it was come to: impulses are along the
// axis of then.
PC_FN Real pc_row_rate(PC_IO Slot n, Slot up, uint i, Vec3 turn, Real most) {
  Real now = pc_dot(pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u), turn);
  precise Real back = now + pc_min(now, PC_LD(tree_rows, n, TREE_APPROACH + i));
  return pc_max(pc_row_ahead(PC_PASS n, up, i, turn, most).rate, back);
}

// In the lanes that want it, right-hand sides of the pins at the predicted pose:
// rate at which the gap changes over the sub-step.
PC_FN void pc_tree_predict(PC_IO Slot m, Tree t, Mask wanted, Real most) {
  Real h = PC_INFO(h);
  PC_MEET;
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k);
    BodyState b = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u));
    Quaternion q = pc_quaternion(pc_ld3_tree(PC_PASS n, TREE_FACING), PC_LD(tree_rows, n, TREE_FACING + 3u));
    Quad moments = pc_quad(pc_ld3_tree(PC_PASS n, TREE_MOMENTS), PC_LD(tree_rows, n, TREE_MOMENTS + 3u));
    precise Real time = h * pc_seen_ahead(PC_PASS pc_angular_velocity(b), most);
    Quaternion turn = pc_quaternion(pc_zero3(), PC_REAL(0.0));
    precise Real spin = pc_abs(b.l.x) + pc_abs(b.l.y) + pc_abs(b.l.z);
    Mask turns = pc_nonzero(spin);
    if (PC_ANY(turns)) {  // lint: allow (other lanes keep what they have)
      Quaternion spun = pc_quaternion_mul(pc_free_rotation(q, b.l, moments, time), pc_conjugate(q));
      turn = pc_quaternion(pc_select3(turns, spun.v, turn.v), pc_select(turns, spun.w, turn.w));
    }
    pc_st3_tree(PC_PASS n, TREE_TURN, pc_select3(wanted, turn.v, pc_ld3_tree(PC_PASS n, TREE_TURN)));
    PC_ST(tree_rows, n, TREE_TURN + 3u, pc_select(wanted, turn.w, PC_LD(tree_rows, n, TREE_TURN + 3u)));
    pc_st6_tree(PC_PASS n, TREE_X, pc_six(b.v, pc_angular_velocity(b)));
  }
}
// Of a body that turns about its pin the gap's rate of now: it keeps none over the sub-step. What is rounding stays:
// undoing it would round the velocities once more.
PC_FN void pc_pivot_residual(PC_IO Slot m, Tree t) {
  Slot n = PC_NODE(m, t.first + 1u);
  BodyState b = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u));
  Vec3 w = pc_angular_velocity(b);
  Slot up = PC_NODE(m, t.first);
  pc_st6_tree(PC_PASS up, TREE_X, pc_six(pc_zero3(), pc_zero3()));
  pc_st6_tree(PC_PASS n, TREE_X, pc_six(b.v, w));
  Vec3 c = pc_add(b.v, pc_cross(w, pc_ld3_tree(PC_PASS n, TREE_RC)));
  precise Real noise = pc_length(b.v) * PC_INFO(rounding);
  pc_st3_tree(PC_PASS n, TREE_C, pc_select3(pc_length(c) > noise, c, pc_zero3()));
}
// Bodies seen ahead until they have turned by `most` [rad].
PC_FN void pc_tree_residual_to(PC_IO Slot m, Tree t, Real wanted, Real most) {
  if (pc_is_pivot(PC_PASS t) == 1u) {
    PC_MEET;
    PC_ONE pc_pivot_residual(PC_PASS m, t);
    PC_MEET;
    return;
  }
  pc_tree_predict(PC_PASS m, t, wanted > PC_REAL(0.5), most);
  PC_MEET;
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k);
    Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    Vec3 moved = pc_sub(pc_swing_rate(PC_PASS n, pc_ld3_tree(PC_PASS n, TREE_RC), most),
                        pc_swing_rate(PC_PASS up, pc_ld3_tree(PC_PASS n, TREE_RP), most));
    precise Vec3 c = (pc_ld3_tree(PC_PASS n, TREE_X) - pc_ld3_tree(PC_PASS up, TREE_X)) + moved;
    pc_st3_tree(PC_PASS n, TREE_C, c);
  }
}
// Until they have turned by a radian.
PC_FN void pc_tree_residual(PC_IO Slot m, Tree t, Real wanted) {
  pc_tree_residual_to(PC_PASS m, t, wanted, PC_REAL(1.0));
}
