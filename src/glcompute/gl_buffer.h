// Storage buffers on the device, their counterparts on the host, and the way between them. The context must be current.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "pcphys/result.h"

namespace pcphys {

/// What is on its way to the device or back stands in buffers for that alone, which the device copies from and to.
/// Storage that the host reads and writes itself is moved to the host's memory by NVIDIA's driver (580), where kernels
/// run slower, and where of two uploads in a row the second was not seen by the kernels after it (docs/gpu.md).
class GlStaging {
 public:
  void write(std::uint32_t storage, std::size_t offset, std::size_t bytes, const void* from);
  void read(std::uint32_t storage, std::size_t offset, std::size_t bytes, void* to);
  void release();

 private:
  std::uint32_t there_ = 0, back_ = 0;
  std::size_t room_ = 0;  // of `back_`
};

class GlBuffer {
 public:
  /// Grows by half when `bytes` do not fit; contents are then lost. buffer_full when the device cannot hold it.
  Status resize(std::string_view label, std::size_t bytes, std::uint64_t limit);
  void attach(void* host, std::size_t bytes) {
    host_ = host;
    bytes_ = bytes;
  }
  void upload(GlStaging& staging) const;
  void download(GlStaging& staging) const;
  /// A second copy beside it on the device, and that one back; buffer_full as of `resize`.
  Status keep(std::string_view label);
  void put_back() const;
  /// Whether any of these bytes (up to 8) is not zero; they are zero then.
  bool take(GlStaging& staging, std::size_t offset, std::size_t bytes) const;
  void release();

  std::size_t capacity() const { return capacity_ + kept_capacity_; }
  std::uint32_t id() const { return id_; }
  bool attached() const { return id_ != 0; }
  bool transferable() const { return host_ != nullptr || bytes_ == 0; }

 private:
  std::uint32_t id_ = 0;
  std::size_t capacity_ = 0;
  std::uint32_t kept_id_ = 0;
  std::size_t kept_capacity_ = 0;
  void* host_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace pcphys
