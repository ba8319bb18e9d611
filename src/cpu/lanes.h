// PC_LANES values side by side (GCC and Clang vector extensions) and the transposes that gather four
// consecutive reals of each lane's row with full-width loads. Included by prelude.h inside its namespace.

struct Real {
  typedef Scalar Vector __attribute__((vector_size(sizeof(Scalar) * PC_LANES)));
  Vector v;
  Real() = default;
  PC_INLINE Real(Vector x) : v(x) {}
  PC_INLINE Real(Scalar s) : v(s - Vector{}) {}
  friend PC_INLINE Real operator+(Real a, Real b) { return a.v + b.v; }
  friend PC_INLINE Real operator-(Real a, Real b) { return a.v - b.v; }
  friend PC_INLINE Real operator*(Real a, Real b) { return a.v * b.v; }
  friend PC_INLINE Real operator-(Real a) { return -a.v; }
  friend PC_INLINE auto operator<(Real a, Real b) { return a.v < b.v; }
  friend PC_INLINE auto operator>(Real a, Real b) { return a.v > b.v; }
};
using Mask = decltype(Real() < Real());
struct Index {
  const uint* i;
};

PC_INLINE Real pc_select(Mask m, Real a, Real b) { return m ? a.v : b.v; }
PC_INLINE Mask pc_and(Mask a, Mask b) { return a & b; }
PC_INLINE Mask pc_or(Mask a, Mask b) { return a | b; }
PC_INLINE Real pc_abs(Real a) { return Real::Vector(Mask(a.v) & ~Mask(-Real::Vector{})); }
PC_INLINE Real pc_div(Real a, Real b) { return a.v / b.v; }
PC_INLINE Real pc_load(const Scalar* p) { return *reinterpret_cast<const Real::Vector*>(p); }
PC_INLINE void pc_store(Scalar* p, Real x) { *reinterpret_cast<Real::Vector*>(p) = x.v; }
PC_INLINE Index pc_index(const uint* p) { return {p}; }
PC_INLINE Mask pc_mask(uint flag) { return Real(Scalar(flag)) > Real(Scalar(0)); }
PC_INLINE Mask pc_some(Index index) {
  typedef uint Rows __attribute__((vector_size(4 * PC_LANES), aligned(4), may_alias));
  return __builtin_convertvector(*reinterpret_cast<const Rows*>(index.i) != 0, Mask);
}

// pc_transpose_in: four consecutive reals of each lane's row become four Reals; pc_transpose_out reverses it.
#if !defined(PC_DOUBLE) && PC_LANES == 4
PC_INLINE uint pc_mask_bits(Mask m) { return uint(_mm_movemask_ps(__m128(m))); }
PC_INLINE Real pc_sqrt(Real a) { return Real::Vector(_mm_sqrt_ps(a.v)); }
PC_INLINE void pc_transpose_in(const float* const* p, Real* o) {
  __m128 a = _mm_load_ps(p[0]), b = _mm_load_ps(p[1]), c = _mm_load_ps(p[2]), d = _mm_load_ps(p[3]);
  _MM_TRANSPOSE4_PS(a, b, c, d);
  o[0] = a;
  o[1] = b;
  o[2] = c;
  o[3] = d;
}
PC_INLINE void pc_transpose_out(float* const* p, const Real* o) {
  __m128 a = o[0].v, b = o[1].v, c = o[2].v, d = o[3].v;
  _MM_TRANSPOSE4_PS(a, b, c, d);
  _mm_store_ps(p[0], a);
  _mm_store_ps(p[1], b);
  _mm_store_ps(p[2], c);
  _mm_store_ps(p[3], d);
}
#elif !defined(PC_DOUBLE) && PC_LANES == 8
PC_INLINE uint pc_mask_bits(Mask m) { return uint(_mm256_movemask_ps(__m256(m))); }
PC_INLINE Real pc_sqrt(Real a) { return Real::Vector(_mm256_sqrt_ps(a.v)); }
PC_INLINE __m256 pc_pair(const float* low, const float* high) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(low)), _mm_load_ps(high), 1);
}
PC_INLINE void pc_unpair(float* low, float* high, __m256 x) {
  _mm_store_ps(low, _mm256_castps256_ps128(x));
  _mm_store_ps(high, _mm256_extractf128_ps(x, 1));
}
PC_INLINE void pc_transpose_lanes(__m256& a, __m256& b, __m256& c, __m256& d) {
  const __m256 t0 = _mm256_unpacklo_ps(a, b), t1 = _mm256_unpackhi_ps(a, b), t2 = _mm256_unpacklo_ps(c, d),
               t3 = _mm256_unpackhi_ps(c, d);
  a = _mm256_shuffle_ps(t0, t2, 0x44);
  b = _mm256_shuffle_ps(t0, t2, 0xEE);
  c = _mm256_shuffle_ps(t1, t3, 0x44);
  d = _mm256_shuffle_ps(t1, t3, 0xEE);
}
PC_INLINE void pc_transpose_in(const float* const* p, Real* o) {
  __m256 a = pc_pair(p[0], p[4]), b = pc_pair(p[1], p[5]), c = pc_pair(p[2], p[6]), d = pc_pair(p[3], p[7]);
  pc_transpose_lanes(a, b, c, d);
  o[0] = a;
  o[1] = b;
  o[2] = c;
  o[3] = d;
}
PC_INLINE void pc_transpose_out(float* const* p, const Real* o) {
  __m256 a = o[0].v, b = o[1].v, c = o[2].v, d = o[3].v;
  pc_transpose_lanes(a, b, c, d);
  pc_unpair(p[0], p[4], a);
  pc_unpair(p[1], p[5], b);
  pc_unpair(p[2], p[6], c);
  pc_unpair(p[3], p[7], d);
}
#elif defined(PC_DOUBLE) && PC_LANES == 4
PC_INLINE uint pc_mask_bits(Mask m) { return uint(_mm256_movemask_pd(__m256d(m))); }
PC_INLINE Real pc_sqrt(Real a) { return Real::Vector(_mm256_sqrt_pd(a.v)); }
PC_INLINE void pc_transpose_lanes(__m256d& a, __m256d& b, __m256d& c, __m256d& d) {
  const __m256d t0 = _mm256_unpacklo_pd(a, b), t1 = _mm256_unpackhi_pd(a, b), t2 = _mm256_unpacklo_pd(c, d),
                t3 = _mm256_unpackhi_pd(c, d);
  a = _mm256_permute2f128_pd(t0, t2, 0x20);
  b = _mm256_permute2f128_pd(t1, t3, 0x20);
  c = _mm256_permute2f128_pd(t0, t2, 0x31);
  d = _mm256_permute2f128_pd(t1, t3, 0x31);
}
PC_INLINE void pc_transpose_in(const double* const* p, Real* o) {
  __m256d a = _mm256_load_pd(p[0]), b = _mm256_load_pd(p[1]), c = _mm256_load_pd(p[2]), d = _mm256_load_pd(p[3]);
  pc_transpose_lanes(a, b, c, d);
  o[0] = a;
  o[1] = b;
  o[2] = c;
  o[3] = d;
}
PC_INLINE void pc_transpose_out(double* const* p, const Real* o) {
  __m256d a = o[0].v, b = o[1].v, c = o[2].v, d = o[3].v;
  pc_transpose_lanes(a, b, c, d);
  _mm256_store_pd(p[0], a);
  _mm256_store_pd(p[1], b);
  _mm256_store_pd(p[2], c);
  _mm256_store_pd(p[3], d);
}
#else
#error "no transposes for this number of lanes"
#endif
