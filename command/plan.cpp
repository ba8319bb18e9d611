// pcphys plan SCENE: what a step runs, where, and what it leaves out.
#include <iostream>

#include "commands.h"
#include "output.h"
#include "report.h"
#include "simulation.h"

namespace pcphys::command {
namespace {

Json names(const std::vector<std::string_view>& list) {
  Json result = Json::array();
  for (std::string_view item : list) result.push_back(std::string(item));
  return result;
}

Json entry_json(const PlanEntry& entry) {
  Json json{{"kind", entry.kind == PlanEntry::Kind::kernel   ? "kernel"
                     : entry.kind == PlanEntry::Kind::upload ? "upload"
                                                             : "download"},
            {"place", name(entry.place)},
            {"substep", entry.substep}};
  if (entry.kind != PlanEntry::Kind::kernel) {
    json["buffer"] = std::string(buffer_name(entry));
    return json;
  }
  json["stage"] = std::string(stage_name(entry));
  json["kernel"] = std::string(kernel_name(entry));
  json["octave"] = entry.octave;
  json["phase"] = std::string(phase_name(entry));
  json["barrier"] = entry.barrier;
  json["reads"] = names(reads(entry));
  json["writes"] = names(writes(entry));
  return json;
}

Json plan_json(const Simulation& simulation, const StepPlan& plan) {
  Json entries = Json::array(), left_out = Json::array();
  for (const PlanEntry& entry : plan.entries) entries.push_back(entry_json(entry));
  for (const LeftOut& item : plan.left_out) left_out.push_back({{"what", item.what}, {"why", item.why}});
  return {{"scene", simulation.scene.name},
          {"count", simulation.scene.count},
          {"stage_backends", stage_backends(simulation.setup.settings)},
          {"substeps", plan.substeps},
          {"entries", entries},
          {"left_out", left_out}};
}

std::string plan_csv(const StepPlan& plan) {
  std::string text = "kind,place,substep,stage,name,phase,barrier\n";
  for (const PlanEntry& entry : plan.entries) {
    const Json json = entry_json(entry);
    const bool kernel = entry.kind == PlanEntry::Kind::kernel;
    text += json["kind"].get<std::string>() + "," + name(entry.place) + "," + std::to_string(entry.substep) + ",";
    text +=
        std::string(kernel ? stage_name(entry) : "") + "," + std::string(kernel ? kernel_name(entry) : buffer_name(entry)) + ",";
    text += std::string(kernel ? phase_name(entry) : "") + "," + (entry.barrier ? "1" : "0") + "\n";
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
    if (const StepReport& report = simulation->stepper.step(simulation->world, setup->dt); !report) return fail(report.error);
  const auto plan = simulation->stepper.plan_for(simulation->world, setup->dt);
  if (!plan) return fail(plan.error());

  if (auto status = files->write(plan_json(*simulation, *plan), plan_csv(*plan)); !status) return fail(status.error());
  if (files->printed()) std::cout << to_text(*plan);
  return exit_ok;
}

}  // namespace pcphys::command
