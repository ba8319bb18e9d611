// tree_joint_solve where some joint has a motor or a spring.
#define PC_DRIVES
#include "tree_joint_solve.inl"
#undef PC_DRIVES
