// The GLSL side of the kernel text: what src/kernels/*.inl mean by Real, Vec3, pc_select, PC_GATHER and so
// on. One invocation is one lane. Before this text the program says PC_DOUBLE (or not), PC_W, and which
// forms of rounding.glsl pc_div and pc_sqrt are; constants in PC_REAL are replaced by literals of the
// precision while the text is put together (program_source.cpp).
#ifdef PC_DOUBLE
#define Real double
#define Vec3 dvec3
#define Real4 dvec4
#else
#define Real float
#define Vec3 vec3
#define Real4 vec4
#endif
#define Mask bool
#define Index uint
#define Row uint
#define PC_FN
#define PC_FN_LARGE
#define PC_INOUT(T) inout T
#define PC_ANY(mask) (mask)
#define PC_IO
#define PC_PASS

struct Slot {
  uint block;
  uint lane;
};

#define pc_device_div(a, b) ((a) / (b))
#define pc_device_sqrt(x) sqrt(x)
#define pc_device_inverse_sqrt(x) inversesqrt(x)
#define pc_device_fma(a, b, c) fma(a, b, c)
#include "rounding.glsl"

Real pc_select(bool m, Real a, Real b) { return m ? a : b; }
bool pc_and(bool a, bool b) { return a && b; }
bool pc_or(bool a, bool b) { return a || b; }
Real pc_abs(Real a) { return abs(a); }
bool pc_some(uint row) { return row != 0u; }

#include "math.inl"

Quad pc_quad_of(Real4 q) { return Quad(q.xyz, q.w); }
Real4 pc_real4_of(Quad q) { return Real4(q.v, q.s); }

// Rows of tables are `quads_<buffer>` times Real4; slots are arrays of structures of arrays of PC_W lanes,
// four reals of a lane side by side: 16 or 32 bytes an access, neighbouring lanes adjacent.
#define PC_INFO(field) pc_info.field
#define PC_COUNT(field) uint(pc_info.field)
#define PC_GATHER(buffer, i, k) pc_quad_of(io_##buffer[quads_##buffer * (i) + (k)])
#define PC_QUAD_AT(i, quads, k) ((i) * (quads) + (k))
#define PC_ROW(buffer, i) (quads_##buffer * (i))
#define PC_ROW_QUAD(buffer, row, k) pc_quad_of(io_##buffer[(row) + (k)])
#define PC_SCATTER(buffer, i, k, q) io_##buffer[quads_##buffer * (i) + (k)] = pc_real4_of(q)
#define PC_SCATTER_IF(mask, buffer, i, k, q) \
  if (mask) io_##buffer[quads_##buffer * (i) + (k)] = pc_real4_of(q)
#ifdef PC_DOUBLE  // as scalars: an H200's compiler (driver 580) cannot index a dvec4 by a variable
#define PC_AT(buffer, slot, f) \
  io_##buffer[(((slot).block * quads_##buffer + ((f) >> 2u)) * PC_W + (slot).lane) * 4u + (3u & (f))]
#else
#define PC_AT(buffer, slot, f) io_##buffer[((slot).block * quads_##buffer + ((f) >> 2u)) * PC_W + (slot).lane][3u & (f)]
#endif
#define PC_LD(buffer, slot, f) PC_AT(buffer, slot, f)
#define PC_ST(buffer, slot, f, x) PC_AT(buffer, slot, f) = x
#define PC_ENDS(buffer, slot, side) io_##buffer[((slot).block * 2u + (side)) * PC_W + (slot).lane]
#define PC_ORDER(buffer, slot) io_##buffer[(slot).block * PC_W + (slot).lane]
// lists: what is the same for all lanes of a block, one of each lane from `i` on, slots of the same lanes elsewhere
#define PC_UINT(buffer, i) io_##buffer[i]
// lowers a number of a list, of which many may be at once, and raises the list's flag, its first, where that changed it
#define PC_LOWER(buffer, i, value) \
  if (io_##buffer[i] > (value) && atomicMin(io_##buffer[i], value) > (value)) io_##buffer[0] = 1u
#define PC_BLOCK(slot) (slot).block
#define PC_EACH(buffer, slot, i) io_##buffer[(i) + (slot).lane]
#define PC_NODE(slot, node) Slot(node, (slot).lane)
#define PC_IS(flag) ((flag) != 0u)
#define PC_RAISE(mask, buffer, k) \
  if (mask) io_##buffer[k].w = PC_REAL(1.0)
#include "nodes.inl"
