#include "case.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace pcphys::cases {
namespace {

/// In place of a simulation that an engine refused to make, so that the variant can go on to its end: nothing moves.
class Still final : public Simulated {
 public:
  using Simulated::Simulated;
  Pose pose(int body) const override { return problem_.scene.bodies[std::size_t(body)].start; }
  Vec3 velocity(int) const override { return {}; }
  Vec3 angular_velocity(int) const override { return {}; }

 protected:
  Status advance(double) override { return {}; }
  void apply_wrench(int, const Wrench&) override {}
  void apply_gravity(Vec3) override {}
  void apply_velocity(int, Vec3, Vec3) override {}
};

}  // namespace

Trial::Trial(Engine& engine, const Setting& setting) : engine_(engine), setting_(setting) {
  conditions_.precision = setting.precision;
  conditions_.settings.substeps = setting.substeps;
  conditions_.settings.order = setting.order;
  conditions_.settings.restitution_threshold = 0;
}

long Trial::steps(double seconds) const { return std::lround(seconds / dt()); }

Simulated& Trial::start(const std::function<void(scenes::Builder&)>& build,
                        const std::function<void(StepSettings&)>& tune) {
  const auto fail = [this](const Error& error) {
    if (meter_.error.code == ErrorCode::none) meter_.error = error;
  };
  const auto make = [&] {
    Problem problem{World({conditions_.precision, {}}), {}};
    const scenes::SceneOptions options;
    scenes::Builder builder(problem.world, problem.scene, options);
    build(builder);
    fail(builder.error());
    return problem;
  };
  Conditions conditions = conditions_;
  if (tune) tune(conditions.settings);
  auto simulated = engine_.start(make(), conditions);
  if (!simulated) fail(simulated.error());
  again_.push_back({{}, conditions});
  // now: what `build` refers to may be gone later
  for (int i = 0; i < repeats_; ++i) again_.back().problems.push_back(make());
  running_.push_back(simulated ? std::move(*simulated) : std::make_unique<Still>(make()));
  running_.back()->attach(meter_);
  return *running_.back();
}

std::optional<double> Trial::time_again() {
  double sum = 0;
  for (std::size_t i = 0; i < running_.size(); ++i) {
    if (again_[i].problems.empty()) return {};
    auto anew = engine_.start(std::move(again_[i].problems.back()), again_[i].conditions);
    again_[i].problems.pop_back();
    if (!anew) return {};
    const double seconds = (*anew)->repeat(*running_[i]);
    if (seconds < 0) return {};
    sum += seconds;
  }
  return sum;
}

void Trial::resolve(SphereContact& contact) {
  if (meter_.steps >= meter_.limit) return;
  ++meter_.steps;
  if (auto status = engine_.resolve(contact, conditions_.precision); !status && meter_.error.code == ErrorCode::none)
    meter_.error = status.error();
  for (const Vec3& v : {contact.v1, contact.v2, contact.w1, contact.w2})
    for (double x : {v.x, v.y, v.z})
      meter_.hash = (meter_.hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 1099511628211u;
}

void Trial::report(std::string metric, double error, std::optional<double> must, std::optional<double> target) {
  if (!setting_.bounded) must = target = std::nullopt;
  findings_.push_back({std::move(metric), error, must, target});
}

void Trial::report_missing(const std::string& why) {
  report("not available", std::numeric_limits<double>::quiet_NaN(), 0.0);
  meter_.error = {ErrorCode::unavailable, "Not available: " + why + "."};
}

std::optional<double> Trial::at(const Bounds& bounds, std::size_t single) const {
  for (std::size_t i = 0; i < ladder.size(); ++i)
    if (std::fabs(dt() / ladder[i] - 1) < 1e-9 && (is_double() || i < single) && std::isfinite(bounds[i]))
      return bounds[i];
  return {};
}

void Trial::finish() {
  if (meter_.error.code == ErrorCode::none && meter_.steps == 0 && !running_.empty())
    meter_.error = {ErrorCode::bad_file, "The case made no step; its reference has no time that is a multiple of dt."};
  if (!running_.empty() && meter_.steps < hashed_steps) meter_.hash = running_.back()->hash();
}

const std::vector<Case>& list() {
  static const std::vector<Case> all = [] {
    std::vector<Case> cases;
    for (const auto add :
         {add_free_motion, add_rotation,       add_pendulums, add_hinges,    add_bounces, add_impacts, add_friction,
          add_rolling,     add_simbenchmark,   add_chains,    add_loops,     add_drives,  add_stacks,  add_ragdolls,
          add_scales,      add_extreme_motion, add_overlaps,  add_bad_input, add_crowds,  add_repeats})
      add(cases);
    // a group's letter, then its number
    std::stable_sort(cases.begin(), cases.end(), [](const Case& a, const Case& b) {
      return std::pair(a.group(), std::stoi(a.name.substr(1))) < std::pair(b.group(), std::stoi(b.name.substr(1)));
    });
    return cases;
  }();
  return all;
}

}  // namespace pcphys::cases
