// What buffers take, those of the library and the host's own properties, as Stepper::memory lists it.
#pragma once
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "pcphys/step.h"
#include "step/schedule.h"
#include "world/state.h"

namespace pcphys {

class MemoryUses {
 public:
  explicit MemoryUses(const WorldState& state) : state_(state) {}

  /// Of each buffer what `bytes` of it answers.
  template <class BytesOf> void add_buffers(Place place, BytesOf&& bytes) {
    const auto add_one = [&](Buffer buffer) {
      const auto [name, table] = state_.own.names(buffer);
      add(name, table, place, bytes(buffer));
    };
    for (std::size_t b = 0; b < buffer_count; b++) add_one(Buffer(b));
    for (const OwnProperty& p : state_.own.list)
      if (p.used) add_one(p.buffer);
  }
  /// The world's tables and objects, and a schedule with its lists.
  void add_host(Schedule& schedule);
  /// Nothing where there is none.
  void add(std::string_view name, std::string_view table, Place place, std::size_t bytes) {
    if (bytes > 0) uses_.push_back({name, table, place, bytes});
  }
  std::vector<BufferUse> take() { return std::move(uses_); }

 private:
  const WorldState& state_;
  std::vector<BufferUse> uses_;
};

}  // namespace pcphys
