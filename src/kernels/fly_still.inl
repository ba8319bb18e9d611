// A flight of bodies of which none rotates.
#define PC_STILL
#include "fly.inl"
#undef PC_STILL
