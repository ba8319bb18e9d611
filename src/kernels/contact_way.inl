// tree_path.inl for contacts.
#undef PC_WAY_UINT
#undef PC_WAY_EACH
#define PC_WAY_UINT(i) PC_UINT(contact_paths, i)
#define PC_WAY_EACH(m, i) PC_EACH(contact_paths, m, i)
#include "tree_path.inl"
