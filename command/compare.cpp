// pcphys compare: scenes in pcphys and in the other engines that were found when it was built.
#include <algorithm>
#include <cmath>
#include <iostream>

#include "commands.h"
#include "compare_table.h"
#include "report.h"

namespace pcphys::command {
namespace {

/// Which peers take part when none is named: Runge and Kutta's method is for smooth motion.
constexpr const char* usual = "bullet,ode,ode-dantzig,mujoco";

Result<std::vector<Setup>> setups(const CompareOptions& options, RunOptions run_options) {
  std::vector<std::string> names = options.scenes;
  if (names.empty())
    for (const scenes::SceneInfo& info : scenes::list())
      if (!info.own_kernels) names.push_back(std::string(info.name));
  std::vector<Setup> result;
  if (run_options.sleep == "on")
    return Error{ErrorCode::bad_argument,
                 "--sleep on is not for compare: the peers keep everything awake; leave it off."};
  for (const std::string& name : names) {
    const auto entry = scene_of(name);
    if (!entry) return entry.error();
    RunOptions own = run_options;
    own.scene = entry->scene;
    own.timings = "off";
    if (entry->count) own.count = entry->count;
    const auto setup = resolve(own, 600);
    if (!setup) return setup.error();
    World world;  // an unknown scene or a bad count is noticed before hours of others
    const auto scene = scenes::make(setup->scene, setup->scene_options, world);
    if (!scene) return scene.error();
    if (!scene->kernels.empty())
      return Error{ErrorCode::bad_argument,
                   "The forces of scene " + scene->name +
                       " are a kernel of its own, which no other engine runs; compare another scene."};
    result.push_back(*setup);
  }
  return result;
}

Json peers_json() {
  Json list = Json::array();
  for (const peers::Variant& variant : peers::variants())
    list.push_back({{"name", variant.name},
                    {"engine", variant.engine},
                    {"solver", variant.solver},
                    {"precision", variant.precision},
                    {"found", variant.found},
                    {"version", variant.found ? Json(variant.version) : Json(nullptr)},
                    {"package", variant.package}});
  return list;
}

Result<Contest> hold(const Setup& setup, std::span<const std::string> names, const CompareOptions& options) {
  peers::Options peer_options;
  peer_options.substeps = int(options.peer_substeps);
  peer_options.iterations = int(options.peer_iterations);
  auto contest = Contest::make(setup, names, peer_options);
  if (!contest) return contest.error();
  Progress progress(setup.scene, setup.steps);
  const Status status = contest->run(options.budget, [&](std::uint64_t done) { progress.show(done); });
  if (!status) return Error{status.error().code, "A step of " + setup.scene + " failed. " + status.error().message};
  return contest;
}

}  // namespace

int compare(const CompareOptions& options, const RunOptions& run_options) {
  if (auto status = check(options); !status) return fail(status.error());
  const auto names = peer_names(options.peers.empty() ? usual : options.peers);
  if (!names) return fail(names.error());
  const auto all = setups(options, run_options);
  if (!all) return fail(all.error());
  auto files = ResultFiles::open(run_options.json, run_options.csv);
  if (!files) return fail(files.error());

  Json rows = Json::array();
  std::string csv;
  bool sound = true;
  for (const Setup& setup : *all) {
    const auto contest = hold(setup, *names, options);
    if (!contest) return fail(contest.error());
    const Json found = compare_rows(*contest);
    csv += compare_csv(found, csv.empty());
    rows.insert(rows.end(), found.begin(), found.end());
    const scenes::Metrics& own = contest->score(0).end;
    sound = sound && own.escapes.through == 0 && own.nonfinite == 0;
    if (files->printed())
      std::cout << (rows.size() == found.size() ? "" : "\n") << compare_text(*contest) << std::flush;
  }
  const Setup& first = all->front();
  const Json report{{"steps", first.steps},
                    {"dt", first.dt},
                    {"substeps", first.settings.substeps},
                    {"precision", first.precision == Precision::f64 ? "double" : "float"},
                    {"backend", backend_name(first.settings)},
                    {"peers", peers_json()},
                    {"rows", rows}};
  if (auto status = files->write(report, csv); !status) return fail(status.error());
  if (sound) return exit_ok;
  std::cerr << "pcphys: bodies escaped or are not finite in pcphys; see the table or --json.\n";
  return exit_unsound;
}

}  // namespace pcphys::command
