#include "contest.h"

#include <algorithm>

#include "cases/clock.h"
#include "output.h"
#include "pcphys/version.h"

namespace pcphys::command {
namespace {

constexpr std::uint64_t turn_steps = 20;
constexpr std::size_t small_scene = 3000;  // bodies up to which joints are looked at after every step

/// pcphys, seen as the others are.
class Own : public peers::Peer {
 public:
  explicit Own(Simulation simulation) : simulation_(std::move(simulation)) {}

  Status step(double dt) override {
    const StepReport& report = simulation_.stepper.step(simulation_.world, dt);
    points_ = report.points;
    if (!report) return report.error;
    return {};
  }
  int substeps(double) const override { return int(simulation_.setup.settings.substeps); }
  int iterations() const override { return 0; }
  Pose pose(std::size_t body) const override { return *simulation_.world.pose(id(body)); }
  Vec3 velocity(std::size_t body) const override { return *simulation_.world.velocity(id(body)); }
  Vec3 angular_velocity(std::size_t body) const override { return *simulation_.world.angular_velocity(id(body)); }
  MassProperties mass_properties(std::size_t body) const override {
    return *simulation_.world.mass_properties(id(body));
  }
  std::size_t contacts() const override { return points_; }
  std::optional<double> deepest() const override {
    double depth = 0;
    for (const Contact& contact : simulation_.world.contacts())
      for (const Contact::Point& point : contact.points) depth = std::max(depth, -point.separation);
    return depth;
  }

 private:
  BodyId id(std::size_t body) const { return simulation_.scene.bodies[body].id; }
  Simulation simulation_;
  std::size_t points_ = 0;
};

std::vector<Pose> poses_of(const peers::Peer& engine, std::size_t bodies) {
  std::vector<Pose> result;
  result.reserve(bodies);
  for (std::size_t i = 0; i < bodies; ++i) result.push_back(engine.pose(i));
  return result;
}

scenes::State state_of(const peers::Peer& engine, std::size_t bodies) {
  scenes::State state{poses_of(engine, bodies), {}, {}};
  for (std::size_t i = 0; i < bodies; ++i) {
    state.velocities.push_back(engine.velocity(i));
    state.angular_velocities.push_back(engine.angular_velocity(i));
  }
  return state;
}

Entrant make_peer(const std::string& name, const World& world, const scenes::Scene& scene,
                  const peers::Options& options) {
  const auto all = peers::variants();
  const auto variant = std::find_if(all.begin(), all.end(), [&](const peers::Variant& v) { return v.name == name; });
  Entrant entrant{name, variant->version, std::string(variant->solver), std::string(variant->precision), nullptr, {}};
  std::vector<BodyId> ids;
  for (const scenes::SceneBody& body : scene.bodies) ids.push_back(body.id);
  auto peer = peers::make(name, world, ids, options);
  if (peer)
    entrant.engine = std::move(*peer);
  else
    entrant.problem = peer.error().message;
  return entrant;
}

}  // namespace

Result<Contest> Contest::make(const Setup& setup, std::span<const std::string> peers, const peers::Options& options) {
  World world({Precision::f64});
  auto scene = scenes::make(setup.scene, setup.scene_options, world);
  if (!scene) return scene.error();
  Contest contest(setup, std::move(world), std::move(*scene));
  auto own = Simulation::make(setup);
  if (!own) return own.error();
  const char* precision = setup.precision == Precision::f64 ? "double" : "float";
  contest.entrants_.push_back({"pcphys",
                               PCPHYS_VERSION,
                               "joint trees direct, soft contacts",
                               precision,
                               std::make_unique<Own>(std::move(*own)),
                               {}});
  for (const std::string& name : peers)
    contest.entrants_.push_back(make_peer(name, contest.world_, contest.scene_, options));
  contest.scores_.resize(contest.entrants_.size());
  contest.rims_.resize(contest.entrants_.size());
  contest.seconds_.resize(contest.entrants_.size());
  for (std::size_t i = 0; i < contest.entrants_.size(); ++i) {
    if (!contest.entrants_[i].engine) continue;
    contest.look(i, true);
    Score& score = contest.scores_[i];
    score.start = score.end;
    score.peak_energy = score.start.energy();
  }
  return contest;
}

Status Contest::run(double budget, const std::function<void(std::uint64_t)>& progress) {
  for (std::uint64_t done = 0; done < setup_.steps; done += turn_steps) {
    const std::uint64_t count = std::min(turn_steps, setup_.steps - done);
    for (std::size_t i = 0; i < entrants_.size(); ++i)
      if (auto status = turn(i, count, budget); !status) return status;
    progress(done + count);
  }
  return {};
}

bool Contest::processor_time() const {
  const StepSettings& s = setup_.settings;
  return s.integrate == Place::cpu && s.joints == Place::cpu && s.impulses == Place::cpu && s.threads == 1;
}

Status Contest::turn(std::size_t entrant, std::uint64_t count, double budget) {
  Entrant& who = entrants_[entrant];
  Score& score = scores_[entrant];
  const bool of_processor = processor_time();
  const auto clock = of_processor ? cases::thread_clock : now;
  if (!who.engine || !who.problem.empty()) return {};
  for (std::uint64_t k = 0; k < count; ++k) {
    const double begin = clock();
    const Status status = who.engine->step(setup_.dt);
    const double took = std::max(0.0, clock() - begin - (of_processor ? cases::clock_cost() : 0));
    if (!status) {
      if (entrant == 0) return status;
      who.problem = "ended after " + std::to_string(score.steps) + " steps: " + status.error().message;
      return {};
    }
    score.steps++;
    seconds_[entrant] += took;
    if (score.steps > setup_.warmup) score.ms.push_back(1000 * took);
    const bool over = entrant > 0 && seconds_[entrant] > budget && score.steps < setup_.steps;
    look(entrant, k + 1 == count || over);
    if (!over) continue;
    who.problem = "stopped after " + std::to_string(score.steps) + " steps, since they took longer than --budget";
    return {};
  }
  return {};
}

void Contest::look(std::size_t entrant, bool turn_ends) {
  const peers::Peer& engine = *entrants_[entrant].engine;
  Score& score = scores_[entrant];
  const std::size_t bodies = scene_.bodies.size();
  const std::vector<Pose> poses = poses_of(engine, bodies);
  rims_[entrant].look(scene_, poses);
  if (!scene_.joints.empty() && (bodies <= small_scene || turn_ends)) {
    const scenes::LimitExcess limit = scenes::limit_excess(scene_, world_, poses);
    score.peak_separation = std::max(score.peak_separation, scenes::joint_separation(scene_, world_, poses).max);
    score.peak_limit = {std::max(score.peak_limit.any, limit.any), std::max(score.peak_limit.cone, limit.cone)};
  }
  if (!turn_ends) return;
  score.end = scenes::measure(scene_, world_, state_of(engine, bodies), rims_[entrant]);
  score.peak_penetration = std::max(score.peak_penetration, score.end.penetration.max);
  score.peak_energy = std::max(score.peak_energy, score.end.energy());
}

}  // namespace pcphys::command
