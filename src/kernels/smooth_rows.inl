// What a tree of fourth order keeps of a node beside what tree_rows.inl names: in the places of angle rows, which such trees do
// not have.
#include "tree_rows.inl"
const uint SMOOTH_ANCHOR = 9u;      // of the pin, in the body
const uint SMOOTH_UP_ANCHOR = 12u;  // in the parent
const uint SMOOTH_MOMENTS = 15u;    // principal moments, in units of the tree's mass
const uint SMOOTH_FORCE = 18u;
const uint SMOOTH_TORQUE = 21u;
const uint SMOOTH_U = 24u;          // velocities of the stage
const uint SMOOTH_L = 27u;
const uint SMOOTH_CHANGE = 30u;     // 4: what the stage changes in the orientation
