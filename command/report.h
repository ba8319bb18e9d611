// What a run found, as JSON, as a table for people, and as CSV rows.
#pragma once
#include <string>

#include "output.h"
#include "simulation.h"

namespace pcphys::command {

std::string hash_text(std::uint64_t hash);

/// "cpu", "gl" or "mixed".
std::string backend_name(const StepSettings& settings);
Json stage_backends(const StepSettings& settings);
/// The device of every place that is used, in one line.
std::string device_name(const Simulation& simulation);

/// What buffers take, and which have none.
Json memory_json(const Simulation& simulation);
/// The object of `run --json`: the keys of docs/command.md.
Json to_json(const Simulation& simulation, const Outcome& outcome, bool poses);
std::string to_text(const Simulation& simulation, const Outcome& outcome);

/// One row a step.
class StepRows {
 public:
  explicit StepRows(const Simulation& simulation);
  void add(std::uint64_t step, double ms, const StepReport& report);
  const std::string& text() const { return text_; }

 private:
  const Simulation& simulation_;
  std::string text_;
};

/// Why the result must not be trusted; empty when all is well.
std::string unsound(const Outcome& outcome);

}  // namespace pcphys::command
