// Where nothing has friction: rows without its part.
#define PC_PLACED
#include "contact_solve_frictionless.inl"
#undef PC_PLACED
