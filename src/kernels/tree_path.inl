// The way between a tree's root and one of its bodies, for contacts: a contact's impulse is answered by the whole tree
// through its factor, so that joints are never violated by contacts. Notation: tree_sweep.inl.
//
// Row 0 of node_operator passes everything on unchanged, so ways of different lengths can share lanes.
//
// contact_paths, of a block of contacts: where its lists stand; there of each side the number of levels below the root, and
// of those below the nearest common node of contacts within one tree; then for each lane
const uint PATH_BODY = 0u;    // body rows, of the sides a and b
const uint PATH_ROOT = 2u;    // rows of nodes: roots
const uint PATH_OWN = 4u;     // the bodies' own
const uint PATH_COMMON = 6u;  // (one) the nearest common node of both; row 0 where the contact is not within one tree
const uint PATH_LEVELS = 7u;  // the way down on side a, level by level, and on b; then what of each is below the common node

struct Way { uint at; uint depth_a; uint depth_b; uint below_a; uint below_b; uint any_a; uint any_b; };
PC_FN Way pc_way(PC_IO Slot m) {
  uint block = PC_BLOCK(m); uint first = PC_UINT(contact_paths, block); Way w; w.at = first + 6u;
  w.depth_a = PC_UINT(contact_paths, first); w.depth_b = PC_UINT(contact_paths, first + 1u); w.below_a = PC_UINT(contact_paths, first + 2u); w.below_b = PC_UINT(contact_paths, first + 3u); w.any_a = PC_UINT(contact_paths, first + 4u); w.any_b = PC_UINT(contact_paths, first + 5u); return w;
}
PC_FN uint pc_entry(Way w, uint k) { return w.at + k * PC_W; }
// where the levels of a side begin, of the whole way and of what is below the common node
PC_FN uint pc_levels(Way w, uint side) { return PATH_LEVELS + w.depth_a * side; }
PC_FN uint pc_levels_below(Way w, uint side) { return PATH_LEVELS + w.depth_a + w.depth_b + w.below_a * side; }
PC_FN uint pc_depth(Way w, uint side) { return w.depth_a * (1u - side) + w.depth_b * side; }
PC_FN uint pc_any_in_tree(Way w, uint side) { return w.any_a * (1u - side) + w.any_b * side; }
PC_FN Mask pc_in_tree(PC_IO Way w, Slot m, uint side) { return pc_some(PC_EACH(contact_paths, m, pc_entry(w, PATH_OWN + side))); }
