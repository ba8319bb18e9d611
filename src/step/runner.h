// Runs a plan: keeps the backends, their copies of buffers, and the clock.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "cpu/workers.h"
#include "pcphys/step.h"
#include "plan/plan.h"
#include "step/backend.h"
#include "step/memory_uses.h"
#include "step/rollback.h"
#include "step/schedule.h"
#include "step/tracer.h"
#include "world/state.h"

namespace pcphys {

/// The narrow phase of a sub-step.
class Collider {
 public:
  virtual ~Collider() = default;
  /// Of islands of one level, in a sub-step of h [s]; `first`: of the step.
  virtual void collide(WorldState& state, unsigned octave, bool first, double h) = 0;
  /// Once more, where impacts have sent bodies elsewhere since, or waited for others; `last`: for the last time in the
  /// sub-step.
  virtual void collide_again(WorldState& state, unsigned octave, bool last, double h) = 0;
  virtual bool waits() const = 0;
  /// Once more, where contacts and joints have sent limbs elsewhere.
  virtual void collide_sent(WorldState& state, unsigned octave, double h) = 0;
  /// Blocks of contacts, whose rows it has made other than they were in the sub-step before; and blocks with impacts.
  virtual std::span<const Range> renewed_blocks() const = 0;
  virtual std::span<const Range> struck_blocks() const = 0;
};

class Runner final : Keeper {
 public:
  Runner() = default;
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;
  ~Runner();

  /// Makes the backends that the settings ask for, keeping those that still fit.
  /// `own`: kernels of the host's own, which may want a place that no stage is put on.
  Status prepare(const StepSettings& settings, Precision precision, const OwnKernels& own = {});
  /// Everything a plan binds: lists and colours packed for their backends, buffers attached. Where nothing of it has
  /// changed since the last step, that step's bindings stand. The plan stays where it is until another one is bound.
  /// `strays`: what goes further than it was looked for has the step made anew; it is undone then, also where all
  /// bodies are in flight.
  Status bind(const StepSettings& settings, const StepPlan& plan, WorldState& state, Schedule& schedule,
              bool strays = false);
  /// Runs the plan that was bound.
  Status run(WorldState& state, const Schedule& schedule, const void* infos, StepReport& report,
             Collider* collider = nullptr);
  /// From now on with a look at what each kernel of the host's own wrote: the first that makes of finite numbers others
  /// is an error (check_written).
  void watch(bool kernels) { watched_ = kernels; }

  /// Before a step changes a buffer of a table, so that `undo` can put it back. Contacts are not copied: the detector
  /// has their last list; nor, on the CPU alone, is scratch.
  void keep(const WorldState& state, Buffer buffer);
  /// A buffer of state as it was before this step wrote it; null if none did.
  const AlignedBytes* before(Buffer buffer) const { return rollback_.before(buffer); }
  /// The step was made.
  void drop() {
    rollback_.drop();
    kept_there_.clear();
  }
  /// The step failed: the tables as they were before it, and a device that is asked for nothing more of it.
  void undo(WorldState& state);
  /// What a kernel of the host's own would say there. After `prepare`.
  Status check(Place place, const OwnKernel& kernel) { return at(place).backend->prepare(kernel); }
  /// Whether the last run left some body where it was, since it would have left the range of numbers
  /// (StepPlan::flight).
  bool left() const { return left_; }
  /// The plans that were bound are gone.
  void unbind() { bound_ = {}; }
  /// What the devices hold is not the data of the world that comes.
  void forget();
  /// Of the devices too. After `forget`, and before `prepare`.
  void let_go();
  /// What backends and copies of this step's buffers take.
  void list_memory(MemoryUses& uses) const;
  std::string device(Place place) const;
  /// From `prepare` on.
  const Workers* workers() const { return workers_.get(); }
  /// Told what contacts do, from the next step on, where no stage is on a device; null: nobody is. It outlives the
  /// runner, or is taken back.
  void trace(ContactTrace* trace) {
    tracer_.told = trace;
    bound_ = {};
  }

