// Loops over the nodes of a tree.
const uint SAMPLE_MASS = 0u;
struct Tree {
  uint first;
  uint count;
};
PC_FN Real pc_sample_nodes(PC_IO Slot m, Tree t) {
  Real total = PC_REAL(0.0);
  Real twice = PC_REAL(0.0);
  PC_NODES(k, 1u, t) {
    PC_ST(tree_rows, PC_NODE(m, t.first + k), SAMPLE_MASS, total);
    PC_THEN(PC_ALL(k, 0u, t)) precise Real sum = total + PC_LD(tree_rows, PC_NODE(m, t.first + k), SAMPLE_MASS);
    total = sum;
  }
  PC_UP(k, t) twice = total + total;                                                                  // expect: precise
  PC_DOWN(k, 0u, t) { PC_ONE twice = total * total; }                                                 // expect: precise
  for (uint k = 0u; k < t.count; k++) PC_ST(tree_rows, PC_NODE(m, t.first + k), SAMPLE_MASS, total);  // expect: nodes
  for (uint i = 1u; i < t.count; i++) {                                                               // expect: nodes
    uint k = t.count - i;
    PC_ST(tree_rows, PC_NODE(m, t.first + k), SAMPLE_MASS, twice);
  }
  for (uint i = 0u; i < 3u; i++) PC_ST(tree_rows, m, SAMPLE_MASS + i, twice);
  return total;
}
