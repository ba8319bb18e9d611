// What the programs of this folder share: a run on each place, and rows of numbers for a plot.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

#include "pcphys/pcphys.h"

namespace show {

[[noreturn]] inline void stop(const char* message) { std::puts(message), std::exit(1); }
/// The value, or the end of the program with the error's sentence.
template <class T> T must(pcphys::Result<T> result) {
  if (!result) stop(result.error().message.c_str());
  return *std::move(result);
}
inline void must(const pcphys::Status& status) {
  if (!status) stop(status.error().message.c_str());
}

/// Writes rows where the program was called with --csv FILE, or with another option. A column "x exact" is the closed
/// form of the column "x".
class Csv {
 public:
  Csv(int argc, char** argv, const char* header, const char* option = "--csv") {
    if (argc != 3 || std::strcmp(argv[1], option) != 0) return;
    if (!(file_ = std::fopen(argv[2], "w"))) stop("The file for rows cannot be written.");
    std::fprintf(file_, "%s\n", header);
  }
  ~Csv() {
    if (file_) std::fclose(file_);
  }
  Csv(const Csv&) = delete;
  Csv& operator=(const Csv&) = delete;
  /// The CPU's rows: the GPU's are the same.
  void row(pcphys::Place place, std::initializer_list<double> numbers) {
    if (!file_ || place != pcphys::Place::cpu) return;
    for (const double& x : numbers) std::fprintf(file_, "%.9g%s", x, &x == numbers.end() - 1 ? "\n" : ",");
  }

 private:
  std::FILE* file_ = nullptr;
};

/// Steps the world to `seconds`, `rate` steps a second, and calls `after(time)` after each step.
template <class After>
void run(pcphys::World& world, pcphys::Stepper& stepper, double seconds, After after, int rate = 60) {
  for (int step = 1; step <= std::lround(seconds * rate); step++) {
    if (const pcphys::StepReport& report = stepper.step(world, 1.0 / rate); !report) stop(report.error.message.c_str());
    after(step / double(rate));
  }
}

/// `scene(place)` makes a world, runs it there and returns its hash. Whether both places left the same bits.
template <class Scene> bool same_on_both_places(Scene scene) {
  const std::uint64_t cpu = scene(pcphys::Place::cpu), gl = scene(pcphys::Place::gl);
  std::printf("hash on cpu %016llx, on gl %016llx\n", (unsigned long long)cpu, (unsigned long long)gl);
  return cpu == gl;
}

inline pcphys::StepSettings at(pcphys::Place place) { return {.integrate = place, .joints = place, .impulses = place}; }

}  // namespace show
