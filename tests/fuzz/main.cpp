// pcphys_fuzz: random sequences of calls on hosts that must agree, for a time or a number of sequences.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>

#include "sequence.h"

int main(int argc, char** argv) {
  CLI::App app("Random calls on worlds that are stepped in different ways and must agree to the bit");
  std::uint64_t seed = 1, count = 0;
  double seconds = 10, gl_share = 0;
  bool go_on = false;
  app.add_option("--seed", seed, "of the first sequence; the next have those that follow");
  app.add_option("--count", count, "sequences; 0: as many as --seconds allows");
  app.add_option("--seconds", seconds, "how long");
  app.add_option("--gl", gl_share, "share of the sequences in which some hosts step on OpenGL");
  app.add_flag("--go-on", go_on, "after a finding");
  CLI11_PARSE(app, argc, argv);

  using Clock = std::chrono::steady_clock;
  const auto began = Clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
  fuzz::Counts counts;
  std::uint64_t findings = 0;
  for (std::uint64_t i = 0; count > 0 ? i < count : passed() < seconds; i++) {
    fuzz::Choices choices(seed + i);
    const bool gl = choices.chance(gl_share);
    const fuzz::Finding found = fuzz::play(choices, gl, counts);
    if (found.what.empty()) continue;
    findings++;
    std::printf("seed %llu, after %zu calls: %s\n", static_cast<unsigned long long>(seed + i), found.calls.size(),
                found.what.c_str());
    if (go_on) continue;
    for (const std::string& call : found.calls) std::printf("  %s\n", call.c_str());
    break;
  }
  const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  std::printf("%llu sequences, %llu calls (%llu refused), %llu steps in %.1f s, digest %016llx: %llu found something\n",
              number(counts.sequences), number(counts.calls), number(counts.refused), number(counts.steps), passed(),
              number(counts.digest), number(findings));
  return findings > 0;
}
