// One round of label propagation with pointer jumping, over the edges (a, b) between bodies that act on each other:
//   m = min(L[L[a]], L[L[b]]);   L[a], L[b], L[L[a]] and L[L[b]] are lowered to m.
// A label is a row of the same island and never above its body's own, so labels only fall. They stand still once
// L[a] = L[b] = L[L[a]] for all edges: the lowest row of each island, whatever the order in which edges were visited.
// Lowering the labels of labels joins whole islands, and labels of labels shorten the way to the lowest: a few rounds,
// not one for each link of a chain. Source: min-labelling with hooking and shortcutting, Liu and Tarjan, Simple
// concurrent labeling algorithms for connected components (2019); Zhang, Azad and Hu, FastSV (2020).
PC_FN void pc_kernel(PC_IO uint edge) {
  uint a = PC_UINT(island_ends, 2u * edge);
  uint b = PC_UINT(island_ends, 2u * edge + 1u);
  uint of_a = PC_UINT(island_labels, a);
  uint of_b = PC_UINT(island_labels, b);
  uint above_a = PC_UINT(island_labels, of_a);
  uint above_b = PC_UINT(island_labels, of_b);
  uint lowest = above_b < above_a ? above_b : above_a;
  PC_LOWER(island_labels, a, lowest);
  PC_LOWER(island_labels, b, lowest);
  PC_LOWER(island_labels, of_a, lowest);
  PC_LOWER(island_labels, of_b, lowest);
}
