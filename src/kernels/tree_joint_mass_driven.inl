// tree_joint_mass where some joint has a motor or a spring.
#define PC_DRIVES
#include "tree_joint_mass.inl"
#undef PC_DRIVES
