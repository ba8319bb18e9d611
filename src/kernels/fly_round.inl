// Flight where every body has three equal moments of inertia.
#define PC_ROUND
#include "fly.inl"
#undef PC_ROUND
