// tree_solve where some joint has a motor or a spring.
#define PC_DRIVES
#include "tree_solve.inl"
#undef PC_DRIVES
