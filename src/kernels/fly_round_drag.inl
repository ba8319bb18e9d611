// Flight where some body has drag, and every one three equal moments of inertia.
#define PC_DRAG
#define PC_ROUND
#include "fly.inl"
#undef PC_ROUND
#undef PC_DRAG
