// The text of the library's kernels over a design's own storage, for one element at a time. Included in a design's
// namespace, inside that of cpu/prelude.h, where it has defined
//   Index                    how it names a body, joint or contact;  Slot   a joint or contact that is being solved
//   Io                       with `info`, and
//     at<Buffer>(Index)      a row of a property buffer
//     rows<Buffer>(Slot)     scratch of a joint or contact
//     end<Buffer>(Slot, side), record(Slot)   its two bodies, and what it is itself
// Each kernel is then NAME::pc_kernel(io, element), as in src/cpu/kernels_all.inl.

PC_INLINE Quad pc_read_quad(const Scalar* p) { return pc_quad(Vec3(p[0], p[1], p[2]), p[3]); }
PC_INLINE void pc_write_quad(Scalar* p, const Quad& q) { p[0] = q.v.x, p[1] = q.v.y, p[2] = q.v.z, p[3] = q.s; }

#undef PC_GATHER
#undef PC_SCATTER
#undef PC_SCATTER_IF
#undef PC_LD
#undef PC_ST
#undef PC_ENDS
#undef PC_ORDER
#define PC_GATHER(buffer, i, k) pc_read_quad(io.template at<Buffer::buffer>(i) + (k)*4u)
#define PC_SCATTER(buffer, i, k, q) pc_write_quad(io.template at<Buffer::buffer>(i) + (k)*4u, q)
#define PC_SCATTER_IF(mask, buffer, i, k, q) \
  if (mask) PC_SCATTER(buffer, i, k, q)
#define PC_LD(buffer, slot, f) io.template rows<Buffer::buffer>(slot)[f]
#define PC_ST(buffer, slot, f, x) io.template rows<Buffer::buffer>(slot)[f] = x
#define PC_ENDS(buffer, slot, side) io.template end<Buffer::buffer>(slot, side)
#define PC_ORDER(buffer, slot) io.record(slot)

namespace begin_drag {
#include "kernels/begin_drag.inl"
}
namespace remember {
#include "kernels/remember.inl"
}
namespace integrate_drag {
#include "kernels/integrate_drag.inl"
}
namespace inertia {
#include "kernels/inertia.inl"
}
namespace advance {
#include "kernels/advance.inl"
}
namespace synchronise_drag {
#include "kernels/synchronise_drag.inl"
}
namespace joint_prepare {
#include "kernels/joint_prepare.inl"
}
namespace joint_warm {
#include "kernels/joint_warm.inl"
}
namespace joint_solve {
#include "kernels/joint_solve.inl"
}
namespace contact_prepare {
#include "kernels/contact_prepare.inl"
}
namespace contact_warm {
#include "kernels/contact_warm.inl"
}
namespace contact_solve {
#include "kernels/contact_solve.inl"
}
namespace contact_store {
#include "kernels/contact_store.inl"
}
