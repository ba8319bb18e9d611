// Who sleeps (docs/sleeping.md): whole islands, once all of their bodies have been slow for a time, until something
// wakes them. Decided on the host from the tables, whatever the places of the stages,
// so it is the same for all of them.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "pcphys/step.h"
#include "plan/islands.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

/// A world of which everything sleeps, and what such a step reports: known without a look at any body.
class Idle {
 public:
  Idle() = default;
  /// Contacts of what sleeps keep their points.
  Idle(const WorldState& state, const StepPlan& plan, std::uint32_t substeps, std::uint32_t islands)
      : plan(&plan),
        serial_(state.serial),
        structure_(state.structure_version),
        rest_(state.rest_version),
        contacts_(state.contacts_version),
        substeps_(substeps),
        points_(count_points(state)),
        islands_(islands) {}

  /// Whether nothing has been changed since. (Nothing else moves what sleeps.)
  bool holds(const WorldState& s) const {
    return serial_ == s.serial && rest_ == s.rest_version && structure_ == s.structure_version &&
           contacts_ == s.contacts_version && s.callbacks == 0;
  }
  void report_to(StepReport& report, const WorldState& s) const {
    report.substeps = substeps_;
    report.contacts = s.contact_rows() - 1;
    report.points = points_;
    report.asleep = s.sleepers;
    report.islands_asleep = islands_;
  }

  const StepPlan* plan = nullptr;

 private:
  static std::uint32_t count_points(const WorldState& state) {
    std::uint32_t sum = 0;
    for (std::uint32_t row = 1; row < state.contact_rows(); row++)
      sum += std::uint32_t(state.tables.get(Buffer::contact, row, 3));
    return sum;
  }

  std::uint64_t serial_ = 0, structure_ = 0, rest_ = 0, contacts_ = 0;
  std::uint32_t substeps_ = 0, points_ = 0, islands_ = 0;
};

class Sleepers {
 public:
  /// Before the contacts of a step: wakes the islands of bodies that the host has changed, and those that touch or are
  /// joined to one that stands. Returns how many bodies woke.
  std::uint32_t wake_stirred(WorldState& state);
  /// The same of all that sleep.
  std::uint32_t wake_all(WorldState& state);
  /// With the contacts of a step: wakes the islands of these bodies.
  std::uint32_t wake_touched(WorldState& state, std::span<const std::uint32_t> touched);
  /// After a step of `dt`: how long each of the bodies that moved has been slow, and which islands fall asleep.
  /// `before`: the poses that the step began with; null where velocities tell enough, of bodies in flight. `labels`: by
  /// body row the lowest row of its island, where a device has found them; empty: they are found here.
  /// Reports who sleeps.
  void follow(WorldState& state, std::span<const std::uint32_t> moved, const AlignedBytes* before, double dt,
              const StepSettings& settings, std::span<const std::uint32_t> labels, StepReport& report);
  /// What the next `follow` is to know: by body row who is not at rest, however slow (empty: nobody), and whether all
  /// bodies act on each other, so that they sleep together or not at all.
  void disturb(std::span<const char> restless, bool together) {
    restless_ = restless;
    together_ = together;
  }
  std::size_t memory_bytes() const { return bytes_of(islands_, awake_); }

 private:
  void build(const WorldState& state);
  std::uint32_t root(std::uint32_t body) const { return labels_.empty() ? islands_.root(body) : labels_[body]; }
  std::uint32_t wake_marked(WorldState& state);
  /// Which fall asleep; how many bodies that are.
  std::uint32_t choose(WorldState& state, std::span<const std::uint32_t> moved, double sleep_time);
  void mark_kept_awake(const WorldState& state);
  std::uint32_t lay_down(WorldState& state, std::span<const std::uint32_t> moved);

  std::uint32_t count_islands(const WorldState& state);

  Islands islands_;                        // where there are no labels
  std::span<const std::uint32_t> labels_;  // during `follow`
  std::span<const char> restless_;         // for `follow`, and so is the next
  bool together_ = false;
  std::vector<char> awake_;                 // by the root of an island
  std::uint64_t serial_ = 0, counted_ = 0;  // the world and its rest_version that count_ is of
  std::uint32_t count_ = 0;
};

}  // namespace pcphys
