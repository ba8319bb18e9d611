#include "step/transfer_bytes.h"

#include <algorithm>

#include "step/domains.h"

namespace pcphys {
namespace {

/// Rows of nodes and touches come when a step asks for them.
std::size_t table_bytes(Buffer buffer, const WorldState& state, const Schedule& schedule) {
  const Table table = state.tables.table_of(buffer);
  const std::size_t rows = table == Table::node    ? schedule.trees.nodes().rows()
                           : table == Table::touch ? state.contact_rows()
                                                   : state.tables.rows(table);
  return rows * state.tables.row_bytes(buffer);
}

}  // namespace

void measure_transfers(StepPlan& plan, const WorldState& state, Schedule& schedule) {
  if (std::ranges::all_of(plan.entries, [](const PlanEntry& e) { return !e.transfers(); })) return;
  schedule.update_contacts(state);
  for (const PlanBinding& b : plan.bindings)
    if (b.place == Place::gl) pack(b.domain, gl_width_for(b.domain, side_by_side(b.domain, schedule)), schedule);
  for (PlanEntry& entry : plan.entries) {
    if (!entry.transfers()) continue;
    const std::vector<std::uint32_t>* list = list_of(entry.buffer, schedule);
    entry.bytes = list ? list->size() * sizeof(std::uint32_t) : table_bytes(entry.buffer, state, schedule);
  }
}

}  // namespace pcphys
