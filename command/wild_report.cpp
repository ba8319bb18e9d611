#include "wild_report.h"

#include <cmath>
#include <cstdio>

#include "pcphys/version.h"
#include "peers/peer.h"

namespace pcphys::command {
namespace {

using wild::Broken;
using wild::Measure;
using wild::Spread;
using wild::Summary;

std::string figure(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string name_of(Measure measure) {
  return measure == Measure::count ? "failed step" : std::string(wild::info(measure).name);
}

/// None of shares.
std::string unit_of(Measure measure) {
  const std::string unit(wild::info(measure).unit);
  return unit.empty() || unit == "1" ? "" : unit;
}

std::string bound_text(const Spread& spread) {
  if (!spread.least_bound) return "-";
  const std::string least = figure(*spread.least_bound), largest = figure(*spread.largest_bound);
  return least == largest ? least : least + " to " + largest;
}

/// "energy is 6.4 (at most 1e-05) after step 12".
std::string sentence(const Broken& broken) {
  const std::string step = " after step " + std::to_string(broken.step);
  if (broken.measure == Measure::count) return "a step could not be made" + step + ": " + broken.failure;
  return name_of(broken.measure) + " is " + figure(broken.value) + " (at most " + figure(broken.bound) + ")" + step;
}

template <class Act> void each_measure(const Summary& summary, Act act) {
  for (std::size_t m = 0; m < wild::measure_count; m++)
    if (summary.of[m].runs > 0) act(Measure(m), summary.of[m]);
}

void print_families(std::span<const Summary> summaries) {
  std::printf("%-10s %-12s %-6s %9s %8s  %-16s %10s %10s %10s %8s\n", "family", "engine", "", "runs", "broken", "worst",
              "", "bound", "seed", "ns/body");
  for (const Summary& s : summaries) {
    std::printf("%-10s %-12s %-6s %9llu %8llu  ", s.family.c_str(), s.engine.c_str(), s.precision.c_str(),
                (unsigned long long)s.runs, (unsigned long long)s.broken);
    if (s.worst)
      std::printf("%-16s %10s %10s %10llu", name_of(s.worst->measure).c_str(), figure(s.worst->value).c_str(),
                  figure(s.worst->bound).c_str(), (unsigned long long)s.worst->seed);
    else
      std::printf("%-16s %10s %10s %10s", "-", "", "", "");
    std::printf(" %8.0f\n", s.ns_per_body_step());
  }
  for (const Summary& s : summaries)
    if (s.refused > 0)
      std::printf("%s, %s: %llu scenes not played: %s\n", s.family.c_str(), s.engine.c_str(),
                  (unsigned long long)s.refused, s.why_refused.c_str());
}

void print_spreads(std::span<const Summary> summaries) {
  std::printf("\n%-10s %-12s %-6s %-18s %9s %8s %10s %10s %10s %10s  %-20s %10s\n", "family", "engine", "", "measure",
              "runs", "broken", "median", "99 %", "99.9 %", "worst", "bound", "seed");
  for (const Summary& s : summaries)
    each_measure(s, [&](Measure measure, const Spread& spread) {
      const std::string unit = unit_of(measure);
      const std::string with_unit = name_of(measure) + (unit.empty() ? "" : " [" + unit + "]");
      const std::string seed = spread.worst > 0 ? std::to_string(spread.seed) : "-";
      std::printf("%-10s %-12s %-6s %-18s %9llu %8llu %10s %10s %10s %10s  %-20s %10s\n", s.family.c_str(),
                  s.engine.c_str(), s.precision.c_str(), with_unit.c_str(), (unsigned long long)spread.runs,
                  (unsigned long long)spread.broken, figure(spread.median).c_str(), figure(spread.p99).c_str(),
                  figure(spread.p999).c_str(), figure(spread.worst).c_str(), bound_text(spread).c_str(), seed.c_str());
    });
}

void print_broken(std::span<const Summary> summaries, const wild::RunOptions& options) {
  for (const Summary& s : summaries) {
    if (s.engine != "pcphys" || s.listed.empty()) continue;
    std::printf("\n");
    for (const Broken& broken : s.listed)
      std::printf("%s, seed %llu, %s: %s; %s\n", s.family.c_str(), (unsigned long long)broken.seed, s.precision.c_str(),
                  sentence(broken).c_str(), replay(s, broken.seed, options).c_str());
    if (s.broken > s.listed.size())
      std::printf("%s, %s: and %llu more\n", s.family.c_str(), s.precision.c_str(),
                  (unsigned long long)(s.broken - s.listed.size()));
  }
}

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

/// Numbers that are not finite are null.
Json to_json(const Broken& broken, const Summary& summary, const wild::RunOptions& options) {
  const bool own = summary.engine == "pcphys";
  return {{"seed", broken.seed},
          {"measure", broken.measure == Measure::count ? Json(nullptr) : Json(name_of(broken.measure))},
          {"value", broken.value},
          {"bound", broken.bound},
          {"step", broken.step},
          {"failure", broken.failure.empty() ? Json(nullptr) : Json(broken.failure)},
          {"replay", own ? Json(replay(summary, broken.seed, options)) : Json(nullptr)}};
}

Json to_json(Measure measure, const Spread& spread, std::uint64_t most_broken) {
  return {{"measure", name_of(measure)},
          {"runs", spread.runs},
          {"broken", spread.broken},
          {"most_broken", most_broken},
          {"median", spread.median},
          {"p99", spread.p99},
          {"p999", spread.p999},
          {"worst", spread.worst},
          {"least_bound", or_null(spread.least_bound)},
          {"largest_bound", or_null(spread.largest_bound)},
          {"seed", spread.seed},
          {"step", spread.step}};
}

Json to_json(const Summary& summary, const wild::RunOptions& options) {
  Json measures = Json::array(), listed = Json::array();
  each_measure(summary, [&](Measure measure, const Spread& spread) {
    measures.push_back(to_json(measure, spread, summary.most_broken[std::size_t(measure)]));
  });
  for (const Broken& broken : summary.listed) listed.push_back(to_json(broken, summary, options));
  return {{"engine", summary.engine},
          {"family", summary.family},
          {"precision", summary.precision},
          {"runs", summary.runs},
          {"broken", summary.broken},
          {"failed", summary.failed},
          {"refused", summary.refused},
          {"why_refused", summary.why_refused.empty() ? Json(nullptr) : Json(summary.why_refused)},
          {"steps", summary.steps},
          {"body_steps", summary.body_steps},
          {"seconds", summary.seconds},
          {"ns_per_body_step", summary.ns_per_body_step()},
          {"worst", summary.worst ? to_json(*summary.worst, summary, options) : Json(nullptr)},
          {"measures", measures},
          {"broken_scenes", listed}};
}

Json options_json(const wild::RunOptions& options) {
  Json precisions = Json::array();
  for (const Precision precision : options.precisions) precisions.push_back(wild::name(precision));
  return {{"first_seed", options.first_seed},
          {"count", options.count > 0 ? Json(options.count) : Json(nullptr)},
          {"budget", options.budget > 0 ? Json(options.budget) : Json(nullptr)},
          {"precisions", precisions},
          {"backend", options.play.place == Place::gl ? "gl" : "cpu"},
          {"lanes", options.play.lanes},
          {"threads", options.play.threads},
          {"bits", options.bits_every},
          {"bits_gl", options.gl_every}};
}

}  // namespace

std::string replay(const Summary& summary, std::uint64_t seed, const wild::RunOptions& options) {
  std::string line = "pcphys wild " + summary.family + " --seed " + std::to_string(seed);
  if (summary.precision == "double") line += " --precision double";
  const wild::PlayOptions& play = options.play;
  if (play.place == Place::gl) line += " --backend gl";
  if (play.lanes != 0) line += " --lanes " + std::to_string(play.lanes);
  if (play.threads != 1) line += " --threads " + std::to_string(play.threads);
  if (options.gl_every > 0 && seed % options.gl_every == 0) line += " --bits-gl 1";
  return line;
}

void print_run(std::span<const Summary> summaries, const wild::RunOptions& options) {
  print_families(summaries);
  print_spreads(summaries);
  print_broken(summaries, options);
}

void print_scene(const Summary& summary, std::uint64_t seed) {
  std::printf("%s, seed %llu, %s, %s: ", summary.family.c_str(), (unsigned long long)seed, summary.engine.c_str(),
              summary.precision.c_str());
  if (summary.runs == 0) return void(std::printf("not played: %s\n", summary.why_refused.c_str()));
  std::printf("%llu steps, %s\n", (unsigned long long)summary.steps, summary.broken > 0 ? "broken" : "holds");
  if (summary.failed > 0) std::printf("  %s\n", sentence(summary.listed.front()).c_str());
  each_measure(summary, [&](Measure measure, const Spread& spread) {
    const auto& about = wild::info(measure);
    const std::string value = figure(spread.worst) + " " + unit_of(measure);
    const std::string bound = spread.least_bound ? "at most " + figure(*spread.least_bound) : "";
    std::printf("  %-16s %-16s  %-18s %-6s  after step %5llu  (%s)\n", std::string(about.name).c_str(), value.c_str(),
                bound.c_str(), spread.broken > 0 ? "BROKEN" : "", (unsigned long long)spread.step,
                std::string(about.meaning).c_str());
  });
}

Json to_json(std::span<const Summary> summaries, const wild::RunOptions& options) {
  Json measures = Json::array(), families = Json::array(), peers = Json::array(), list = Json::array();
  for (std::size_t m = 0; m < wild::measure_count; m++) {
    const auto& about = wild::info(Measure(m));
    measures.push_back({{"name", about.name}, {"unit", about.unit}, {"meaning", about.meaning}});
  }
  for (const wild::Family& family : wild::families())
    families.push_back({{"name", family.name}, {"description", family.description}});
  for (const std::string& name : options.peers)
    for (const peers::Variant& variant : peers::variants())
      if (variant.name == name)
        peers.push_back(
            {{"name", name}, {"engine", variant.engine}, {"solver", variant.solver}, {"version", variant.version}});
  for (const Summary& summary : summaries) list.push_back(to_json(summary, options));
  return {{"version", PCPHYS_VERSION},
          {"options", options_json(options)},
          {"measures", measures},
          {"families", families},
          {"peers", peers},
          {"summaries", list}};
}

std::string to_csv(std::span<const Summary> summaries) {
  std::string table =
      "engine,family,precision,measure,runs,broken,median,p99,p999,worst,least_bound,largest_bound,seed,step\n";
  for (const Summary& s : summaries)
    each_measure(s, [&](Measure measure, const Spread& spread) {
      const auto bound = [](const std::optional<double>& value) { return value ? figure(*value) : ""; };
      table += s.engine + "," + s.family + "," + s.precision + "," + name_of(measure) + "," +
               std::to_string(spread.runs) + "," + std::to_string(spread.broken) + "," + figure(spread.median) + "," +
               figure(spread.p99) + "," + figure(spread.p999) + "," + figure(spread.worst) + "," +
               bound(spread.least_bound) + "," + bound(spread.largest_bound) + "," + std::to_string(spread.seed) + "," +
               std::to_string(spread.step) + "\n";
    });
  return table;
}

}  // namespace pcphys::command
