// Start of a step where some body has drag.
#define PC_DRAG
#include "begin.inl"
#undef PC_DRAG
