// lint: allow-file (the operations whose rounding is probed)
// One invocation does every operation of interest on one pair of operands; device_probe.cpp compares.
layout(local_size_x = 64) in;
layout(std430, binding = 0) restrict readonly buffer Operands { Real4 operands[]; };
layout(std430, binding = 1) restrict writeonly buffer Results { Real4 results[]; };
uniform uint count;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  Real x = operands[i].x;
  Real y = operands[i].y;
  Real z = operands[i].z;
  Real size = abs(x);
  precise Real product = x * y;
  precise Real sum = x * y + z;
  precise Real total = x + y;
  precise Real residual = fma(x, y, -product);
  results[4u * i] = Real4(pc_div_builtin(x, y), pc_div_fma(x, y), pc_div_nearest(x, y), sum);
  results[4u * i + 1u] = Real4(pc_sqrt_builtin(size), pc_sqrt_fma(size), pc_sqrt_nearest(size), residual);
  results[4u * i + 2u] =
      Real4(pc_div_builtin(Real(1.0), y), pc_div_fma(Real(1.0), y), pc_div_nearest(Real(1.0), y), product);
  results[4u * i + 3u] = Real4(total, Real(0.0), Real(0.0), Real(0.0));
}
