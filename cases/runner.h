// Runs cases over precisions, step lengths and engines, and makes rows of what they found.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "case.h"

namespace pcphys::cases {

/// One finding, with what it was found with. docs/command.md lists the fields.
struct Row {
  std::string case_name, title, variant, backend;
  Precision precision = Precision::f64;
  double dt = 0;
  std::uint32_t substeps = 1;
  std::string metric;
  double error = 0;
  std::optional<double> must, target;
  bool bounded = true;          // Setting::bounded
  bool lost = false;            // Variant::lost_at
  std::optional<double> floor;  // Variant::floor
  bool pass = true;
  double ns_per_body_step = 0, total_ms = 0;
  std::string peer;

  std::optional<double> order;  // of the metric over the step lengths of its variant
  // hash beside the cpu's: "equal", "differs", "refused" (see failure), or empty when it was not asked for
  std::string gl;
  std::string failure;  // why a step was refused
};

struct Selection {
  std::vector<std::string> names;  // empty: all of the group
  std::string groups = "A";
  std::string variant;  // only the one of this name; where none has it, those whose names start with it
  bool single = true, twice = true;
  std::optional<double> dt;
  bool slow = false;    // what takes long too
  bool coarse = false;  // what has no bounds too: Variant::coarse and so on
  bool gl = false;      // the first steps of every trial on gl as well
  int device = -1;      // of gl, as EGL numbers them; -1: the first that works
  bool first = false;   // those first steps alone: hashes, no errors
  int repeats = 1;      // above 1, times are medians of so many runs in which nothing is read
};

/// Errors: unknown_name for a case that is not in the groups, and where no variant is named, or starts, as asked.
Status check(const Selection& selection);

/// How many trials it takes, `engines` engines each.
std::size_t count_trials(const Selection& selection, std::span<Engine* const> engines);

/// Rows come in the order of the cases; `tell` sees each variant's when they are complete, `progress` counts trials.
std::vector<Row> run(const Selection& selection, std::span<Engine* const> engines,
                     const std::function<void(std::span<const Row>)>& tell,
                     const std::function<void(std::size_t)>& progress);

/// Slope of log(error) over log(dt), by least squares over the three smallest steps above the floor of rounding;
/// none where fewer than two are. `errors` belong to `steps`, in any order.
std::optional<double> order_of_convergence(std::span<const double> steps, std::span<const double> errors,
                                           Precision precision);

}  // namespace pcphys::cases