 private:
  struct Copy {
    void* host = nullptr;
    std::size_t bytes = 0;
    std::uint64_t version = 0;  // of the host's data that the device holds; 0: none
    bool attached = false;      // a list of nothing is, too
  };
  struct Device {
    std::unique_ptr<Backend> backend;
    Precision precision = Precision::f32;
    std::uint32_t lanes = 0;  // that were asked for
    int index = -1;
    bool host_context = false;
    bool takes_part = false;   // in the steps that come
    std::vector<Copy> copies;  // by Buffer
    Copy& copy(Buffer buffer) {
      if (copies.size() <= std::size_t(buffer)) copies.resize(std::size_t(buffer) + 1);
      return copies[std::size_t(buffer)];
    }
  };

  /// What a step's bindings follow from. (The table of contacts, which changes places with its next one in each step,
  /// is attached anew each time.)
  struct Bound {
    const StepPlan* plan = nullptr;
    std::uint64_t world = 0, layout = 0, schedule = 0;
    bool timings = false, strays = false;
    friend bool operator==(const Bound&, const Bound&) = default;
  };
  /// What a backend is asked for at once: a transfer, or kernels, `count` of runs_ from `first` on.
  struct Call {
    const PlanEntry* entry;  // the first of them
    std::uint32_t first = 0, count = 0;
    bool last = false;                               // of a stage that is clocked
    bool ends = false;                               // a sub-step
    std::uint32_t narrowed = 0, narrowed_count = 0;  // of a collide entry: runs that go over some blocks alone
  };
  struct Narrowed {
    enum class To : std::uint8_t { renewed, struck, all_or_none };  // blocks; all where some are renewed
    std::uint32_t run;
    To to;
    std::span<const Range> all;
  };
  std::span<const Range> narrowed_to(const Narrowed& run) const;

  void fetch(Buffer buffer) override;
  void lose() override { holds_of_ = nullptr; }
  /// All that devices hold alone.
  void bring_home();

  Device& at(Place place) { return devices_[std::size_t(place)]; }
  Status attach(Place place, Buffer buffer, void* host, std::size_t bytes);
  Status upload(Buffer buffer, WorldState& state, const Schedule& schedule, StepReport& report);
  std::uint32_t lanes(Place place, Domain domain, const Schedule& schedule);
  Status attach_table(Place place, Buffer buffer, WorldState& state);
  /// Finds calls_, and what undo must find.
  void prepare_calls(const StepPlan& plan, bool timings, bool strays, const WorldState& state,
                     const Schedule& schedule);
  void add_run(const PlanEntry& entry, const WorldState& state, const Schedule& schedule);
  void narrow(const PlanEntry& entry);
  void add_own(const PlanEntry& entry, const WorldState& state, const Schedule& schedule);
  Status call(const Call& call, WorldState& state, const Schedule& schedule, const void* infos, StepReport& report);
  double substep_of(const PlanEntry& entry, const void* infos, Precision precision) const;
  Status kernels(const Call& call, WorldState& state, const void* infos);
  Status collide_again(const PlanEntry& entry, bool last, WorldState& state, const void* infos,
                       const KernelRun& impacts);
  Status keep_left(WorldState& state);
  Status run_watched(Place place, std::span<const KernelRun> runs, WorldState& state);
  bool keeps(Buffer buffer) const;
  bool traces() const { return tracer_.told && !gl_; }
  Status transfer(const PlanEntry& entry, WorldState& state, StepReport& report);

  Bound bound_;
  std::vector<Place> exchanged_;  // where the table of contacts is bound
  std::vector<Call> calls_;
  std::vector<KernelRun> runs_;
  std::vector<Range> ranges_;         // of runs_
  std::uint32_t infos_ = 0;           // how many blocks of them
  std::vector<Buffer> kept_;          // what the plan overwrites and undo must find
  std::vector<Buffer> kept_there_;    // and what the device has a second copy of, since it alone had it
  bool may_be_undone_ = false;        // though the plan is a flight
  std::unique_ptr<Workers> workers_;  // outlives the backends
  std::uint32_t threads_ = 0;         // that were asked for
  std::array<Device, 2> devices_;     // by Place
  Rollback rollback_;
  Tables* holds_of_ = nullptr;  // whose rows the device may hold alone
  Status fetched_;              // whether all that was asked for could be brought
  bool gl_ = false;             // takes part
  bool left_ = false;           // see `left`
  bool watched_ = false;
  Tracer tracer_;
  Collider* collider_ = nullptr;  // of the step
  std::vector<Narrowed> narrowed_;
};

}  // namespace pcphys
