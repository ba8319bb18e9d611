// What a tree of fourth order keeps of a node beside what tree_rows.inl names, in places that such trees do not need.
#include "tree_rows.inl"
const uint SMOOTH_ANCHOR = 9u;      // of the pin, in the body
const uint SMOOTH_UP_ANCHOR = 12u;  // in the parent
const uint SMOOTH_MOMENTS = 15u;    // principal moments, in units of the tree's mass
const uint SMOOTH_FORCE = 18u;
const uint SMOOTH_TORQUE = 21u;
const uint SMOOTH_START = 24u;         // angular momentum at the sub-step's start
const uint SMOOTH_L = 27u;             // that of the stage
const uint SMOOTH_L_SUM = 30u;         // weighted sums over the stages, of what they change in the momentum
const uint SMOOTH_TURN_SUM = 33u;      // in the turn
const uint SMOOTH_V_SUM = 134u;        // in the root's velocity
const uint SMOOTH_WAY_SUM = 120u;      // and in its way; at the end how far a body moves
const uint SMOOTH_W = TREE_BODY;       // angular velocity of the stage
const uint SMOOTH_V = TREE_BODY + 3u;  // velocity at the sub-step's start; at the end that of its end
const uint SMOOTH_V_LOW = 6u;          // what rounding dropped from it
const uint SMOOTH_L_LOW = 156u;        // and from the momentum
const uint SMOOTH_TURN = 130u;         // of the stage, since the start, as a vector
