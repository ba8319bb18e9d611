#include "seeds.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <random>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

/// Of any size that its type holds; some of the sizes that physics has, some that are none.
template <class Real> Real draw_number(std::minstd_rand& random) {
  using Limits = std::numeric_limits<Real>;
  const auto among = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const unsigned of = random() % 32;
  if (of == 0) return Limits::quiet_NaN();
  if (of == 1) return Limits::infinity();
  const bool usual = of < 12;
  const double least = usual ? -4 : std::log10(double(Limits::denorm_min())), most = usual ? 4 : Limits::max_exponent10;
  const Real size = Real(std::pow(10.0, among(least, most)));
  return random() % 2 ? size : -size;
}

template <class Real> void write_number(std::uint8_t* data, std::size_t size, std::minstd_rand& random) {
  constexpr std::size_t step = 4;
  if (size < 1 + sizeof(Real)) return;
  const std::size_t at = 1 + random() % ((size - 1 - sizeof(Real)) / step + 1) * step;
  const Real number = draw_number<Real>(random);
  std::memcpy(data + at, &number, sizeof number);
}

}  // namespace

/// Without a corpus libFuzzer starts from an empty line; in place of what is nearly empty, and now and then of another
/// input, stands one of the target's own.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  static const std::vector<std::vector<std::uint8_t>> seeds = fuzz::seeds();
  std::minstd_rand random(seed);
  constexpr unsigned rarely = 16;
  if (size < 2 || random() % rarely == 0) {
    const std::vector<std::uint8_t>& one = seeds[random() % seeds.size()];
    size = std::min(one.size(), most);
    std::copy_n(one.begin(), size, data);
  }
  const std::size_t wide = fuzz::number_bytes(data[0]);
  if (wide == 0 || random() % 2) return LLVMFuzzerMutate(data, size, most);
  const auto write = wide == sizeof(double) ? write_number<double> : write_number<float>;
  for (unsigned left = 1 + random() % 3; left > 0; left--) write(data, size, random);
  return size;
}
