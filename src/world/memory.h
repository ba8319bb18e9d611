// Bytes aligned for SIMD, kept when they shrink: growing is the only time a warmed-up step allocates.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace pcphys {

/// Room for so many more, which then come without a need for memory; it grows by doubling.
template <class T> void make_room(std::vector<T>& values, std::size_t more = 1) {
  if (values.capacity() - values.size() < more) values.reserve(std::max(2 * values.size(), values.size() + more));
}

class AlignedBytes {
 public:
  static constexpr std::size_t alignment = 64;

  std::byte* data() { return data_.get(); }
  const std::byte* data() const { return data_.get(); }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }

  /// So that `resize` up to that size needs no memory.
  void reserve(std::size_t size) {
    if (size > capacity_) reallocate(size + size / 2);
  }
  /// Keeps what there is; new bytes are zero.
  void resize(std::size_t size) {
    reserve(size);
    if (size > size_) std::memset(data_.get() + size_, 0, size - size_);
    size_ = size;
  }

 private:
  struct Free {
    void operator()(std::byte* p) const { std::free(p); }
  };

  void reallocate(std::size_t wanted) {
    const std::size_t capacity = (wanted + alignment - 1) / alignment * alignment;
    std::unique_ptr<std::byte, Free> grown(static_cast<std::byte*>(std::aligned_alloc(alignment, capacity)));
    if (!grown) throw std::bad_alloc();
    if (size_) std::memcpy(grown.get(), data_.get(), size_);
    data_ = std::move(grown);
    capacity_ = capacity;
  }

  std::unique_ptr<std::byte, Free> data_;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace pcphys
