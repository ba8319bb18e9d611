// Pins: the corrected forms of division and square root in src/glcompute/rounding.glsl give the correctly
// rounded result for every operand that is a normal number, on a device whose own operations are off by
// up to two units in the last place (a real GPU; llvmpipe needs no correction, so it cannot show this).
// The GLSL text is compiled here as C++, with a spoiled division and square root and an exact fma.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#define PC_FN [[maybe_unused]] static inline
#define precise
namespace {
using uint = std::uint32_t;
struct uvec2 {
  uint x, y;
  uvec2(uint x, uint y) : x(x), y(y) {}  // as GLSL writes it: not every compiler takes parentheses for an aggregate
};
uvec2 unpackDouble2x32(double v) {
  const auto b = std::bit_cast<std::uint64_t>(v);
  return {uint(b), uint(b >> 32)};
}
double packDouble2x32(uvec2 v) { return std::bit_cast<double>(std::uint64_t(v.y) << 32 | v.x); }
uint floatBitsToUint(float v) { return std::bit_cast<uint>(v); }
float uintBitsToFloat(uint v) { return std::bit_cast<float>(v); }

/// The result of a sloppy device: off by `error` units.
int error = 0;
template <class R> R spoiled(R exact) {
  if (!std::isfinite(exact) || exact == 0) return exact;
  R value = exact;
  for (int i = 0; i < std::abs(error); i++)
    value = std::nextafter(value, error < 0 ? R(0) : std::numeric_limits<R>::infinity());
  return value;
}
template <class R> R pc_device_div(R a, R b) { return spoiled<R>(a / b); }
template <class R> R pc_device_sqrt(R a) { return spoiled<R>(std::sqrt(a)); }
template <class R> R pc_device_inverse_sqrt(R a) { return spoiled<R>(R(1 / std::sqrt(double(a)))); }
template <class R> R pc_device_fma(R a, R b, R c) { return std::fma(a, b, c); }
using std::abs;
template <class R> R min(R a, R b) { return std::fmin(a, b); }
template <class R> R max(R a, R b) { return std::fmax(a, b); }

namespace single {
using Real = float;
#include "glcompute/rounding.glsl"
#undef PC_BIAS
#undef PC_EXPONENT_END
#undef PC_EASY
}  // namespace single
namespace twice {
using Real = double;
#define PC_DOUBLE
#include "glcompute/rounding.glsl"
#undef PC_DOUBLE
}  // namespace twice

template <class R> struct Forms;
template <> struct Forms<float> {
  static float div(float a, float b) { return single::pc_div_nearest(a, b); }
  static float root(float a) { return single::pc_sqrt_nearest(a); }
};
template <> struct Forms<double> {
  static double div(double a, double b) { return twice::pc_div_nearest(a, b); }
  static double root(double a) { return twice::pc_sqrt_nearest(a); }
};

template <class R> long wrong_quotients(std::mt19937_64& random, int count) {
  std::uniform_real_distribution<double> mantissa(1, 2);
  constexpr int top = std::numeric_limits<R>::max_exponent - 2;
  std::uniform_int_distribution<int> exponent(-top, top), sign(0, 1);
  long wrong = 0;
  for (int i = 0; i < count; i++) {
    R a = std::ldexp(R(mantissa(random)), exponent(random)), b = std::ldexp(R(mantissa(random)), exponent(random));
    if (i % 4 == 0) b = std::ldexp(R(2) - (i % 8 ? 1 : 3) * std::numeric_limits<R>::epsilon(), exponent(random));
    if (sign(random)) a = -a;
    const R expected = a / b;
    error = i % 5 - 2;
    // beyond the normal range the device's own result stands
    if (std::isnormal(expected)) wrong += Forms<R>::div(a, b) != expected;
  }
  return wrong;
}

template <class R> long wrong_roots(std::mt19937_64& random, int count) {
  std::uniform_real_distribution<double> mantissa(1, 2);
  constexpr int top = std::numeric_limits<R>::max_exponent - 2;
  std::uniform_int_distribution<int> exponent(-top, top);
  long wrong = 0;
  for (int i = 0; i < count; i++) {
    R x = std::ldexp(R(mantissa(random)), exponent(random));
    if (i % 2 == 0) x = std::ldexp(R(1) + R(i % 64 - 32) * std::numeric_limits<R>::epsilon() / 2, i % 9 - 4);
    error = i % 5 - 2;
    wrong += Forms<R>::root(x) != std::sqrt(x);
  }
  return wrong;
}
}  // namespace

TEST_CASE("corrected division is exact over the whole normal range") {
  std::mt19937_64 random(1);
  CHECK(wrong_quotients<float>(random, 1000000) == 0);
  CHECK(wrong_quotients<double>(random, 1000000) == 0);
}

TEST_CASE("corrected square root is exact, also beside powers of four") {
  std::mt19937_64 random(2);
  CHECK(wrong_roots<float>(random, 1000000) == 0);
  CHECK(wrong_roots<double>(random, 1000000) == 0);
}

TEST_CASE("every float mantissa in [1, 4) has the right corrected root") {
  error = 1;
  long wrong = 0;
  for (uint bits = 0x3f800000u; bits < 0x40800000u; bits++) {
    const float x = uintBitsToFloat(bits);
    wrong += single::pc_sqrt_nearest(x) != std::sqrt(x);
  }
  CHECK(wrong == 0);
}

TEST_CASE("zero, infinity and not-a-number pass through") {
  error = 0;
  const float infinity = std::numeric_limits<float>::infinity();
  CHECK(single::pc_div_nearest(0.0f, 3.0f) == 0.0f);
  CHECK(single::pc_div_nearest(1.0f, infinity) == 0.0f);
  CHECK(single::pc_div_nearest(1.0f, 0.0f) == infinity);
  CHECK(single::pc_div_nearest(-3e38f, 1e-3f) == -infinity);
  CHECK(std::isnan(single::pc_div_nearest(0.0f, 0.0f)));
  CHECK(std::isnan(single::pc_div_nearest(std::nanf(""), 3.0f)));
  CHECK(std::isnan(single::pc_div_nearest(3.0f, std::nanf(""))));
  CHECK(single::pc_sqrt_nearest(0.0f) == 0.0f);
  CHECK(single::pc_sqrt_nearest(infinity) == infinity);
  CHECK(std::isnan(single::pc_sqrt_nearest(-1.0f)));
}
