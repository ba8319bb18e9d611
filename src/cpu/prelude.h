// The C++ side of the kernel text: what src/kernels/*.inl mean by Real, Vec3, pc_select, PC_GATHER and so
// on, for PC_LANES lanes (1, 4 or 8) of PC_SCALAR (float or double).
//
// Everything stands in the namespace PC_NAMESPACE, one per translation unit, and is forced inline: these
// units are compiled for different instruction sets, and a shared inline function would let the linker
// pick the copy that the processor lacks. For the same reason nothing of the standard library is called.
#pragma once
#if !defined(PC_SCALAR) || !defined(PC_LANES) || !defined(PC_NAMESPACE)
#error "define PC_SCALAR, PC_LANES and PC_NAMESPACE before including this"
#endif
#include <cstddef>
#include <cstdint>
#if PC_LANES > 1
#include <immintrin.h>
#endif

#define PC_INLINE inline __attribute__((always_inline))
#define PC_FN static PC_INLINE
#define PC_FN_LARGE [[gnu::noinline]] static
#define PC_INOUT(T) T&
#define PC_REAL(x) Real(Scalar(x))
#define precise

namespace pcphys {
namespace PC_NAMESPACE {

using uint = std::uint32_t;
using Scalar = PC_SCALAR;
struct Slot {
  uint block;
};
PC_INLINE Slot pc_node(Slot, uint node) { return {node}; }

#if PC_LANES == 1
using Real = Scalar;
using Mask = bool;
struct Index {
  uint i;
};
PC_INLINE Real pc_select(Mask m, Real a, Real b) { return m ? a : b; }
PC_INLINE Mask pc_and(Mask a, Mask b) { return a && b; }
PC_INLINE Mask pc_or(Mask a, Mask b) { return a || b; }
PC_INLINE Real pc_abs(Real a) {
  return sizeof(Real) == 4 ? Real(__builtin_fabsf(float(a))) : Real(__builtin_fabs(double(a)));
}
PC_INLINE Real pc_div(Real a, Real b) { return a / b; }
PC_INLINE Real pc_sqrt(Real a) {
  return sizeof(Real) == 4 ? Real(__builtin_sqrtf(float(a))) : Real(__builtin_sqrt(double(a)));
}
PC_INLINE Real pc_load(const Scalar* p) { return *p; }
PC_INLINE void pc_store(Scalar* p, Real x) { *p = x; }
PC_INLINE Index pc_index(const uint* p) { return {*p}; }
PC_INLINE Mask pc_mask(uint flag) { return flag != 0; }
PC_INLINE bool pc_any(Mask m) { return m; }
PC_INLINE Mask pc_some(Index i) { return i.i != 0; }
#else
#include "cpu/lanes.h"
PC_INLINE bool pc_any(Mask m) { return pc_mask_bits(m) != 0; }
#endif
#define PC_ANY(mask) pc_any(mask)

struct Vec3 {
  Real x, y, z;
  Vec3() = default;
  PC_INLINE Vec3(Real a, Real b, Real c) : x(a), y(b), z(c) {}
  friend PC_INLINE Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend PC_INLINE Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend PC_INLINE Vec3 operator*(Vec3 a, Real s) { return {a.x * s, a.y * s, a.z * s}; }
};

#include "kernels/math.inl"

PC_INLINE Index pc_each(const uint* list, Slot, uint i) { return pc_index(list + i); }

// Quad k of row i. The product is hidden from the compiler, which would make one of it and k for each quad and then
// have no registers left for them.
PC_INLINE const Scalar* pc_at(const Scalar* buffer, uint i, uint quads, uint k) {
  std::size_t row = std::size_t(i) * (quads * 4 * sizeof(Scalar));
  __asm__("" : "+r"(row));
  return reinterpret_cast<const Scalar*>(reinterpret_cast<const char*>(buffer) + row) + k * 4;
}
PC_INLINE Scalar* pc_at(Scalar* buffer, uint i, uint quads, uint k) {
  return const_cast<Scalar*>(pc_at(static_cast<const Scalar*>(buffer), i, quads, k));
}

// Where row i of a buffer begins, for many quads of it: each lane's address is computed once.
struct Row {
  const Scalar* p[PC_LANES];
};
PC_INLINE Row pc_row(const Scalar* buffer, Index i, uint quads) {
  Row r;
#if PC_LANES == 1
  r.p[0] = pc_at(buffer, i.i, quads, 0);
#else
  for (uint l = 0; l < PC_LANES; l++) r.p[l] = pc_at(buffer, i.i[l], quads, 0);
#endif
  return r;
}
PC_INLINE Quad pc_row_quad(const Row& r, uint k) {
  Quad q;
#if PC_LANES == 1
  q.v = Vec3(r.p[0][4 * k], r.p[0][4 * k + 1], r.p[0][4 * k + 2]);
  q.s = r.p[0][4 * k + 3];
#else
  const Scalar* p[PC_LANES];
  for (uint l = 0; l < PC_LANES; l++) p[l] = r.p[l] + 4 * k;
  Real o[4];
  pc_transpose_in(p, o);
  q.v = Vec3(o[0], o[1], o[2]);
  q.s = o[3];
#endif
  return q;
}
// Four consecutive reals of row i: quad k of a buffer with `quads` of them a row.
PC_INLINE Quad pc_gather(const Scalar* buffer, Index i, uint quads, uint k) {
  return pc_row_quad(pc_row(buffer, i, quads), k);
}
PC_INLINE void pc_scatter(Scalar* buffer, Index i, uint quads, uint k, const Quad& q) {
#if PC_LANES == 1
  Scalar* p = pc_at(buffer, i.i, quads, k);
  p[0] = q.v.x;
  p[1] = q.v.y;
  p[2] = q.v.z;
  p[3] = q.s;
#else
  Scalar* p[PC_LANES];
  for (uint l = 0; l < PC_LANES; l++) p[l] = pc_at(buffer, i.i[l], quads, k);
  const Real o[4] = {q.v.x, q.v.y, q.v.z, q.s};
  pc_transpose_out(p, o);
#endif
}

// The same where the mask is set: all lanes or none, but for the last blocks of colours.
PC_INLINE void pc_scatter_if(Mask mask, Scalar* buffer, Index i, uint quads, uint k, const Quad& q) {
#if PC_LANES == 1
  if (mask) pc_scatter(buffer, i, quads, k, q);
#else
  const uint bits = pc_mask_bits(mask);
  if (bits == (1u << PC_LANES) - 1u) {
    pc_scatter(buffer, i, quads, k, q);
  } else if (bits != 0) {
    alignas(64) Scalar rows[PC_LANES][4];
    Scalar* p[PC_LANES];
    for (uint l = 0; l < PC_LANES; l++) p[l] = rows[l];
    const Real o[4] = {q.v.x, q.v.y, q.v.z, q.s};
    pc_transpose_out(p, o);
    for (uint l = 0; l < PC_LANES; l++)
      if (bits >> l & 1u) __builtin_memcpy(pc_at(buffer, i.i[l], quads, k), rows[l], sizeof rows[l]);
  }
#endif
}

// A flag in the row that pads: many may raise it at a time.
PC_INLINE void pc_raise(Scalar* flag) {
  Scalar up = 1;  // (not const: Clang takes no pointer to const here)
  __atomic_store(flag, &up, __ATOMIC_RELAXED);
}

// Lowers a number of a list, of which many may be at once, and raises the list's flag where that changed it.
PC_INLINE void pc_lower(uint* list, uint i, uint value) {
  uint old = __atomic_load_n(list + i, __ATOMIC_RELAXED);
  while (value < old)
    if (__atomic_compare_exchange_n(list + i, &old, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
      __atomic_store_n(list, 1u, __ATOMIC_RELAXED);
      return;
    }
}

}  // namespace PC_NAMESPACE
}  // namespace pcphys

// Buffer access inside a kernel. `io` is the kernel's own struct of pointers, const where it declared a read.
#define PC_IO const Io &io,
#define PC_PASS io,
#define PC_INFO(field) Real(io.info->field)
#define PC_COUNT(field) uint(io.info->field)
#define PC_GATHER(buffer, i, k) pc_gather(io.buffer, i, quads_##buffer, k)
#define PC_ROW(buffer, i) pc_row(io.buffer, i, quads_##buffer)
#define PC_ROW_QUAD(buffer, row, k) pc_row_quad(row, k)
#define PC_SCATTER(buffer, i, k, q) pc_scatter(io.buffer, i, quads_##buffer, k, q)
#define PC_SCATTER_IF(mask, buffer, i, k, q) pc_scatter_if(mask, io.buffer, i, quads_##buffer, k, q)
// (in two steps, so that a text may be given another buffer by its name)
#define PC_FIELD(buffer, slot, f) (io.buffer + (std::size_t((slot).block) * reals_##buffer + (f)) * PC_LANES)
#define PC_LD(buffer, slot, f) pc_load(PC_FIELD(buffer, slot, f))
#define PC_ST(buffer, slot, f, x) pc_store(PC_FIELD(buffer, slot, f), x)
#define PC_ENDS(buffer, slot, side) pc_index(io.buffer + (std::size_t((slot).block) * 2u + (side)) * PC_LANES)
#define PC_ORDER(buffer, slot) pc_index(io.buffer + std::size_t((slot).block) * PC_LANES)
// lists: what is the same for all lanes of a block, one of each lane from `i` on, slots of the same lanes elsewhere
#define PC_UINT(buffer, i) io.buffer[i]
#define PC_LOWER(buffer, i, value) pc_lower(io.buffer, i, value)
#define PC_BLOCK(slot) (slot).block
#define PC_W uint(PC_LANES)
#define PC_EACH(buffer, slot, i) pc_each(io.buffer, slot, i)
#define PC_NODE(slot, node) pc_node(slot, node)
#define PC_IS(flag) pc_mask(flag)
#define PC_RAISE(mask, buffer, k) \
  if (pc_any(mask)) pc_raise(io.buffer + 4u * (k) + 3u)
#include "kernels/nodes.inl"
