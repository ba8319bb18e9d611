// One storage buffer on the device and its counterpart on the host. The context must be current.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "pcphys/result.h"

namespace pcphys {

class GlBuffer {
 public:
  /// Grows by half when `bytes` do not fit; contents are then lost. buffer_full when the device cannot hold it.
  Status resize(std::string_view label, std::size_t bytes, std::uint64_t limit);
  void attach(void* host, std::size_t bytes) {
    host_ = host;
    bytes_ = bytes;
  }
  void upload() const;
  void download() const;
  /// Whether any of these bytes (up to 8) is not zero; they are zero then.
  bool take(std::size_t offset, std::size_t bytes) const;
  void release();

  std::size_t capacity() const { return capacity_; }
  std::uint32_t id() const { return id_; }
  bool attached() const { return id_ != 0; }
  bool transferable() const { return host_ != nullptr || bytes_ == 0; }

 private:
  std::uint32_t id_ = 0;
  std::size_t capacity_ = 0;
  void* host_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace pcphys
