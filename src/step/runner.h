// Runs a plan: keeps the backends, their copies of buffers, and the clock.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "cpu/workers.h"
#include "pcphys/step.h"
#include "plan/plan.h"
#include "step/backend.h"
#include "step/rollback.h"
#include "step/schedule.h"
#include "world/state.h"

namespace pcphys {

class Runner {
 public:
  /// Makes the backends that the settings ask for, keeping those that still fit.
  Status prepare(const StepSettings& settings, Precision precision);
  /// Everything a plan binds: lists and colours packed for their backends, buffers attached.
  Status bind(const StepPlan& plan, WorldState& state, Schedule& schedule);
  Status run(const StepSettings& settings, const StepPlan& plan, WorldState& state, Schedule& schedule, const void* infos,
             StepReport& report);

  /// Before a step changes a buffer of a table, so that `undo` can put it back. Contacts are not copied: the detector
  /// has their last list; nor, on the CPU alone, is scratch.
  void keep(const WorldState& state, Buffer buffer);
  /// A buffer of state as it was before this step wrote it; null if none did.
  const AlignedBytes* before(Buffer buffer) const { return rollback_.before(buffer); }
  /// The step was made.
  void drop() { rollback_.drop(); }
  /// The step failed: the tables as they were before it, and a device that is asked for nothing more of it.
  void undo(WorldState& state);
  /// What the devices hold is not the data of the world that comes.
  void forget();
  std::string device(Place place) const;
  /// After `prepare`.
  const Workers& workers() const { return *workers_; }

 private:
  struct Copy {
    void* host = nullptr;
    std::size_t bytes = 0;
    std::uint64_t version = 0;  // of the host's data that the device holds; 0: none
  };
  struct Device {
    std::unique_ptr<Backend> backend;
    Precision precision = Precision::f32;
    std::uint32_t lanes = 0;  // that were asked for
    int index = -1;
    bool host_context = false;
    std::array<Copy, buffer_count> copies{};
  };

  Device& at(Place place) { return devices_[std::size_t(place)]; }
  Status attach(Place place, Buffer buffer, void* host, std::size_t bytes);
  Status upload(Buffer buffer, std::uint64_t version, StepReport& report);
  std::uint32_t lanes(Place place, Domain domain, const Schedule& schedule);
  Status entry(const PlanEntry& entry, WorldState& state, Schedule& schedule, StepReport& report);
  Status kernel(const PlanEntry& entry, WorldState& state, Schedule& schedule);
  Status transfer(const PlanEntry& entry, WorldState& state, StepReport& report);

  /// Without those that are empty; joined where they need not follow one another.
  std::span<const Range> of_octave(std::span<const Range> ranges, bool coloured);

  std::vector<Range> ranges_;         // of the kernel that runs
  std::unique_ptr<Workers> workers_;  // outlives the backends
  std::uint32_t threads_ = 0;         // that were asked for
  std::array<Device, 2> devices_;     // by Place
  Rollback rollback_;
  bool gl_ = false;  // takes part
};

}  // namespace pcphys
