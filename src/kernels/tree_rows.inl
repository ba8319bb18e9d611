// What the tree solve keeps of a node: a body, and the joint to its parent (docs/joints.md). Nodes of a tree stand one
// after the other, parents before children; node 0 is the root, of which only the fields of a body are used.
#include "tree_math.inl"
#include "tree_shape.inl"

const uint TREE_RC = 0u;    // arm from the body's centre to the pin, start of the sub-step
const uint TREE_RP = 3u;    // the same of the parent
const uint TREE_GAP = 6u;   // pin of the body minus pin of the parent
const uint TREE_AXIS = 9u;  // three axes: the slack of row i grows with axis_i . (w - w_parent)
const uint TREE_SLACK = 18u;
const uint TREE_SIGN = 21u;    // +1 at a lower limit, -1 at an upper one
const uint TREE_KIND = 24u;    // 0 no row (or one that pivot_turn has), 1 a limit, 2 locked
const uint TREE_ON = 27u;      // 1 where the row acts
const uint TREE_SPRING = 30u;  // its stiffness in impulse per velocity
const uint TREE_RATE = 33u;    // rate of slack that it undoes
const uint TREE_C = 36u;       // right-hand side of the pin
// impulses, collected on the way up; of a node that has passed them on,
// those that push its joint in place of the torque
const uint TREE_F = 39u;
const uint TREE_X = 45u;          // change of the velocities
const uint TREE_H = 51u;          // articulated inertia, 21; of the root its inverse
const uint TREE_A = 72u;          // inertia as the parent sees it: linear 6, mixed 9
const uint TREE_D = 87u;          // factor of the inverse inertia of the joint's freedom (pc_inverse_factor)
const uint TREE_W = 93u;          // six rows U D^-1
const uint TREE_PIN = 111u;       // impulse of the pin on the body
const uint TREE_PUSH = 114u;      // that of a later sweep
const uint TREE_CHANGE = 117u;    // change of the angular momentum
const uint TREE_KEPT_PIN = 120u;  // impulse of the pin before Newton's steps (tree_trust.inl)
const uint TREE_MASS = 123u;      // 0 for a fixed root
const uint TREE_INERTIA = 124u;   // world axes, with the geometric stiffness
const uint TREE_TURN = 130u;      // where the sub-step will turn the body: vector and w - 1
const uint TREE_LIMIT = 134u;     // impulses of the three angle rows, in the joint's sense
const uint TREE_FACING = 138u;    // orientation
const uint TREE_MOMENTS = 142u;   // inverse principal moments, and which is the middle one
const uint TREE_BODY = 146u;      // inertia, world axes
const uint TREE_FAST = 137u;      // share of the body's turning that the sub-step is too long to resolve, 0 to 1
const uint TREE_TOTAL = 152u;     // mass of the whole tree, the unit of all masses, inertias and impulses here
const uint TREE_HAS_ROWS = 153u;  // 1 where the joint has angle rows, 2 where its limits throw back
const uint TREE_TOUCH = 154u;     // largest load of a contact on the body in this sub-step
const uint TREE_PLACE = 156u;     // centre of mass, seen from the root's
const uint TREE_OUTSIDE = 159u;   // impulses that are not the joints': of contacts, and what damps
const uint TREE_PIVOT = 155u;  // 1 where the body alone hangs on a fixed one and turns about its pin (pivot_turn.inl)
// where limits throw back, of the three rows: restitution (below 0 where the joint leans on the limit), then the rate
// at which the row is to be left; 0 none
const uint TREE_REBOUND = 165u;
// of a free root, whose joint has no rows: the tree as one rigid body (tree_whole.inl)
const uint TREE_CENTRE = TREE_AXIS;    // centre of mass, seen from the root's
const uint TREE_ALL = TREE_AXIS + 3u;  // inverse mass
const uint TREE_RIGID = TREE_SLACK;    // inverse inertia about the centre, 6
// twice that of the motion before the solve, where a limit throws back (tree_rebound.inl)
const uint TREE_ENERGY = TREE_REBOUND;
// what contacts see, from tree_respond to the end of the sub-step: roots of the joint's D^-1 and of the root's H^-1
// (node_operator.inl), and W
const uint TREE_FACTOR = 168u;  // 6
// of a joint with a cone: the axis within it, on the body and on its parent; else 0
const uint TREE_CONE = 174u;
// of a root: what the push has from outside, as an impulse and a moment about its centre
const uint TREE_PUSHED = TREE_CONE;
const uint TREE_APPROACH = 180u;  // of the three rows: the rate at which the limit is come to, or 0
const uint TREE_SPAN = 183u;      // and how far it is from one limit to the other; of a cone, across it
// change of velocity that closes gaps and undoes overlaps, taken back in the relax phase
const uint TREE_PUSH_SPEED = 186u;
const uint TREE_PUSH_TURN = 189u;      // that of the angular momentum
const uint TREE_SEEN = TREE_H;         // 18, where the factor was made anew after them
const uint TREE_ANEW = TREE_ON;        // of the root: 1 where it was
const uint TREE_ROOT_FACTOR = TREE_D;  // 21; a root has no joint

