// pcphys plan SCENE: what a step runs, where, and what it leaves out.
#include <algorithm>
#include <iostream>

#include "commands.h"
#include "output.h"
#include "plan/plan.h"
#include "report.h"
#include "simulation.h"
#include "world/state.h"

namespace pcphys::command {
namespace {

Json names(const std::vector<std::string_view>& list) {
  Json result = Json::array();
  for (std::string_view item : list) result.push_back(std::string(item));
  return result;
}

/// Bytes of a buffer for an element of a kernel's domain, in the precision of the world; of lists an index.
std::size_t row_bytes(Buffer buffer, const World& world) {
  if (of_table(buffer)) return world.state().tables.row_bytes(buffer);
  return schema(buffer).reals == 0 ? sizeof(std::uint32_t) : schema(buffer).reals * world.state().tables.real_bytes();
}
constexpr const char* domains[] = {"body",  "contact",       "contact",         "contact of a tree",
                                   "joint", "joint",         "joint of a tree", "tree",
                                   "body",  "pair of bodies"};

/// An element of the kernel's domain, in words.
std::string domain(const PlanEntry& entry, const World& world) {
  if (!entry.own) return domains[std::size_t(schema(entry.kernel).domain)];
  const Table table = entry.own->table;
  const std::string row = table == Table::body    ? "body"
                          : table == Table::joint ? "joint"
                                                  : "row of " + std::string(world.state().own.table_name(table));
  return entry.own->form == OwnKernel::Form::pair ? "pair of " + (table == Table::body ? "bodies" : row + "s") : row;
}

/// Which bytes an element of each kernel reads and writes, and what a step holds of one.
struct Bytes {
  std::size_t read = 0, written = 0;
};
Bytes bytes_of(const PlanEntry& entry, const World& world) {
  Bytes sum;
  for (const Access& a : accesses(entry)) {
    const std::size_t bytes = row_bytes(a.buffer, world);
    sum.read += bytes;
    if (a.write) sum.written += bytes;
  }
  return sum;
}

Json entry_json(const PlanEntry& entry, const World& world) {
  constexpr const char* kinds[] = {"kernel", "upload", "download", "collide"};
  Json json{{"kind", kinds[std::size_t(entry.kind)]}, {"place", name(entry.place)}, {"substep", entry.substep}};
  if (entry.transfers()) {
    json["buffer"] = std::string(buffer_name(entry));
    json["bytes"] = entry.bytes;
    return json;
  }
  json["stage"] = std::string(stage_name(entry));
  json["kernel"] = std::string(kernel_name(entry));
  json["octave"] = entry.octave;
  json["phase"] = std::string(phase_name(entry));
  json["barrier"] = entry.barrier;
  json["reads"] = names(reads(entry));
  json["writes"] = names(writes(entry));
  const Bytes bytes = bytes_of(entry, world);
  json["domain"] = domain(entry, world);
  json["bytes_read"] = bytes.read;
  json["bytes_written"] = bytes.written;
  return json;
}

/// Buffers that the plan binds, by place, and those of bodies, joints and contacts that it does not need.
Json buffers_json(const StepPlan& plan, const World& world) {
  Json bound = Json::array(), not_needed = Json::array();
  std::vector<bool> used(buffer_count);
  for (const PlanBinding& b : plan.bindings) {
    const auto [buffer, table] = world.state().own.names(b.buffer);
    if (!is_own(b.buffer)) used[std::size_t(b.buffer)] = true;
    bound.push_back({{"buffer", buffer},
                     {"table", table},
                     {"place", name(b.place)},
                     {"bytes_per_row", row_bytes(b.buffer, world)}});
  }
  for (std::size_t b = 0; b < buffer_count; ++b)
    if (!used[b]) not_needed.push_back(schema(Buffer(b)).name);
  return {{"bound", bound}, {"not_bound", not_needed}};
}

std::string bytes_text(const StepPlan& plan, const World& world) {
  std::string text = "bytes an element (read, written; what a kernel writes it reads, too)\n";
  std::vector<std::string_view> seen;
  for (const PlanEntry& entry : plan.entries) {
    if (entry.kind != PlanEntry::Kind::kernel || std::ranges::find(seen, kernel_name(entry)) != seen.end()) continue;
    seen.push_back(kernel_name(entry));
    const Bytes bytes = bytes_of(entry, world);
    std::string line = "  " + std::string(kernel_name(entry));
    line.resize(std::max<std::size_t>(line.size() + 1, 26), ' ');
    text +=
        line + std::to_string(bytes.read) + " " + std::to_string(bytes.written) + " a " + domain(entry, world) + "\n";
  }
  std::size_t per_body = 0;
  const Json buffers = buffers_json(plan, world);
  for (const Json& b : buffers["bound"])
    if (b["table"] == "body") per_body += b["bytes_per_row"].get<std::size_t>();
  text += "bytes a body in the buffers of this plan: " + std::to_string(per_body) + "\nnot bound:";
  for (const Json& name : buffers["not_bound"]) text += " " + name.get<std::string>();
  return text + "\n";
}

Json plan_json(const Simulation& simulation, const StepPlan& plan) {
  Json entries = Json::array(), left_out = Json::array();
  for (const PlanEntry& entry : plan.entries) entries.push_back(entry_json(entry, simulation.world));
  for (const LeftOut& item : plan.left_out) left_out.push_back({{"what", item.what}, {"why", item.why}});
  const TransferBytes transfers = transfer_bytes(plan);
  return {{"scene", simulation.scene.name},
          {"count", simulation.scene.count},
          {"stage_backends", stage_backends(simulation.setup.settings)},
          {"substeps", plan.substeps},
          {"entries", entries},
          {"flight", plan.flight},
          {"uploads_bytes", transfers.up},
          {"downloads_bytes", transfers.down},
          {"left_out", left_out},
          {"buffers", buffers_json(plan, simulation.world)},
          {"memory", memory_json(simulation)}};
}

std::string plan_csv(const StepPlan& plan, const World& world) {
  std::string text = "kind,place,substep,stage,name,phase,barrier,bytes\n";
  for (const PlanEntry& entry : plan.entries) {
    const Json json = entry_json(entry, world);
    const bool kernel = !entry.transfers();
    text += json["kind"].get<std::string>() + "," + name(entry.place) + "," + std::to_string(entry.substep) + ",";
    text += std::string(kernel ? stage_name(entry) : "") + "," +
            std::string(kernel ? kernel_name(entry) : buffer_name(entry)) + ",";
    text += std::string(kernel ? phase_name(entry) : "") + "," + (entry.barrier ? "1" : "0") + "," +
            (kernel ? "" : std::to_string(entry.bytes)) + "\n";
  }
  return text;
}

}  // namespace

int plan(const RunOptions& options) {
  const auto setup = resolve(options, 0);
  if (!setup) return fail(setup.error());
  auto files = ResultFiles::open(options.json, options.csv);
  if (!files) return fail(files.error());
  auto simulation = Simulation::make(*setup);
  if (!simulation) return fail(simulation.error());
  for (std::uint64_t step = 0; step < setup->steps; ++step)
    if (const StepReport& report = simulation->stepper.step(simulation->world, setup->dt); !report)
      return fail(report.error);
  const auto plan = simulation->stepper.plan_for(simulation->world, setup->dt);
  if (!plan) return fail(plan.error());

  if (auto status = files->write(plan_json(*simulation, *plan), plan_csv(*plan, simulation->world)); !status)
    return fail(status.error());
  if (files->printed()) std::cout << to_text(*plan) << bytes_text(*plan, simulation->world);
  return exit_ok;
}

}  // namespace pcphys::command
