#include "wild/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>

#include "peers/peer.h"

namespace pcphys::wild {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// A family in one engine, while scenes are added.
class Sum {
 public:
  Sum(std::string engine, std::string family, std::string precision) {
    summary_.engine = std::move(engine);
    summary_.family = std::move(family);
    summary_.precision = std::move(precision);
  }

  void refuse(const Error& error) {
    if (summary_.refused++ == 0) summary_.why_refused = error.message;
  }

  void add(std::uint64_t seed, const Verdict& verdict) {
    summary_.runs++;
    summary_.steps += verdict.steps;
    summary_.body_steps += verdict.body_steps;
    summary_.seconds += verdict.seconds;
    for (std::size_t m = 0; m < measure_count; m++)
      if (verdict.of[m].measured) add(Measure(m), seed, verdict.of[m]);
    if (!verdict.broken()) return;
    summary_.broken++;
    const Broken told = told_of(seed, verdict);
    if (told.measure == Measure::count) {
      if (summary_.failed++ == 0) summary_.worst = told;
      most_excess_ = std::numeric_limits<double>::infinity();
    } else {
      summary_.most_broken[std::size_t(told.measure)]++;
    }
    if (summary_.listed.size() < Summary::most_listed) summary_.listed.push_back(told);
  }

  Summary finish() {
    for (std::size_t m = 0; m < measure_count; m++) {
      Spread& spread = summary_.of[m];
      spread.median = quantile(values_[m], 0.5);
      spread.p99 = quantile(values_[m], 0.99);
      spread.p999 = quantile(values_[m], 0.999);
    }
    return std::move(summary_);
  }

 private:
  static Broken told_of(std::uint64_t seed, const Verdict& verdict) {
    if (!verdict.failure.empty()) return {seed, verdict.steps, Measure::count, 0, 0, verdict.failure};
    const Measure worst = verdict.worst();
    const Finding& found = verdict[worst];
    return {seed, found.step, worst, found.worst, *found.bound, {}};
  }

  void add(Measure measure, std::uint64_t seed, const Finding& found) {
    Spread& spread = summary_.of[std::size_t(measure)];
    // What is no number is worse than any.
    const double value = std::isnan(found.worst) ? std::numeric_limits<double>::infinity() : found.worst;
    values_[std::size_t(measure)].push_back(value);
    if (spread.runs++ == 0 || value > spread.worst) {
      spread.worst = value;
      spread.seed = seed;
      spread.step = found.step;
    }
    if (!found.bound) return;
    if (found.broken()) spread.broken++;
    spread.least_bound = std::min(spread.least_bound.value_or(*found.bound), *found.bound);
    spread.largest_bound = std::max(spread.largest_bound.value_or(*found.bound), *found.bound);
    const double beyond = found.excess();
    if (!summary_.worst || beyond > most_excess_) {
      most_excess_ = beyond;
      summary_.worst = Broken{seed, found.step, measure, found.worst, *found.bound, {}};
    }
  }

  /// The smallest value that is at least as large as this share of them.
  static double quantile(std::vector<double>& values, double share) {
    if (values.empty()) return 0;
    const auto at = std::ptrdiff_t(std::ceil(share * double(values.size()))) - 1;
    const auto nth = values.begin() + std::clamp<std::ptrdiff_t>(at, 0, std::ptrdiff_t(values.size()) - 1);
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
  }

  Summary summary_;
  std::array<std::vector<double>, measure_count> values_;
  double most_excess_ = 0;  // of summary_.worst
};

bool divides(std::uint64_t every, std::uint64_t seed) { return every > 0 && seed % every == 0; }

const peers::Variant* find_peer(const std::string& wanted) {
  const auto all = peers::variants();
  const auto found = std::find_if(all.begin(), all.end(), [&](const peers::Variant& v) { return v.name == wanted; });
  return found == all.end() ? nullptr : &*found;
}

/// All seeds of one family, in all precisions and engines.
class FamilyRun {
 public:
  FamilyRun(const RunOptions& options, const std::string& family) : options_(options), family_(family) {
    for (const Precision precision : options.precisions) own_.emplace_back("pcphys", family, name(precision));
    for (const std::string& peer : options.peers)
      peers_.emplace_back(peer, family, std::string(find_peer(peer)->precision));
  }

  /// True if it broke on the library.
  Result<bool> play(std::uint64_t seed) {
    const auto scene = draw(family_, seed);
    if (!scene) return scene.error();
    bool broken = false;
    for (std::size_t i = 0; i < own_.size(); i++) {
      PlayOptions play = options_.play;
      play.precision = options_.precisions[i];
      Verdict verdict = judge(*scene, play);
      const bool gl = divides(options_.gl_every, seed);
      if (verdict.failure.empty() && (gl || divides(options_.bits_every, seed))) judge_bits(*scene, play, gl, verdict);
      own_[i].add(seed, verdict);
      broken = broken || verdict.broken();
    }
    for (std::size_t i = 0; i < peers_.size(); i++) {
      const auto verdict = judged_by(options_.peers[i], *scene);
      if (verdict)
        peers_[i].add(seed, *verdict);
      else
        peers_[i].refuse(verdict.error());
    }
    return broken;
  }

  void finish(std::vector<Summary>& summaries) {
    for (Sum& sum : own_) summaries.push_back(sum.finish());
    for (Sum& sum : peers_) summaries.push_back(sum.finish());
  }

 private:
  /// An engine that throws (ODE, where its own checks fail) cannot hold the scene.
  static Result<Verdict> judged_by(const std::string& peer, const Scene& scene) {
    try {
      return judge_peer(scene, peer);
    } catch (const std::exception& error) {
      return Error{ErrorCode::unavailable, error.what()};
    }
  }

  const RunOptions& options_;
  const std::string& family_;
  std::vector<Sum> own_, peers_;
};

Result<std::vector<std::string>> families_of(const RunOptions& options) {
  for (const std::string& wanted : options.families)
    if (const auto found = find_family(wanted); !found) return found.error();
  for (const std::string& peer : options.peers)
    if (!find_peer(peer)) return Error{ErrorCode::unknown_name, "There is no peer '" + peer + "'."};
  if (!options.families.empty()) return options.families;
  std::vector<std::string> all;
  for (const Family& family : families()) all.emplace_back(family.name);
  return all;
}

}  // namespace

const char* name(Precision precision) { return precision == Precision::f64 ? "double" : "float"; }

Result<std::vector<Summary>> run(const RunOptions& options, const std::function<bool(const RunState&)>& progress) {
  const auto names = families_of(options);
  if (!names) return names.error();
  std::vector<Summary> summaries;
  const double start = now();
  std::uint64_t scenes = 0, broken = 0;
  bool goes_on = true;
  for (std::size_t i = 0; i < names->size() && goes_on; i++) {
    FamilyRun family(options, (*names)[i]);
    const double begun = now(), left = options.budget - (begun - start);
    // What families before have left over goes to the rest; what one scene took too long is taken from nobody.
    const double share = std::max(left / double(names->size() - i), options.budget / double(names->size()));
    for (std::uint64_t k = 0; goes_on && (options.count == 0 || k < options.count); k++) {
      if (options.budget > 0 && k > 0 && now() - begun >= share) break;
      const auto broke = family.play(options.first_seed + k);
      if (!broke) return broke.error();
      scenes++;
      broken += *broke ? 1 : 0;
      if (progress) goes_on = progress({(*names)[i], scenes, now() - start, broken});
    }
    family.finish(summaries);
  }
  return summaries;
}

}  // namespace pcphys::wild
