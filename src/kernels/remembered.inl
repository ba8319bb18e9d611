// Impulses that a joint remembers are of one sub-step: they scale with it.
PC_FN void pc_rescale_joint(PC_IO Index joint) {
  Quad pin = PC_GATHER(joint_impulse, joint, 0u);
  Quad angle = PC_GATHER(joint_impulse, joint, 1u);
  PC_SCATTER(joint_impulse, joint, 0u, pc_quad(pc_scale(pin.v, PC_INFO(impulse_ratio)), pin.s));
  PC_SCATTER(joint_impulse, joint, 1u, pc_quad(pc_scale(angle.v, PC_INFO(impulse_ratio)), angle.s));
}
