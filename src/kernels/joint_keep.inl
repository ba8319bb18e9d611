// End of a step of an island with shorter sub-steps than the world's:
// joints remember the impulses of the world's sub-step.
#include "remembered.inl"

PC_FN void pc_kernel(PC_IO Slot m) { pc_rescale_joint(PC_PASS PC_ORDER(joint_order, m)); }
