// Stable least-significant-digit radix sort: the order is a function of keys and input order alone, so any
// executor that sorts stably (the GPU does) gets the same.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace pcphys {

template <class T, class Key> void insertion_sort(T* items, std::size_t count, Key key) {
  for (std::size_t i = 1; i < count; ++i) {
    const T item = items[i];
    std::size_t j = i;
    for (; j > 0 && key(items[j - 1]) > key(item); --j) items[j] = items[j - 1];
    items[j] = item;
  }
}

namespace radix {

/// Sorts by the bits [begin, end) of key(item), in digits of `bits`; returns where the sorted items are.
template <unsigned bits, class T, class Key>
T* sort(T* items, T* scratch, std::size_t count, unsigned begin, unsigned end, Key key) {
  constexpr std::uint32_t values = 1u << bits, mask = values - 1;
  constexpr unsigned most = (64 + bits - 1) / bits;
  std::uint32_t starts[most][values];
  const unsigned digits = (end - begin + bits - 1) / bits;
  for (unsigned d = 0; d < digits; ++d)
    for (std::uint32_t& start : starts[d]) start = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t rest = key(items[i]) >> begin;
    for (unsigned d = 0; d < digits; ++d, rest >>= bits) ++starts[d][rest & mask];
  }
  for (unsigned d = 0; d < digits; ++d) {
    const unsigned shift = begin + d * bits;
    if (starts[d][(key(items[0]) >> shift) & mask] == count) continue;  // all alike: nothing to move
    std::uint32_t sum = 0;
    for (std::uint32_t& start : starts[d]) sum += std::exchange(start, sum);
    for (std::size_t i = 0; i < count; ++i) scratch[starts[d][(key(items[i]) >> shift) & mask]++] = items[i];
    std::swap(items, scratch);
  }
  return items;
}

}  // namespace radix

/// Sorts by key(item), an unsigned integer below 2^end of which the lowest `begin` bits are in order already.
/// `scratch` has room for `count` items. Returns whichever of the two arrays holds the result.
template <class T, class Key>
T* radix_sort(T* items, T* scratch, std::size_t count, unsigned begin, unsigned end, Key key) {
  if (count < 64) {
    insertion_sort(items, count, [&](const T& item) { return key(item) >> begin; });
    return items;
  }
  return count < 300 ? radix::sort<8>(items, scratch, count, begin, end, key)
                     : radix::sort<10>(items, scratch, count, begin, end, key);
}

}  // namespace pcphys
