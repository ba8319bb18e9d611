// tree_path.inl for joints that close loops.
#undef PC_WAY_UINT
#undef PC_WAY_EACH
#define PC_WAY_UINT(i) PC_UINT(joint_paths, i)
#define PC_WAY_EACH(m, i) PC_EACH(joint_paths, m, i)
#include "tree_path.inl"
