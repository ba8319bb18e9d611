// What a step has overwritten in the tables, as it was: a device may fail after that.
#pragma once
#include <array>
#include <cstring>

#include "world/tables.h"

namespace pcphys {

class Rollback {
 public:
  /// Before the first change of a buffer in a step; later calls do nothing.
  void keep(const Tables& tables, Buffer buffer) {
    Copy& copy = copies_[std::size_t(buffer)];
    if (copy.kept) return;
    copy.kept = true;
    const AlignedBytes& now = tables.bytes(buffer);
    copy.bytes.resize(now.size());
    std::memcpy(copy.bytes.data(), now.data(), now.size());
  }

  /// What was kept in this step, or null.
  const AlignedBytes* before(Buffer buffer) const {
    const Copy& copy = copies_[std::size_t(buffer)];
    return copy.kept ? &copy.bytes : nullptr;
  }

  /// The step was made.
  void drop() {
    for (Copy& copy : copies_) copy.kept = false;
  }

  /// The step failed. To devices that hold a copy this is one more change.
  void put_back(Tables& tables) {
    for (std::size_t b = 0; b < table_buffer_count; b++) {
      if (!copies_[b].kept) continue;
      AlignedBytes& now = tables.bytes(Buffer(b));
      std::memcpy(now.data(), copies_[b].bytes.data(), now.size());
      tables.touch(Buffer(b));
    }
    drop();
  }

 private:
  struct Copy {
    AlignedBytes bytes;  // kept from step to step
    bool kept = false;
  };
  std::array<Copy, table_buffer_count> copies_;
};

}  // namespace pcphys
