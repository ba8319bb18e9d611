// Stores of a node's fields, for the kernels that write tree_rows.
PC_FN void pc_st3_tree(PC_IO Slot n, uint f, Vec3 v) {
  PC_ST(tree_rows, n, f, v.x);
  PC_ST(tree_rows, n, f + 1u, v.y);
  PC_ST(tree_rows, n, f + 2u, v.z);
}
PC_FN void pc_st6_tree(PC_IO Slot n, uint f, Six x) {
  pc_st3_tree(PC_PASS n, f, x.l);
  pc_st3_tree(PC_PASS n, f + 3u, x.a);
}
PC_FN void pc_sts_tree(PC_IO Slot n, uint f, Sym3 m) {
  PC_ST(tree_rows, n, f, m.xx);
  PC_ST(tree_rows, n, f + 1u, m.xy);
  PC_ST(tree_rows, n, f + 2u, m.xz);
  PC_ST(tree_rows, n, f + 3u, m.yy);
  PC_ST(tree_rows, n, f + 4u, m.yz);
  PC_ST(tree_rows, n, f + 5u, m.zz);
}
PC_FN void pc_stm_tree(PC_IO Slot n, uint f, Mat3 m) {
  pc_st3_tree(PC_PASS n, f, m.a);
  pc_st3_tree(PC_PASS n, f + 3u, m.b);
  pc_st3_tree(PC_PASS n, f + 6u, m.c);
}
PC_FN void pc_sth_tree(PC_IO Slot n, uint f, Sym6 h) {
  pc_sts_tree(PC_PASS n, f, h.l);
  pc_stm_tree(PC_PASS n, f + 6u, h.c);
  pc_sts_tree(PC_PASS n, f + 15u, h.a);
}
