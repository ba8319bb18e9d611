// The end of a sub-step where every body has three equal moments of inertia.
#define PC_ROUND
#include "advance.inl"
#undef PC_ROUND
