// A user kernel: compiled through pcphys_add_kernel, hence without contraction. Were the product fused with
// the sum, the last digit would differ from what the GPU computes.
float spring(float stiffness, float stretch, float rest) { return stiffness * stretch + rest; }
