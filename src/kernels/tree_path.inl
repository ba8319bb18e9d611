// The way between a tree's root and one of its bodies, for contacts and for joints that close loops: their impulses are
// answered by the whole tree through its factor, so that its joints are never violated
// by them. Notation: tree_sweep.inl.
//
// Row 0 of node_operator passes everything on unchanged, so ways of different lengths can share lanes.
//
// The list of ways (contact_way.inl, joint_way.inl name it), of a block of slots: where its lists stand; there of each
// side the number of levels below the root, and of those below the nearest common node of slots within one tree;
// whether any lane's body stands in a tree; how many levels from the root on the sides of any lane share; and the
// block's first slot of contact_reach (tree_reach.inl). Then for each lane
const uint PATH_BODY = 0u;    // body rows, of the sides a and b
const uint PATH_ROOT = 2u;    // rows of nodes: roots
const uint PATH_OWN = 4u;     // the bodies' own
const uint PATH_COMMON = 6u;  // (one) the nearest common node of both; row 0 where the slot is not within one tree
// the way down on side a, level by level, and on b; then what of each is below the common node; then what is shared
const uint PATH_LEVELS = 7u;

struct Way {
  uint at;
  uint depth_a;
  uint depth_b;
  uint below_a;
  uint below_b;
  uint any_a;
  uint any_b;
  uint shared_levels;
  uint reach;
};
PC_FN Way pc_way(PC_IO Slot m) {
  uint block = PC_BLOCK(m);
  uint first = PC_WAY_UINT(block);
  Way w;
  w.at = first + 8u;
  w.depth_a = PC_WAY_UINT(first);
  w.depth_b = PC_WAY_UINT(first + 1u);
  w.below_a = PC_WAY_UINT(first + 2u);
  w.below_b = PC_WAY_UINT(first + 3u);
  w.any_a = PC_WAY_UINT(first + 4u);
  w.any_b = PC_WAY_UINT(first + 5u);
  w.shared_levels = PC_WAY_UINT(first + 6u);
  w.reach = PC_WAY_UINT(first + 7u);
  return w;
}
PC_FN uint pc_entry(Way w, uint k) { return w.at + k * PC_W; }
// where the levels of a side begin, of the whole way and of what is below the common node;
// and those that both sides share
PC_FN uint pc_levels(Way w, uint side) { return PATH_LEVELS + w.depth_a * side; }
PC_FN uint pc_levels_below(Way w, uint side) { return PATH_LEVELS + w.depth_a + w.depth_b + w.below_a * side; }
PC_FN uint pc_depth(Way w, uint side) { return w.depth_a * (1u - side) + w.depth_b * side; }
PC_FN uint pc_any_in_tree(Way w, uint side) { return w.any_a * (1u - side) + w.any_b * side; }
PC_FN Mask pc_in_tree(PC_IO Way w, Slot m, uint side) { return pc_some(PC_WAY_EACH(m, pc_entry(w, PATH_OWN + side))); }
