// The same where some body has drag.
#define PC_DRAG
#include "restagger.inl"
#undef PC_DRAG
