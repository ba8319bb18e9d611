// Plays a scene on the library.
#pragma once
#include <vector>

#include "pcphys/step.h"
#include "pcphys/world.h"
#include "wild/scene.h"

namespace pcphys::wild {

/// What must change no bit, and the precision, which may.
struct PlayOptions {
  Precision precision = Precision::f32;
  Place place = Place::cpu;  // of all stages
  bool mixed = false;        // some of them are on the CPU in its stead, others in each step
  std::uint32_t lanes = 0, threads = 1;
  std::uint32_t steppers = 1;     // that step the world in turns
  std::uint32_t fresh_every = 0;  // before each so manieth step all of them are new; 0: never
  bool restored = false;          // and the world is restored from its own snapshot
  /// Far away stands a heap of two balls on a plate of its own, which never meets the scene.
  bool unrelated = false;
};

class Player;

/// Looks on while a scene is played. What a call refuses is told too: random calls may be.
class Watcher {
 public:
  virtual ~Watcher() = default;
  virtual void before_call(const Player&, const Call&) {}
  virtual void after_call(const Player&, const Call&, const Status&) {}
  /// False ends the play.
  virtual bool after_step(const Player&, double /*dt*/, const StepReport&) { return true; }
};

class Player {
 public:
  Player(const Scene& scene, const PlayOptions& options);

  /// All calls in their order. Errors: that of a step that could not be made.
  Status play(Watcher* watcher = nullptr);

  const Scene& scene() const { return scene_; }
  const PlayOptions& options() const { return options_; }
  const World& world() const { return world_; }
  World& world() { return world_; }
  const StepSettings& settings() const { return settings_; }
  /// Of Stepper::step alone, so far.
  double seconds() const { return seconds_; }
  /// Told what contacts do (src/step/contact_trace.h); null: nobody is.
  void set_trace(ContactTrace* trace) {
    trace_ = trace;
    for (Stepper& stepper : steppers_) stepper.set_trace(trace);
  }
  /// Invalid ids for what was never made, was refused or is destroyed.
  BodyId body(int number) const { return number == ground ? world_.ground() : at(bodies_, number); }
  JointId joint(int number) const { return at(joints_, number); }
  SpringId spring(int number) const { return at(springs_, number); }
  int body_numbers() const { return int(bodies_.size()); }
  int joint_numbers() const { return int(joints_.size()); }
  int spring_numbers() const { return int(springs_.size()); }
  /// Of the scene's own bodies, in the order of their numbers: poses and velocities, bit for bit.
  std::uint64_t own_hash() const;

 private:
  template <class Id> static Id at(const std::vector<Id>& list, int number) {
    return number >= 0 && std::size_t(number) < list.size() ? list[std::size_t(number)] : Id{};
  }
  Status apply(const Call& call);
  Status step(double dt, Watcher* watcher, bool& go_on);
  void add_unrelated();
  StepSettings placed(StepSettings settings) const;
  void renew_steppers();
  /// What the options ask for between two steps.
  Status change_steppers();
  Status configure();
  struct Apply;

  const Scene& scene_;
  PlayOptions options_;
  World world_;
  std::vector<Stepper> steppers_;
  StepSettings settings_;  // of the scene, as it was configured last
  std::vector<BodyId> bodies_;
  std::vector<JointId> joints_;
  std::vector<SpringId> springs_;
  std::vector<ForceId> forces_;
  std::vector<std::byte> saved_;
  std::uint64_t steps_ = 0;
  double seconds_ = 0;
  ContactTrace* trace_ = nullptr;
};

}  // namespace pcphys::wild
