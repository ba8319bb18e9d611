// Where the sub-step will take the bodies of a tree, and what that leaves for its pins to undo.
#include "free_rotation.inl"
#include "tree_swing.inl"

// How much of the sub-step a body is seen ahead: until it has turned by `most` [rad]. Rates of what comes later are those of until then.
PC_FN Real pc_seen_ahead(PC_IO Vec3 spin, Real most) {
  precise Real turn = pc_length(spin) * PC_INFO(h);
  return pc_share_within(turn, most);
}
// How fast an arm of a node moves until then, as a mean.
PC_FN Vec3 pc_swing_rate(PC_IO Slot n, Vec3 arm, Real most) {
  precise Real rate = PC_INFO(inverse_h) * pc_inverse_or_zero(pc_seen_ahead(PC_PASS pc_ld3_tree(PC_PASS n, TREE_X + 3u), most));
  return pc_scale(pc_swing(PC_PASS n, arm), rate);
}

// How fast the angle of a cone grows until the foreseen pose, as a mean. (What moves along a cone's rim leaves it on a tangent: by its rate of now
// it would go beyond the limit in each sub-step.) `holds`: the axis about which it grows turns by less than 60 degrees till then.
struct ConeRate { Real mean; Mask holds; };
PC_FN ConeRate pc_cone_rate(PC_IO Slot n, Slot up) {
  Vec3 inner = pc_ld3_tree(PC_PASS n, TREE_CONE);
  Vec3 outer = pc_ld3_tree(PC_PASS n, TREE_CONE + 3u);
  Vec3 inner_moves = pc_swing(PC_PASS n, inner);
  Vec3 outer_moves = pc_swing(PC_PASS up, outer);
  precise Real cosine_grows = pc_dot(outer_moves, inner) + pc_dot(outer, inner_moves) + pc_dot(outer_moves, inner_moves);
  Vec3 axis = pc_cross(outer, inner);
  Vec3 axis_there = pc_cross(pc_add(outer, outer_moves), pc_add(inner, inner_moves));
  Real sine = pc_length(axis);
  Real sine_there = pc_length(axis_there);
  precise Real sines = sine + sine_there;
  // the tangent of half of what the angle grows by
  precise Real size = pc_angle(pc_abs(cosine_grows), sines) * PC_REAL(2.0) * PC_INFO(inverse_h);
  precise Real half_of_both = sine * sine_there * PC_REAL(0.5);
  ConeRate rate;
  rate.mean = pc_select(cosine_grows < PC_REAL(0.0), size, -size);
  rate.holds = pc_dot(axis, axis_there) > half_of_both;
  return rate;
}
// Rate of an angle row's slack until the foreseen pose, where both bodies are seen that far; else of now. `turn`: the relative angular velocity.
PC_FN Real pc_row_rate(PC_IO Slot n, Slot up, uint i, Vec3 turn, Real most) {
  Real now = pc_dot(pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u), turn);
  if (i != 1u) return now;  // a cone's angle is the second row
  Real kind = PC_LD(tree_rows, n, TREE_KIND + i);
  Mask is_limit = pc_and(kind > PC_REAL(0.5), kind < PC_REAL(1.5));
  // no further than the relative turning, which does not come to the limit in most joints
  precise Real gap_rate = pc_max(PC_LD(tree_rows, n, TREE_SLACK + i), PC_REAL(0.0)) * PC_INFO(inverse_h);
  precise Real out_of_reach = gap_rate * gap_rate;
  Mask reached = pc_and(is_limit, pc_dot(turn, turn) > out_of_reach);
  Vec3 inner = pc_ld3_tree(PC_PASS n, TREE_CONE);
  Mask is_cone = pc_and(reached, pc_nonzero(pc_dot(inner, inner)));
  if (!PC_ANY(is_cone)) return now;  // lint: allow (as it is otherwise)
  Real seen = pc_min(pc_seen_ahead(PC_PASS pc_ld3_tree(PC_PASS n, TREE_X + 3u), most), pc_seen_ahead(PC_PASS pc_ld3_tree(PC_PASS up, TREE_X + 3u), most));
  Mask unseen = pc_or(seen < PC_REAL(1.0), PC_LD(tree_rows, n, TREE_PIVOT) > PC_REAL(0.5));
  ConeRate cone = pc_cone_rate(PC_PASS n, up);
  precise Real rate = PC_LD(tree_rows, n, TREE_SIGN + i) * cone.mean;
  // a limit is left no faster than it was come to: what stops it makes no energy
  precise Real back = now + pc_min(now, PC_REAL(0.0));
  return pc_select(unseen, now, pc_select(pc_and(is_cone, cone.holds), pc_max(rate, back), now));
}

