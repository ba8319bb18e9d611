// What stands on the command line of `compare`.
#include <CLI/CLI.hpp>
#include <charconv>

#include "options.h"

namespace pcphys::command {

void add_compare_options(CLI::App& app, CompareOptions& options) {
  app.add_option("SCENE", options.scenes,
                 "names of scenes, with a count of their own as balls:1000; all when none is given");
  app.add_option(
      "--peers", options.peers,
      "bullet, ode, ode-dantzig, mujoco, mujoco-rk4 with commas between; all or none (default: all but the last)");
  app.add_option("--peer-substeps", options.peer_substeps, "sub-steps of the peers; 0: each one's own")
      ->capture_default_str();
  app.add_option("--peer-iterations", options.peer_iterations, "of their solvers; 0: each one's own")
      ->capture_default_str();
  app.add_option("--budget", options.budget, "a peer stops after this time in a scene [s]")->capture_default_str();
}

Result<SceneEntry> scene_of(const std::string& text) {
  const std::size_t colon = text.find(':');
  SceneEntry entry{text.substr(0, colon), {}};
  if (colon == std::string::npos) return entry;
  long long count = 0;
  const char *begin = text.data() + colon + 1, *end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(begin, end, count);
  if (error != std::errc{} || stop != end)
    return Error{ErrorCode::bad_argument,
                 "The scene '" + text + "' has no number after its colon; give for example balls:1000."};
  entry.count = count;
  return entry;
}

Status check(const CompareOptions& options) {
  if (auto status = check_range("peer-substeps", options.peer_substeps, 0, 1000); !status) return status;
  if (auto status = check_range("peer-iterations", options.peer_iterations, 0, 100000); !status) return status;
  return check_budget(options.budget);
}

}  // namespace pcphys::command
