// Command lines of `pcphys`, words with a zero byte between: each is refused with a sentence, or read into options that
// are checked; what passes the checks is in the library's own bounds. Nothing is run, and no file is opened.
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include "cases/runner.h"
#include "command/command_line.h"
#include "expect.h"
#include "pcphys/fcl.h"
#include "pcphys/pcphys.h"
#include "seeds.h"
#include "wild/run.h"

namespace {

using namespace pcphys;
using namespace pcphys::command;

void check_run(const RunOptions& options) {
  const Result<Setup> setup = resolve(options, 600);
  if (!setup) return fuzz::expect(!setup.error().message.empty(), "an error without a sentence");
  fuzz::expect(std::isfinite(setup->dt) && setup->dt > 0, "a time step that is none");
  fuzz::expect(setup->steps >= 1 && setup->warmup < setup->steps, "a warm-up of all steps");
  Stepper stepper;
  const Status taken = stepper.configure(setup->settings);
  // FCL may not be there
  fuzz::expect(taken || setup->settings.narrow == NarrowPhase::fcl, "settings that are refused");
}

void check_compare(const CommandLine& line) {
  (void)check(line.compare);
  (void)peer_names(line.compare.peers);
  for (const std::string& scene : line.compare.scenes) {
    RunOptions options = line.run;
    const Result<SceneEntry> entry = scene_of(scene);
    if (!entry) continue;
    if (entry->count) options.count = entry->count;
    check_run(options);
  }
}

void check_wild(const WildOptions& options) {
  const Result<wild::RunOptions> run = resolve(options);
  if (!run) return;
  fuzz::expect(run->budget > 0 || run->count > 0, "random scenes without an end");
  fuzz::expect(!run->precisions.empty(), "random scenes in no precision");
}

std::vector<std::string> words_of(const std::uint8_t* data, std::size_t size) {
  std::vector<std::string> words{"pcphys", ""};
  for (std::size_t i = 0; i < size; i++) {
    if (data[i] == 0)
      words.emplace_back();
    else
      words.back() += char(data[i]);
  }
  return words;
}

}  // namespace

std::size_t fuzz::number_bytes(std::uint8_t) { return 0; }

std::vector<std::vector<std::uint8_t>> fuzz::seeds() {
  const auto line = [](const std::string& text) {
    std::vector<std::uint8_t> seed;
    for (const char c : text) seed.push_back(c == ' ' ? 0 : std::uint8_t(c));
    return seed;
  };
  return {
      line("run balls --count 60 --steps 600 --backend cpu --integrate gl --dt 1/60 --precision double --lanes 4"),
      line("run chain --ratio 1e3 --friction 0.5 --restitution 0 --drag .1 --joint-damping 1e-3 --seed 7 --hash "
           "--poses"),
      line("plan door --steps 2 --substeps 8 --order 4 --integrator seed --narrow fcl --threads 0 --resident --json -"),
      line("tables --warmup 10 --sleep on --islands gl --device -1 --timings off --csv a.csv"),
      line("scenes --json -"),
      line("doctor --csv -"),
      line("accuracy A1 A2 --variant x --repeats 3 --peers all --budget 4 --list --all --first --backend gl"),
      line("stability --precision both --dt 0.01"),
      line("compare balls:1000 stack --peers bullet,ode --peer-substeps 2 --peer-iterations 9 --budget 1e9"),
      line("wild joints --seed 9223372036854775807 --count 10 --bits 3 --bits-gl 0 --shrink --shrink-to a.cpp"),
      line("--help-all"),
      line("--version")};
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  std::cerr.rdbuf(nullptr);  // which peers are missing
  (void)use_fcl();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::string> words = words_of(data, size);
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  const Result<CommandLine> line = read_command_line(int(argv.size()), argv.data());
  if (!line) {
    fuzz::expect(!line.error().message.empty(), "an error without a sentence");
    return 0;
  }
  fuzz::expect(line->command.empty() != line->help.empty(), "neither a sub-command nor help");
  if (line->command == "run" || line->command == "plan" || line->command == "tables") check_run(line->run);
  if (line->command == "accuracy" || line->command == "stability") (void)resolve(line->cases, "A");
  if (line->command == "compare") check_compare(*line);
  if (line->command == "wild") check_wild(line->wild);
  return 0;
}
