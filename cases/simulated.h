// A motion under way, in pcphys or in a peer: what a case may do to it and see of it.
#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "direct.h"
#include "pcphys/step.h"
#include "scenes/scene.h"

namespace pcphys::cases {

/// What is simulated. pcphys steps the world; a peer reads its bodies, joints and gravity from it, as they were built.
struct Problem {
  World world;
  scenes::Scene scene;
};

/// What a trial has used so far, and where it must stop.
struct Meter {
  double seconds = 0;  // of the thread's clock that the steps took, nothing else
  long steps = 0;
  double body_steps = 0;  // sum over the steps of the bodies that can move
  long limit = std::numeric_limits<long>::max();
  double budget = std::numeric_limits<double>::infinity();  // of `seconds`; more is an error
  Error error;                                              // of the first step that was refused
  // after `hashed_steps` steps, or after the last where there are fewer
  std::uint64_t hash = 0;
};
inline constexpr long hashed_steps = 600;

/// Bodies are counted as in `problem().scene.bodies`. World axes, SI units.
class Simulated {
 public:
  explicit Simulated(Problem problem);
  virtual ~Simulated() = default;

  /// Steps on; nothing happens after an error, or when the trial's limit is reached.
  void step(double dt, long count = 1);

  virtual Pose pose(int body) const = 0;
  /// In phase with the position, where the engine can tell [m/s], [rad/s].
  virtual Vec3 velocity(int body) const = 0;
  virtual Vec3 angular_velocity(int body) const = 0;

  /// Acts from now on, in place of what was set before. An engine that cannot do it reports an error.
  void set_wrench(int body, const Wrench& wrench) { carry_out(Push{body, wrench}); }
  void set_gravity(Vec3 gravity) { carry_out(Pull{gravity}); }
  void set_velocity(int body, Vec3 velocity, Vec3 angular_velocity) {
    carry_out(Start{body, velocity, angular_velocity});
  }
  /// Does on this simulation, which has just been started, what was done to another one, and nothing else. What it
  /// takes [s], but for the first step, in which engines set themselves up: as if that had taken as long as the others.
  /// Below zero: an error.
  double repeat(const Simulated& other);
  /// About the origin, as the engine keeps it: what is read in phase with the positions swings about that [kg m^2/s].
  virtual Vec3 kept_angular_momentum() const;
  /// Of the whole state, where the engine has one.
  virtual std::uint64_t hash() const { return 0; }

  const Problem& problem() const { return problem_; }
  int bodies() const { return int(problem_.scene.bodies.size()); }
  JointDef joint(int joint) const { return *problem_.world.joint(problem_.scene.joints[std::size_t(joint)]); }
  const MassProperties& mass(int body) const { return masses_[std::size_t(body)]; }
  bool moves(int body) const { return problem_.scene.bodies[std::size_t(body)].kind == BodyKind::dynamic; }
  void attach(Meter& meter) { meter_ = &meter; }
  /// A body that leaves the range of numbers is no error.
  void allow_frozen() { frozen_allowed_ = true; }

 protected:
  virtual Status advance(double dt) = 0;
  virtual void apply_wrench(int body, const Wrench& wrench);
  virtual void apply_gravity(Vec3 gravity);
  virtual void apply_velocity(int body, Vec3 velocity, Vec3 angular_velocity);
  void refuse(const std::string& what);

  Problem problem_;
  bool frozen_allowed_ = false;

 private:
  struct Steps {
    double dt;
    long count;
  };
  struct Push {
    int body;
    Wrench wrench;
  };
  struct Pull {
    Vec3 gravity;
  };
  struct Start {
    int body;
    Vec3 velocity, angular_velocity;
  };
  using Deed = std::variant<Steps, Push, Pull, Start>;
  void carry_out(const Deed& deed);
  void record(double dt, long count);
  void apply(const Deed& deed);

  std::vector<Deed> deeds_;  // so far
  std::vector<MassProperties> masses_;
  double moving_ = 0;
  Meter* meter_ = nullptr;
};

/// How a trial wants its steps made. `settings` beyond these are pcphys's own, and a peer ignores them.
struct Conditions {
  Precision precision = Precision::f64;
  StepSettings settings;
};

/// Makes simulations: pcphys with the place of its stages, or a peer.
class Engine {
 public:
  virtual ~Engine() = default;
  virtual Result<std::unique_ptr<Simulated>> start(Problem problem, const Conditions& conditions) = 0;
  /// As it stands in a row: empty for pcphys.
  virtual std::string peer() const { return {}; }
  /// "cpu" or "gl".
  virtual std::string backend() const { return "cpu"; }
  /// Whether it has this precision, and makes of `substeps` a difference.
  virtual bool has(Precision) const { return true; }
  virtual bool has_substeps() const { return true; }
  /// A trial whose steps take longer is given up [s].
  virtual double budget() const { return std::numeric_limits<double>::infinity(); }
  /// One contact, straight through the solver; pcphys alone can be given one.
  virtual Status resolve(SphereContact& contact, Precision precision);
};

/// `lanes` as in StepSettings.
std::unique_ptr<Engine> make_pcphys(Place place, std::uint32_t lanes = 0, int device = -1);
/// A peer by its name in peers/peer.h; nullptr when it was not found. Its trials fail for what it has no equal of, and
/// when their steps take longer than `budget` [s].
std::unique_ptr<Engine> make_peer(std::string_view name, double budget);

}  // namespace pcphys::cases
