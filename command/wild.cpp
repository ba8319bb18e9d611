// pcphys wild: random scenes, judged by what holds in all of them.
#include <algorithm>
#include <cmath>
#include <iostream>

#include "commands.h"
#include "pcphys/device.h"
#include "wild/shrink.h"
#include "wild_report.h"

namespace pcphys::command {
namespace {

Status check_families(const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (const auto found = wild::find_family(name); !found) return found.error();
  return {};
}

Status check_gl(const wild::RunOptions& run) {
  if (run.play.place == Place::cpu && run.gl_every == 0) return {};
  const GlReport report = probe_gl(-1);
  if (report.usable) return {};
  return Error{ErrorCode::unavailable, report.problem};
}

int list_families() {
  for (const wild::Family& family : wild::families())
    std::printf("%-10s %s\n", std::string(family.name).c_str(), std::string(family.description).c_str());
  return exit_ok;
}

/// With `stop`, the first scene that breaks ends the run.
Result<std::vector<wild::Summary>> play(const wild::RunOptions& run, bool stop) {
  const std::uint64_t families = run.families.empty() ? wild::families().size() : run.families.size();
  const bool by_time = run.budget > 0;
  Progress progress("wild", by_time ? std::uint64_t(std::ceil(run.budget)) : families * run.count,
                    by_time ? "second" : "scene");
  return wild::run(run, [&](const wild::RunState& state) {
    progress.show(by_time
                      ? std::clamp<std::uint64_t>(std::uint64_t(state.seconds), 1, std::uint64_t(std::ceil(run.budget)))
                      : state.scenes);
    return !(stop && state.broken > 0);
  });
}

const wild::Summary* first_broken(std::span<const wild::Summary> summaries) {
  for (const wild::Summary& summary : summaries)
    if (summary.engine == "pcphys" && !summary.listed.empty()) return &summary;
  return nullptr;
}

Status shrink_first(const wild::Summary& summary, const wild::RunOptions& run, OutputFile& file) {
  const wild::Broken& broken = summary.listed.front();
  const auto scene = wild::draw(summary.family, broken.seed);
  if (!scene) return scene.error();
  wild::PlayOptions play = run.play;
  play.precision = summary.precision == "double" ? Precision::f64 : Precision::f32;
  const std::size_t calls = scene->calls.size();
  Progress progress("wild: shrinking " + summary.family + " " + std::to_string(broken.seed), calls, "call");
  const wild::Scene smallest = wild::shrink(*scene, play, broken.measure, [&](std::size_t left, std::uint64_t) {
    progress.show(std::clamp<std::size_t>(calls - left, 1, calls));
    return true;
  });
  wild::Verdict verdict = wild::judge(smallest, play);
  if (broken.measure == wild::Measure::bits) wild::judge_bits(smallest, play, false, verdict);
  return file.write(wild::as_program(smallest, play, verdict));
}

}  // namespace

int wild(const WildOptions& options) {
  if (options.list) return list_families();
  if (auto status = check_families(options.families); !status) return fail(status.error());
  const auto run = resolve(options);
  if (!run) return fail(run.error());
  if (auto status = check_gl(*run); !status) return fail(status.error());
  const bool shrinks = options.shrink || !options.shrink_to.empty();
  const bool printed = shrinks && options.shrink_to.empty();
  ResultFiles files;
  OutputFile program;
  const Status opened =
      open_outputs({{"--json", options.json, files.json},
                    {"--csv", options.csv, files.csv},
                    {printed ? "--shrink" : "--shrink-to", printed ? "-" : options.shrink_to, program}});
  if (!opened) return fail(opened.error());

  const auto summaries = play(*run, shrinks);
  if (!summaries) return fail(summaries.error());
  if (files.printed() && !program.standard_output()) {
    if (single(options))
      for (const wild::Summary& summary : *summaries) print_scene(summary, run->first_seed);
    else
      print_run(*summaries, *run);
    std::fflush(stdout);
  }
  if (auto status = files.write(to_json(*summaries, *run), to_csv(*summaries)); !status) return fail(status.error());
  const wild::Summary* broken = first_broken(*summaries);
  if (!broken) {
    if (shrinks) std::cerr << "pcphys: nothing broke, so there is nothing to shrink.\n";
    return exit_ok;
  }
  if (shrinks)
    if (auto status = shrink_first(*broken, *run, program); !status) return fail(status.error());
  return exit_failed;
}

}  // namespace pcphys::command
