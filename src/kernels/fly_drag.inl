// Flight where some body has drag.
#define PC_DRAG
#include "fly.inl"
#undef PC_DRAG
