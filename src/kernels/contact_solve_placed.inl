// More visits of the manifolds of bodies that were just placed: nothing is remembered of what holds them, and their
// first overlaps are pushed out (docs/impulses.md).
#define PC_PLACED
#include "contact_solve.inl"
#undef PC_PLACED
