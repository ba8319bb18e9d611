// What a step has overwritten in the tables, as it was: a device may fail after that.
#pragma once
#include <cstring>
#include <vector>

#include "world/tables.h"

namespace pcphys {

class Rollback {
 public:
  /// Before the first change of a buffer in a step; later calls do nothing.
  void keep(const Tables& tables, Buffer buffer) {
    if (copies_.size() <= std::size_t(buffer)) copies_.resize(std::size_t(buffer) + 1);
    Copy& copy = copies_[std::size_t(buffer)];
    if (copy.kept) return;
    const AlignedBytes& now = tables.bytes(buffer);
    copy.bytes.resize(now.size());
    std::memcpy(copy.bytes.data(), now.data(), now.size());
    copy.kept = true;  // there may have been no memory for it
  }

  /// What was kept in this step, or null.
  const AlignedBytes* before(Buffer buffer) const {
    return copies_.size() > std::size_t(buffer) && copies_[std::size_t(buffer)].kept
               ? &copies_[std::size_t(buffer)].bytes
               : nullptr;
  }

  std::size_t memory_bytes() const {
    std::size_t sum = 0;
    for (const Copy& copy : copies_) sum += copy.bytes.capacity();
    return sum;
  }

  /// The step was made.
  void drop() {
    for (Copy& copy : copies_) copy.kept = false;
  }

  /// The step failed. To devices that hold a copy this is one more change.
  void put_back(Tables& tables) {
    for (std::size_t b = 0; b < copies_.size(); b++) {
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
  std::vector<Copy> copies_;  // by Buffer
};

}  // namespace pcphys