// In the lanes that want it, right-hand sides of the pins at the predicted pose: rate at which the gap changes over the sub-step.
PC_FN void pc_tree_predict(PC_IO Slot m, Tree t, Mask wanted, Real most) {
  Real h = PC_INFO(h);
  PC_MEET;
  PC_NODES(k, 0u, t) {
    Slot n = PC_NODE(m, t.first + k); BodyState b = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u));
    Quaternion q = pc_quaternion(pc_ld3_tree(PC_PASS n, TREE_FACING), PC_LD(tree_rows, n, TREE_FACING + 3u));
    Quad moments = pc_quad(pc_ld3_tree(PC_PASS n, TREE_MOMENTS), PC_LD(tree_rows, n, TREE_MOMENTS + 3u));
    precise Real time = h * pc_seen_ahead(PC_PASS pc_angular_velocity(b), most);
    Quaternion turn = pc_quaternion(pc_zero3(), PC_REAL(0.0)); precise Real spin = pc_abs(b.l.x) + pc_abs(b.l.y) + pc_abs(b.l.z); Mask turns = pc_nonzero(spin);
    if (PC_ANY(turns)) {  // lint: allow (other lanes keep what they have)
      Quaternion spun = pc_quaternion_mul(pc_free_rotation(q, b.l, moments, time), pc_conjugate(q)); turn = pc_quaternion(pc_select3(turns, spun.v, turn.v), pc_select(turns, spun.w, turn.w));
    }
    pc_st3_tree(PC_PASS n, TREE_TURN, pc_select3(wanted, turn.v, pc_ld3_tree(PC_PASS n, TREE_TURN))); PC_ST(tree_rows, n, TREE_TURN + 3u, pc_select(wanted, turn.w, PC_LD(tree_rows, n, TREE_TURN + 3u)));
    pc_st6_tree(PC_PASS n, TREE_X, pc_six(b.v, pc_angular_velocity(b)));
  }
}
// Of a body that turns about its pin the gap's rate of now: it keeps none over the sub-step. What is rounding stays: undoing
// it would round the velocities once more.
PC_FN void pc_pivot_residual(PC_IO Slot m, Tree t) {
  Slot n = PC_NODE(m, t.first + 1u); BodyState b = pc_body_state(PC_PASS PC_ENDS(tree_ends, n, 0u)); Vec3 w = pc_angular_velocity(b);
  Slot up = PC_NODE(m, t.first); pc_st6_tree(PC_PASS up, TREE_X, pc_six(pc_zero3(), pc_zero3()));
  pc_st6_tree(PC_PASS n, TREE_X, pc_six(b.v, w)); 
  Vec3 c = pc_add(b.v, pc_cross(w, pc_ld3_tree(PC_PASS n, TREE_RC))); precise Real noise = pc_length(b.v) * PC_INFO(rounding);
  pc_st3_tree(PC_PASS n, TREE_C, pc_select3(pc_length(c) > noise, c, pc_zero3()));
}
// Bodies seen ahead until they have turned by `most` [rad].
PC_FN void pc_tree_residual_to(PC_IO Slot m, Tree t, Real wanted, Real most) {
  if (pc_is_pivot(PC_PASS t) == 1u) { PC_MEET; PC_ONE pc_pivot_residual(PC_PASS m, t); PC_MEET; return; }
  pc_tree_predict(PC_PASS m, t, wanted > PC_REAL(0.5), most);
  PC_MEET;
  PC_NODES(k, 1u, t) {
    Slot n = PC_NODE(m, t.first + k); Slot up = PC_NODE(m, t.first + pc_parent(PC_PASS t, k));
    Vec3 moved = pc_sub(pc_swing_rate(PC_PASS n, pc_ld3_tree(PC_PASS n, TREE_RC), most), pc_swing_rate(PC_PASS up, pc_ld3_tree(PC_PASS n, TREE_RP), most));
    precise Vec3 c = (pc_ld3_tree(PC_PASS n, TREE_X) - pc_ld3_tree(PC_PASS up, TREE_X)) + moved;
    pc_st3_tree(PC_PASS n, TREE_C, c);
  }
}
// Until they have turned by a radian.
PC_FN void pc_tree_residual(PC_IO Slot m, Tree t, Real wanted) { pc_tree_residual_to(PC_PASS m, t, wanted, PC_REAL(1.0)); }
