// Makes the events of a step from the tables that it left: the same on every backend, since the tables are.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "collision/detector.h"
#include "pcphys/events.h"
#include "pcphys/step.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class EventRecorder {
 public:
  /// Whether the step has to leave `Buffer::touch`.
  static bool of_contacts(const StepSettings& s) { return s.contact_events || s.hit_events; }
  static bool wanted(const StepSettings& s) { return of_contacts(s) || s.body_events; }

  struct Before {
    const AlignedBytes* poses;  // as the step began with them; null where it left them alone
    const Detector& detector;   // that found the contacts
  };
  /// What these settings do not ask for is not remembered: once they ask again it begins anew.
  void follow(const StepSettings& settings);
  /// Before a step, which may fail. Who touches is remembered.
  void clear() { begun_.clear(), ended_.clear(), hits_.clear(), moved_.clear(), slept_.clear(), woken_.clear(); }
  /// After a step. `moving`: rows of bodies.
  void record(const StepSettings& settings, const WorldState& state, const Before& before,
              std::span<const std::uint32_t> moving);
  /// After `record`, and when it is known who sleeps.
  void follow_sleep(const StepSettings& settings, const WorldState& state);
  /// Of a step that keeps no copy of the poses by itself.
  void keep_poses(const WorldState& state);
  const AlignedBytes* kept_poses() const { return &poses_; }
  StepEvents events() const { return {begun_, ended_, hits_, moved_, slept_, woken_}; }
  std::size_t memory_bytes() const {
    return bytes_of(touching_, next_, poses_, begun_, ended_, hits_, moved_, slept_, woken_, asleep_, next_asleep_);
  }

 private:
  struct Touching {
    ContactKey key;
    TouchingPair pair;
  };
  template <class Scalar>
  void record_as(const StepSettings& settings, const WorldState& state, const Before& before,
                 std::span<const std::uint32_t> moving);
  template <class Scalar>
  ContactBegun meeting(const WorldState& state, std::uint32_t contact, const Before& before) const;
  template <class Scalar> void find_hits(const WorldState& state, const Before& before, double least_speed);
  template <class Scalar> void follow_contacts(const WorldState& state, const Before& before);
  template <class Scalar>
  void find_moved(const WorldState& state, const AlignedBytes& poses, std::span<const std::uint32_t> moving);

  std::uint64_t rest_serial_ = 0, rest_ = 0;  // the world and its rest_version that `asleep_` is of
  std::uint64_t serial_ = 0;                  // of the world that `touching_` is of
  std::vector<Touching> touching_, next_;     // ascending by key
  AlignedBytes poses_;
  std::vector<ContactBegun> begun_;
  std::vector<ContactEnded> ended_;
  std::vector<ContactHit> hits_;
  std::vector<BodyId> moved_, slept_, woken_, asleep_, next_asleep_;
};

}  // namespace pcphys
