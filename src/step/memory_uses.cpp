#include "step/memory_uses.h"

#include "step/domains.h"

namespace pcphys {

void MemoryUses::add_host(Schedule& schedule) {
  std::size_t lists = 0;
  add_buffers(Place::cpu, [&](Buffer b) {
    if (of_table(b)) return state_.tables.held_bytes(b);
    const std::vector<std::uint32_t>* list = list_of(b, schedule);
    const std::size_t bytes = list ? bytes_of(*list) : 0;
    lists += bytes;
    return bytes;
  });
  add("objects", "", Place::cpu, state_.memory_bytes() - state_.tables.memory_bytes());
  add("schedule", "", Place::cpu, schedule.memory_bytes() - lists);
}

}  // namespace pcphys
