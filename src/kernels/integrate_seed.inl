// Stage 1 by the original's scheme, where some body has drag: u' = (1 - F h) u + a h.
#define PC_DRAG
#define PC_SEED
#include "integrate.inl"
#undef PC_SEED
#undef PC_DRAG
