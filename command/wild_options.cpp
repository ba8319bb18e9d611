// What stands on the command line of `wild`.
#include <CLI/CLI.hpp>
#include <limits>

#include "options.h"
#include "wild/run.h"

namespace pcphys::command {
namespace {

/// Of all families, where neither a time nor a number of scenes is asked for [s].
constexpr double usual_budget = 60;

Error bad(const std::string& sentence) { return {ErrorCode::bad_argument, sentence}; }

Status check_numbers(const WildOptions& options) {
  constexpr long long many = 1'000'000'000'000;
  if (options.seed)
    if (auto status = check_range("seed", *options.seed, 0, std::numeric_limits<long long>::max() - many); !status)
      return status;
  if (options.count)
    if (auto status = check_range("count", *options.count, 1, many); !status) return status;
  if (auto status = check_range("threads", options.threads, 0, 256); !status) return status;
  if (auto status = check_range("bits", options.bits, 0, many); !status) return status;
  if (auto status = check_range("bits-gl", options.bits_gl, 0, many); !status) return status;
  return options.budget ? check_budget(*options.budget) : Status();
}

Status set_play(const WildOptions& options, wild::RunOptions& run) {
  if (auto status = check_choice("precision", options.precision, {"float", "double", "both"}); !status) return status;
  if (auto status = check_choice("backend", options.backend, {"cpu", "gl"}); !status) return status;
  if (auto status = check_choice("lanes", options.lanes, {"auto", "1", "4", "8"}); !status) return status;
  run.precisions.clear();
  if (options.precision != "double") run.precisions.push_back(Precision::f32);
  if (options.precision != "float") run.precisions.push_back(Precision::f64);
  run.play.place = options.backend == "gl" ? Place::gl : Place::cpu;
  run.play.lanes = options.lanes == "auto" ? 0 : std::uint32_t(options.lanes[0] - '0');
  run.play.threads = std::uint32_t(options.threads);
  if (run.play.lanes == 8 && options.precision != "float")
    return bad("--lanes 8 is for --precision float; double has 1 and 4 lanes.");
  return {};
}

}  // namespace

void add_wild_options(CLI::App& app, WildOptions& options) {
  app.add_option("FAMILY", options.families, "families of scenes; all when none is given");
  app.add_flag("--list", options.list, "list the families");
  app.add_option("--seed", options.seed,
                 "play this one scene and print every measure; with --count or --budget the first one");
  app.add_option("--count", options.count, "scenes of each family");
  app.add_option("--budget", options.budget,
                 "seconds for all families together (default: 60, without --seed and --count)");
  app.add_option("--precision", options.precision, "float, double or both")->capture_default_str();
  app.add_option("--backend", options.backend, "cpu or gl, for all stages")->capture_default_str();
  add_lanes_and_threads(app, options.lanes, options.threads);
  app.add_option("--peers", options.peers, "the same scenes in other engines: all, none, or names with commas between")
      ->capture_default_str();
  app.add_option("--bits", options.bits,
                 "replay every so many seeds in other ways that must give the same bits; 0: none")
      ->capture_default_str();
  app.add_option("--bits-gl", options.bits_gl, "replay every so many seeds on OpenGL too; 0: none")
      ->capture_default_str();
  app.add_flag("--shrink", options.shrink,
               "stop at the first scene that breaks, and print the smallest one that still does as a C++ program");
  app.add_option("--shrink-to", options.shrink_to, "write that program to this file, and the rest to standard output");
  app.add_option("--json", options.json, "write the result to this file; - is standard output");
  app.add_option("--csv", options.csv, "write a row a family and measure to this file");
}

bool single(const WildOptions& options) { return options.seed && !options.count && !options.budget; }

Result<wild::RunOptions> resolve(const WildOptions& options) {
  wild::RunOptions run;
  if (auto status = check_numbers(options); !status) return status.error();
  if (auto status = set_play(options, run); !status) return status.error();
  auto peers = found_peers(options.peers);
  if (!peers) return peers.error();
  run.families = options.families;
  run.peers = std::move(*peers);
  if (options.seed) run.first_seed = std::uint64_t(*options.seed);
  if (options.count) run.count = std::uint64_t(*options.count);
  if (options.budget) run.budget = *options.budget;
  run.bits_every = std::uint64_t(options.bits);
  run.gl_every = std::uint64_t(options.bits_gl);
  if (single(options)) {
    run.count = 1;
    run.bits_every = 1;  // what broke in a run must break here, whatever share of its seeds was replayed
    run.gl_every = options.bits_gl > 0 ? 1 : 0;
  } else if (!options.count && !options.budget) {
    run.budget = usual_budget;
  }
  return run;
}

}  // namespace pcphys::command
