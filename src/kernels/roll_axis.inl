// 1 + cosine of 154 degrees: axes that point further apart have no mean to roll about.
#define PC_LEAST_COSINE_SUM PC_REAL(0.1)
// About which the roll between two frames grows, from their x axes.
PC_FN Vec3 pc_roll_axis(Vec3 xa, Vec3 xb) {
  precise Real cosine_sum = pc_dot(xa, xb) + PC_REAL(1.0);
  return pc_scale(pc_add(xa, xb), pc_div(PC_REAL(1.0), pc_max(cosine_sum, PC_LEAST_COSINE_SUM)));
}
