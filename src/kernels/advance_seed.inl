// The end of a sub-step of the original's scheme: the angular velocity is constant, the momentum turns with the body.
#define PC_SEED
#include "advance.inl"
#undef PC_SEED
