// A flight of bodies of which none rotates, with drag.
#define PC_DRAG
#define PC_STILL
#include "fly.inl"
#undef PC_STILL
#undef PC_DRAG
