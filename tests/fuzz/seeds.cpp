#include "seeds.h"

#include <algorithm>
#include <cstddef>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

/// Without a corpus libFuzzer starts from an empty line; in place of what is nearly empty, and now and then of another input, stands one
/// of the target's own.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  static const std::vector<std::vector<std::uint8_t>> seeds = fuzz::seeds();
  constexpr unsigned rarely = 64;
  if (size < 2 || seed % rarely == 0) {
    const std::vector<std::uint8_t>& one = seeds[seed / rarely % seeds.size()];
    size = std::min(one.size(), most);
    std::copy_n(one.begin(), size, data);
  }
  return LLVMFuzzerMutate(data, size, most);
}
