#include "step/memory_uses.h"

#include "step/domains.h"

namespace pcphys {

void MemoryUses::add_host(Schedule& schedule) {
  add_buffers(Place::cpu, [&](Buffer b) {
    if (of_table(b)) return state_.tables.held_bytes(b);
    const std::vector<std::uint32_t>* list = list_of(b, schedule);
    return list ? list->capacity() * sizeof(list->front()) : 0;
  });
}

}  // namespace pcphys
