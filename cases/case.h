// The cases of the validation set: A accuracy, B stiff, C extreme. A case has variants; a variant is a function
// that builds a world, steps it and reports errors against what is known of the motion. It runs in pcphys and in
// peers alike, since it sees only poses and velocities.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenes/builder.h"
#include "simulated.h"

namespace pcphys::cases {

/// The step lengths that errors are compared at [s].
inline constexpr std::array<double, 4> ladder{1.0 / 60, 1.0 / 240, 1.0 / 1200, 1e-4};

/// Longer ones, at which nothing has a bound: they show what little work brings,
/// and where methods of high order are of use [s].
inline constexpr std::array<double, 2> long_steps{1.0 / 15, 1.0 / 30};

/// One bound a step of the ladder.
using Bounds = std::array<double, 4>;

/// What a trial found: an error with its unit in the metric's name, and what it must and should not exceed.
struct Finding {
  std::string metric;
  double error = 0;
  std::optional<double> must, target;
};

/// With what a variant is run once.
struct Setting {
  Precision precision = Precision::f64;
  double dt = 0;
  std::uint32_t substeps = 1;
  bool bounded = true;  // what it reports is held to the case's bounds
  std::uint32_t order = 2;
};

/// One run of a variant: an engine, a precision, a step length and a number of sub-steps.
class Trial {
 public:
  Trial(Engine& engine, const Setting& setting);
  Trial(const Trial&) = delete;

  double dt() const { return setting_.dt; }
  std::uint32_t substeps() const { return conditions_.settings.substeps; }
  std::uint32_t order() const { return conditions_.settings.order; }
  bool is_double() const { return conditions_.precision == Precision::f64; }
  /// Steps that make up this time [s].
  long steps(double seconds) const;

  /// Builds bodies and joints, and starts their motion. It lives as long as the trial. Restitution has no least speed,
  /// unless `tune` sets one.
  Simulated& start(const std::function<void(scenes::Builder&)>& build,
                   const std::function<void(StepSettings&)>& tune = {});

  /// The contact's velocities after it; counts as one step, without a clock.
  void resolve(SphereContact& contact);

  void report(std::string metric, double error, std::optional<double> must = {}, std::optional<double> target = {});
  /// A row that fails, since the library lacks what the case needs.
  void report_missing(const std::string& why);
  /// A bound that depends on the precision.
  double either(double twice, double single) const { return is_double() ? twice : single; }
  /// The bound of this step length; none off the ladder, and none where it is infinite. In single precision only the
  /// first `single` of them hold: below, rounding stands above the error of every method.
  std::optional<double> at(const Bounds& bounds, std::size_t single = 2) const;

  const std::vector<Finding>& findings() const { return findings_; }
  const Meter& meter() const { return meter_; }
  /// Ends the trial after so many steps, all simulations together.
  void set_limit(long steps) { meter_.limit = steps; }
  /// A trial whose steps take longer fails [s].
  void set_budget(double seconds) { meter_.budget = seconds; }
  /// To be called when the variant's function is done.
  void finish();
  /// How often `time_again` may be called.
  void set_repeats(int repeats) { repeats_ = repeats; }
  /// What the steps take by themselves [s], from a new start with nothing read in between;
  /// none where that cannot be told.
  std::optional<double> time_again();

 private:
  Engine& engine_;
  Conditions conditions_;
  Setting setting_;
  Meter meter_;
  std::vector<Finding> findings_;
  std::vector<std::unique_ptr<Simulated>> running_;
  /// A simulation as it was started.
  struct Start {
    std::vector<Problem> problems;
    Conditions conditions;
  };
  std::vector<Start> again_;  // one for each of them
  int repeats_ = 0;
};

struct Variant {
  std::string name;
  std::function<void(Trial&)> run;
  std::vector<double> steps{ladder.begin(), ladder.end()};
  bool coarse = false;  // runs at long_steps too
  std::vector<std::uint32_t> substeps{1};
  std::vector<double> more_steps{};            // and these, without bounds either
  std::vector<std::uint32_t> more_substeps{};  // the same
  bool single = true;                          // runs in single precision too
  bool direct = false;                         // uses `resolve`: in pcphys alone, with steps of its own
  bool own = false;                            // of a setting that pcphys alone has
  std::uint32_t order = 2;                     // of pcphys: StepSettings::order
  // the metric whose slope must be 1.9 at least, in double; 3.5 with order 4
  std::string second_order{};
  bool order_is_target = false;  // should, not must
  // what the measure of the first metric may be off by itself: errors below it are equal
  std::optional<double> floor{};
  // the first metric is then as large as the motion itself: the run tells nothing of it
  std::optional<double> lost_at{};
  std::vector<double> slow{};  // step lengths that only --all runs
};

struct Case {
  std::string name;  // "A7"; the letter is the group
  std::string title;
  std::vector<Variant> variants;

  char group() const { return name[0]; }
};

/// All cases, in the order of their names.
const std::vector<Case>& list();

// One function a file of cases.
void add_free_motion(std::vector<Case>& cases);
void add_rotation(std::vector<Case>& cases);
void add_pendulums(std::vector<Case>& cases);
void add_hinges(std::vector<Case>& cases);
void add_bounces(std::vector<Case>& cases);
void add_impacts(std::vector<Case>& cases);
void add_friction(std::vector<Case>& cases);
void add_rolling(std::vector<Case>& cases);
void add_simbenchmark(std::vector<Case>& cases);
void add_chains(std::vector<Case>& cases);
void add_loops(std::vector<Case>& cases);
void add_drives(std::vector<Case>& cases);
void add_stacks(std::vector<Case>& cases);
void add_ragdolls(std::vector<Case>& cases);
void add_scales(std::vector<Case>& cases);
void add_extreme_motion(std::vector<Case>& cases);
void add_overlaps(std::vector<Case>& cases);
void add_bad_input(std::vector<Case>& cases);
void add_crowds(std::vector<Case>& cases);
void add_repeats(std::vector<Case>& cases);

}  // namespace pcphys::cases
