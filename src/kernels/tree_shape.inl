// A lane's tree: its first node and how many there are.
struct Tree { uint first; uint count; };
PC_FN Tree pc_tree(PC_IO Slot m) { uint block = PC_BLOCK(m); uint at = block * 2u; Tree t; t.first = PC_UINT(tree_blocks, at); t.count = PC_UINT(tree_blocks, at + 1u); return t; }
