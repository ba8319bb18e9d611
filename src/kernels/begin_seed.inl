// Start of a step of the original's scheme.
#define PC_SEED
#include "begin.inl"
#undef PC_SEED
