// The way between a tree's root and one of its bodies, for contacts: a contact's impulse is answered by the whole tree
// through its factor, so that joints are never violated by contacts. Notation: tree_sweep.inl.
//
// Row 0 of node_operator passes everything on unchanged, so ways of different lengths can share lanes.
//
// contact_paths, of a block of contacts: where its lists stand; there the number of levels below the roots, and of those
// below the nearest common node of contacts within one tree; then for each lane of the contact's two sides
const uint PATH_BODY = 0u;    // body rows
const uint PATH_ROOT = 2u;    // rows of nodes: roots
const uint PATH_OWN = 4u;     // the bodies' own
const uint PATH_COMMON = 6u;  // (one) the nearest common node of both; row 0 where the contact is not within one tree
const uint PATH_LEVELS = 7u;  // the way down, level by level; then what of it is below the common node

struct Way { uint at; uint depth; uint below; };
PC_FN Way pc_way(PC_IO Slot m) {
  uint block = PC_BLOCK(m); uint first = PC_UINT(contact_paths, block); Way w; w.at = first + 2u; w.depth = PC_UINT(contact_paths, first); w.below = PC_UINT(contact_paths, first + 1u); return w;
}
PC_FN uint pc_entry(Way w, uint k) { return w.at + k * PC_W; }
PC_FN uint pc_level(Way w, uint k, uint side) { return pc_entry(w, PATH_LEVELS + k * 2u + side); }
PC_FN uint pc_level_below(Way w, uint k, uint side) { return pc_entry(w, PATH_LEVELS + (w.depth + k) * 2u + side); }
PC_FN Mask pc_in_tree(PC_IO Way w, Slot m, uint side) { return pc_some(PC_EACH(contact_paths, m, pc_entry(w, PATH_OWN + side))); }
