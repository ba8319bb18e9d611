// pcphys_architectures: the same scenes and the same kernels in four designs (docs/architectures.md). Times, memory,
// gathers and uploads as JSON, from which tools/architectures_report.py makes the page.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>

#include "check.h"
#include "measure.h"

namespace {

using namespace pcphys::architectures;

struct Options {
  std::vector<std::size_t> sizes = {100, 1'000, 10'000, 100'000, 1'000'000};
  std::size_t rounds = 3, steps = 10;
  std::string json = "-", design, scene = "flight", history = "fresh";
  bool check = false, no_gl = false, transfers = false;
};

// of more bodies a round takes too long to repeat
constexpr std::size_t most_in_rounds = 10'000;

class Progress {
 public:
  explicit Progress(std::size_t total) : total_(total) {}
  void show(const std::string& what) {
    done_++;
    if (isatty(2)) std::fprintf(stderr, "\r%zu of %zu  %-50s", done_, total_, what.c_str());
  }
  ~Progress() {
    if (isatty(2)) std::fprintf(stderr, "\r%70s\r", "");
  }

 private:
  std::size_t total_, done_ = 0;
};

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

/// Of what the way to the GPU is told.
bool is_gathered(SceneKind scene, History history) { return scene == SceneKind::flight && history == History::churned; }

std::vector<Case> cases(const Options& options) {
  std::vector<Case> all;
  std::size_t most = 1;
  for (const std::size_t size : options.sizes) most = std::max(most, size <= most_in_rounds ? options.rounds : 1);
  for (std::size_t round = 0; round < most; round++)  // designs take turns, so that what else happens hits all of them
    for (const std::size_t size : options.sizes)
      for (const SceneKind scene : measured_scenes)
        for (const History history : {History::fresh, History::churned})
          for (const NamedDesign& design : designs())
            if ((round == 0 || size <= most_in_rounds) && (!options.transfers || is_gathered(scene, history)))
              all.push_back({&design, scene, history, size});
  return all;
}

Json measure_all(const Options& options) {
  const std::vector<Case> all = cases(options);
  Json rows = Json::array(), transfers = Json::array();
  Progress progress(all.size());
  for (const Case& one : all) {
    progress.show(std::to_string(one.bodies) + " bodies, " + one.design->name + ", " + std::string(name(one.scene)));
    if (auto row = measure(one)) rows.push_back(std::move(*row));
  }
  for (std::size_t round = 0; round < options.rounds && !options.no_gl; round++)
    for (const std::size_t size : options.sizes) transfers.push_back(measure_transfers(size));
  return {{"processor", processor()}, {"rows", rows}, {"transfers", transfers}};
}

int step_one(const Options& options) {
  for (const NamedDesign& design : designs())
    for (const SceneKind scene : measured_scenes)
      for (const History history : {History::fresh, History::churned})
        if (design.name == options.design && name(scene) == options.scene && name(history) == options.history)
          return only_step({&design, scene, history, options.sizes.front()}, options.steps), 0;
  std::string known;
  for (const NamedDesign& design : designs()) known += std::string(known.empty() ? "" : "; ") + design.name;
  std::cerr << "pcphys_architectures: there is no such design, scene or history. Designs: " << known
            << ". Scenes: flight, chains, pairs. Histories: fresh, churned.\n";
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "The same scenes and kernels in a class hierarchy, the original's hybrid, an entity store and the property "
      "world"};
  app.add_option("--sizes", options.sizes, "numbers of bodies")->delimiter(',')->check(CLI::PositiveNumber);
  app.add_option("--rounds", options.rounds, "runs of each case up to 10,000 bodies; of more there is one")
      ->check(CLI::PositiveNumber);
  app.add_option("--json", options.json, "where the figures go; - is standard output");
  app.add_flag("--no-gl", options.no_gl, "no transfers through OpenGL");
  app.add_flag("--transfers", options.transfers, "only the way to the GPU and back, and gathers on it");
  app.add_flag("--check", options.check, "compare the designs bit by bit on small scenes, and nothing else");
  app.add_option("--only", options.design,
                 "step this design alone, for a profiler; with --scene, --history, --steps, --sizes");
  app.add_option("--scene", options.scene, "flight, chains or pairs");
  app.add_option("--history", options.history, "fresh or churned");
  app.add_option("--steps", options.steps, "of --only; 0 only builds");
  CLI11_PARSE(app, argc, argv);
  if (options.check) return check() ? 0 : 1;
  if (!options.design.empty()) return step_one(options);
  std::ofstream file;
  if (options.json != "-") {
    file.open(options.json);
    if (!file) {
      std::cerr << "pcphys_architectures: cannot write " << options.json << ".\n";
      return 1;
    }
  }
  (options.json == "-" ? std::cout : file) << measure_all(options).dump(1) << "\n";
  return 0;
}
