// Stage 1 where some body has drag.
#define PC_DRAG
#include "integrate.inl"
#undef PC_DRAG
