// Where nothing has friction: rows without its part.
#define PC_FRICTIONLESS
#define contact_rows frictionless_rows
#include "contact_recall.inl"
#undef contact_rows
#undef PC_FRICTIONLESS
