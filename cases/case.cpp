#include "case.h"

#include <algorithm>
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
  void set_wrench(int, const Wrench&) override {}
  void set_gravity(Vec3) override {}
  void set_velocity(int, Vec3, Vec3) override {}

 protected:
  Status advance(double) override { return {}; }
};

}  // namespace

Trial::Trial(Engine& engine, Precision precision, double dt, std::uint32_t substeps) : engine_(engine), dt_(dt) {
  conditions_.precision = precision;
  conditions_.settings.substeps = substeps;
  conditions_.settings.restitution_threshold = 0;
}

long Trial::steps(double seconds) const { return std::lround(seconds / dt_); }

Simulated& Trial::start(const std::function<void(scenes::Builder&)>& build, const std::function<void(StepSettings&)>& tune) {
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
  running_.push_back(simulated ? std::move(*simulated) : std::make_unique<Still>(make()));
  running_.back()->attach(meter_);
  return *running_.back();
}

void Trial::report(std::string metric, double error, std::optional<double> must, std::optional<double> target) {
  findings_.push_back({std::move(metric), error, must, target});
}

std::optional<double> Trial::at(const Bounds& bounds, std::size_t single) const {
  for (std::size_t i = 0; i < ladder.size(); ++i)
    if (std::fabs(dt_ / ladder[i] - 1) < 1e-9 && (is_double() || i < single)) return bounds[i];
  return {};
}

void Trial::finish() {
  if (meter_.error.code == ErrorCode::none && meter_.steps == 0)
    meter_.error = {ErrorCode::bad_file, "The case made no step; its reference has no time that is a multiple of dt."};
  if (!running_.empty() && meter_.steps < hashed_steps) meter_.hash = running_.back()->hash();
}

const std::vector<Case>& list() {
  static const std::vector<Case> all = [] {
    std::vector<Case> cases;
    add_free_motion(cases);
    add_pendulums(cases);
    add_chains(cases);
    add_loops(cases);
    add_stacks(cases);
    add_ragdolls(cases);
    std::ranges::stable_sort(cases, {}, [](const Case& c) { return std::pair(c.group(), std::stoi(c.name.substr(1))); });
    return cases;
  }();
  return all;
}

}  // namespace pcphys::cases
