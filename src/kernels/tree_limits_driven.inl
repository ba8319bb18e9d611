// tree_limits where some joint has a motor or a spring.
#define PC_DRIVES
#include "tree_limits.inl"
#undef PC_DRIVES
