// After the last sub-step where some body has drag.
#define PC_DRAG
#include "synchronise.inl"
#undef PC_DRAG