PC_FN Vec3 pc_ld3_tree(PC_IO Slot n, uint f) {
  return Vec3(PC_LD(tree_rows, n, f), PC_LD(tree_rows, n, f + 1u), PC_LD(tree_rows, n, f + 2u));
}
PC_FN Six pc_ld6_tree(PC_IO Slot n, uint f) {
  return pc_six(pc_ld3_tree(PC_PASS n, f), pc_ld3_tree(PC_PASS n, f + 3u));
}
PC_FN Sym3 pc_lds_tree(PC_IO Slot n, uint f) {
  return pc_sym3(PC_LD(tree_rows, n, f), PC_LD(tree_rows, n, f + 1u), PC_LD(tree_rows, n, f + 2u),
                 PC_LD(tree_rows, n, f + 3u), PC_LD(tree_rows, n, f + 4u), PC_LD(tree_rows, n, f + 5u));
}
PC_FN Mat3 pc_ldm_tree(PC_IO Slot n, uint f) {
  return pc_mat3(pc_ld3_tree(PC_PASS n, f), pc_ld3_tree(PC_PASS n, f + 3u), pc_ld3_tree(PC_PASS n, f + 6u));
}
PC_FN Sym6 pc_ldh_tree(PC_IO Slot n, uint f) {
  return pc_sym6(pc_lds_tree(PC_PASS n, f), pc_ldm_tree(PC_PASS n, f + 6u), pc_lds_tree(PC_PASS n, f + 15u));
}
// W^T times a motion, with the six rows of W at w (tree_sweep.inl).
PC_FN Vec3 pc_w_tmul(PC_IO Slot n, uint w, Six a) {
  Vec3 l = pc_combine(pc_ld3_tree(PC_PASS n, w), a.l.x, pc_ld3_tree(PC_PASS n, w + 3u), a.l.y,
                      pc_ld3_tree(PC_PASS n, w + 6u), a.l.z);
  Vec3 r = pc_combine(pc_ld3_tree(PC_PASS n, w + 9u), a.a.x, pc_ld3_tree(PC_PASS n, w + 12u), a.a.y,
                      pc_ld3_tree(PC_PASS n, w + 15u), a.a.z);
  return pc_add(l, r);
}
// Whether any lane's joint has angle rows. Skipping them changes no bit: where there are none they are zeros.
PC_FN Mask pc_has_rows(PC_IO Slot n) { return PC_LD(tree_rows, n, TREE_HAS_ROWS) > PC_REAL(0.5); }
// TREE_RATE of row i, once the joint turns by `turn` faster.
PC_FN Real pc_rate_after(PC_IO Slot n, uint i, Vec3 turn) {
  precise Real rate = PC_LD(tree_rows, n, TREE_RATE + i) + pc_dot(pc_ld3_tree(PC_PASS n, TREE_AXIS + i * 3u), turn);
  return rate;
}
// [rad/s]
#define PC_CROSSING_RATE PC_REAL(0.05)
// Whether a limit is crossed at more than rounding.
PC_FN Mask pc_is_crossed(Real rate) { return rate < -PC_CROSSING_RATE; }
// Whether it is a limit that does not act.
PC_FN Mask pc_waits(PC_IO Slot n, uint i) {
  Real kind = PC_LD(tree_rows, n, TREE_KIND + i);
  Mask is_limit = pc_and(kind > PC_REAL(0.5), kind < PC_REAL(2.0));
  return pc_and(is_limit, PC_LD(tree_rows, n, TREE_ON + i) < PC_REAL(0.5));
}
// Whether it waits and is crossed, once the joint turns by `turn` faster.
PC_FN Mask pc_enters(PC_IO Slot n, uint i, Vec3 turn) {
  return pc_and(pc_waits(PC_PASS n, i), pc_is_crossed(pc_rate_after(PC_PASS n, i, turn)));
}
// Whether any lane's joint has limits with a restitution: TREE_REBOUND holds something there alone.
PC_FN Mask pc_throws_back(PC_IO Slot n) { return PC_LD(tree_rows, n, TREE_HAS_ROWS) > PC_REAL(1.0); }
