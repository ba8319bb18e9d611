// The row of a contact manifold while it is solved, and how an impulse acts.
//
// A manifold is solved in its contact frame (t1, t2, n) at its centre: the two bodies give one relative
// twist (V, W), point i sees V_n + b_i W_1 - a_i W_2, with (a_i, b_i) its place in the contact plane. The
// responses between rows are computed once a step; each body is read and written once per visit.
// Friction acts at the centre: a 2 x 2 block with a circular clamp, and a twist about the normal.
const uint ROW_N = 0u;      // normal, a to b
const uint ROW_T = 3u;      // first tangent; the second is n x t1
const uint ROW_ARM_A = 6u;  // from each centre of mass to the manifold's centre, as found
const uint ROW_ARM_B = 9u;
const uint ROW_A = 12u;      // a_i along t1
const uint ROW_B = 16u;      // b_i along t2
const uint ROW_S = 20u;      // separation at the start of the step
const uint ROW_MASS = 24u;   // effective mass of each normal row
const uint ROW_D = 28u;      // response of normal row j to normal row i: 01 02 03 12 13 23
const uint ROW_E = 34u;      // restitution
const uint ROW_SHARE = 35u;  // of body a in what the arms must shift by, see pc_arms
// below 0: relative normal velocity of each point at the start of the step; above: impulses of contact_impact
const uint ROW_APPROACH = 36u;
// smallest response of the three directions at the centre; 0: contact_solve leaves this one alone
const uint ROW_K = 40u;
// 1 where its rows are visited, 2 where in this sub-step joints have sent its shapes together,
// 4 where in this sub-step its shapes have met in flight, 0 where they are left alone for now
const uint ROW_ACTS = 41u;
#define ACTS_MET PC_REAL(4.0)
// the same place until contact_warm, where shapes meet in flight: when in this sub-step they did; 0 before
const uint ROW_MET = 41u;
// contact_impact's: below 0 none of it (-1: a body hangs on joints, -2: it acts no longer),
// 0 where it bounces, above 0 always
const uint ROW_IMPACT = 42u;
const uint ROW_PATH = 43u;  // b's way against a since the step began, when the rows were found: arms are of there
#ifndef PC_FRICTIONLESS     // what follows is friction's: where nothing has any, rows end here (frictionless_rows)
const uint ROW_MU_STATIC = 46u;
const uint ROW_MU_KINETIC = 47u;
const uint ROW_TT = 48u;      // inverse of the friction block: 11 12 22
const uint ROW_KW = 51u;      // response of the twist to friction 1, 2
const uint ROW_TWIST = 53u;   // effective mass of the twist
const uint ROW_C = 54u;       // response of V_n, W_1, W_2 to friction 1, 2 and twist
const uint ROW_RADIUS = 63u;  // lever of the twist friction: root mean square distance of the points
#endif
// impulses: normal 0..3, friction 4 5, twist 6, load of the sub-step before 7,
// largest normal impulses of the step 8..11
#ifdef PC_FRICTIONLESS
const uint IMPULSES = 4u;
#else
const uint IMPULSES = 7u;
#endif
const uint IMPULSE_T = 4u;
const uint IMPULSE_BEFORE = 7u;
const uint IMPULSE_LARGEST = 8u;
const uint IMPULSE_LAST = 12u;  // normal impulses as they lasted in the sub-step before

// Whether they push at all: those of shapes that are apart, or that an impact has to itself, do not.
PC_FN Mask pc_pushes(PC_IO Slot m) { return PC_LD(contact_rows, m, ROW_K) > PC_REAL(0.0); }
// The largest effective mass of its points but the first: 0 where there is one point.
PC_FN Real pc_mass_of_others(PC_IO Slot m) {
  return pc_max(PC_LD(contact_rows, m, ROW_MASS + 1u),
                pc_max(PC_LD(contact_rows, m, ROW_MASS + 2u), PC_LD(contact_rows, m, ROW_MASS + 3u)));
}
PC_FN Vec3 pc_ld3_rows(PC_IO Slot m, uint f) {
  return Vec3(PC_LD(contact_rows, m, f), PC_LD(contact_rows, m, f + 1u), PC_LD(contact_rows, m, f + 2u));
}
