// Everything here is allowed: no finding may be reported.
PC_KERNEL(integrate, body, integrate, PC_READ(pose) PC_WRITE(motion))
PC_PROPERTY(body, material, 0, real, friction, input, 0.5, "1", "a + b * c / 2.0")
const uint PC_ROW = 4u;
const uint PC_NEXT = PC_ROW * 2u + 1u;
#define PC_HALF PC_REAL(0.5)
#define PC_LAST (PC_ROW + 3u)
struct Item {
  Vec3 v;
  Real s;
  uint count;
};

PC_FN Vec3 pc_sum(Vec3 a, Vec3 b, Real s) {
  precise Vec3 r = a + b * s;
  return r;
}
PC_FN uint pc_place(uint i, uint width) { return (i / width) * PC_ROW + i % width; }
PC_FN void pc_item(PC_IO Slot m, PC_INOUT(Item) item, Real h) {
  for (uint k = 0u; k < 6u; k++) {
    uint next = k + 1u;
    item.count = item.count + next;
    item.count += 2u;
  }
  precise Real x = -item.s * h + PC_LD(rows, PC_ROW, m, PC_LAST - 1u), y = PC_HALF * h;
  precise Vec3 turned = Vec3(item.v.x * h, -item.v.y, item.v.z - y);
  if (item.count + 1u > pc_place(3u, 2u)) {
    PC_ST(rows, PC_ROW, m, PC_ROW + 2u, -x);
  }
  Real positive = pc_select(x > PC_REAL(-1.0), x, -y);
  item.v = pc_sum(turned, Vec3(-positive, y, PC_REAL(1.0 / 2.0)), x);  // a * b in a comment / is fine
  Real odd = x * y;                                                    // lint: allow (a sample of an exception)
  // lint: allow (the same, on the line above)
  item.s = odd + x;
}
