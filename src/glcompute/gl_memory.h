// What programs bind: storage buffers, and the blocks of numbers that kernels are told besides.
// The context must be current.
#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "glcompute/gl_buffer.h"
#include "pcphys/device.h"
#include "pcphys/result.h"
#include "world/schema.h"

namespace pcphys {

class GlMemory {
 public:
  /// Sizes of blocks follow the device's alignment.
  void start(Precision precision, const GlLimits& limits);
  void release();

  GlBuffer& at(Buffer buffer) {
    if (buffers_.size() <= std::size_t(buffer)) buffers_.resize(std::size_t(buffer) + 1);
    return buffers_[std::size_t(buffer)];
  }
  Status resize(Buffer buffer, std::size_t bytes);
  Status keep(Buffer buffer);
  /// bad_argument where the host keeps nothing for it.
  Status check_transferable(Buffer buffer);
  std::size_t held_bytes(Buffer buffer) const {
    return std::size_t(buffer) < buffers_.size() ? buffers_[std::size_t(buffer)].capacity() : 0;
  }
  void set_infos(const void* infos, std::size_t count);

  /// For the program that runs next; `kernel` names it in errors.
  Status bind(Buffer buffer, std::uint32_t binding, std::string_view kernel);
  Status bind(std::span<const Access> accesses, std::string_view kernel);
  Status bind_info(std::size_t info);

  const GlLimits& limits() const { return limits_; }

 private:
  GlLimits limits_;
  std::vector<GlBuffer> buffers_ = std::vector<GlBuffer>(buffer_count);  // by Buffer
  std::uint32_t info_buffer_ = 0;
  std::size_t info_bytes_ = 0, info_stride_ = 0, info_count_ = 0, info_capacity_ = 0;
  std::vector<char> info_staging_;
};

}  // namespace pcphys
