// Bytes aligned for SIMD, kept when they shrink: growing is the only time a warmed-up step allocates.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace pcphys {

/// Room for so many more, which then come without a need for memory; it grows by doubling.
template <class T> void make_room(std::vector<T>& values, std::size_t more = 1) {
  if (values.capacity() - values.size() < more) values.reserve(std::max(2 * values.size(), values.size() + more));
}

/// Of an allocation, with what allocators commonly add: many small ones take more by that than by what they hold.
inline std::size_t allocated(std::size_t bytes) {
  return bytes == 0 ? 0 : std::max<std::size_t>(32, (bytes + 8 + 15) / 16 * 16);
}

/// What values take beside themselves: columns with what stands in them, and what has a memory_bytes() of its own. Of
/// columns it is the room that they have.
template <class... Values> std::size_t bytes_of(const Values&... values);

template <class Value> std::size_t bytes_of_one(const Value& value) {
  constexpr bool is_class = requires { value.memory_bytes(); }
  , is_column = requires { value.capacity(), value.data(); }
  , is_map = requires { value.bucket_count(); };
  std::size_t sum = 0;
  if constexpr (is_class) sum = value.memory_bytes();
  if constexpr (is_column) sum = allocated(value.capacity() * sizeof(*value.data()));
  if constexpr (is_map)
    sum = value.bucket_count() * sizeof(void*) + value.size() * allocated(sizeof(*value.begin()) + sizeof(void*));
  if constexpr (!is_class && requires { value.begin(); })
    if constexpr (!std::is_trivially_copyable_v<std::remove_cvref_t<decltype(*value.begin())>>)
      for (const auto& each : value) sum += bytes_of_one(each);
  if constexpr (requires { value.first, value.second; }) sum = bytes_of(value.first, value.second);
  return sum;
}
template <class... Values> std::size_t bytes_of(const Values&... values) {
  return (std::size_t{0} + ... + bytes_of_one(values));
}

class AlignedBytes {
 public:
  static constexpr std::size_t alignment = 64;

  std::byte* data() { return data_.get(); }
  const std::byte* data() const { return data_.get(); }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  std::size_t memory_bytes() const { return capacity_; }

  /// So that `resize` up to that size needs no memory.
  void reserve(std::size_t size) {
    if (size > capacity_) reallocate(size + size / 2);
  }
  /// Gives back what is more than its size.
  void shrink() {
    if (size_ == 0)
      *this = AlignedBytes();
    else if (capacity_ >= size_ + alignment)
      reallocate(size_);
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
