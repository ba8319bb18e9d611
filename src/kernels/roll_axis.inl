// About which the roll between two frames grows, from their x axes.
PC_FN Vec3 pc_roll_axis(Vec3 xa, Vec3 xb) {
  precise Real cosine_sum = pc_dot(xa, xb) + PC_REAL(1.0);
  return pc_scale(pc_add(xa, xb), pc_div(PC_REAL(1.0), pc_max(cosine_sum, PC_REAL(0.1))));
}
