// The stepper: decides what a world needs (the plan) and runs it on the backends that were chosen.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pcphys/constants.h"
#include "pcphys/events.h"
#include "pcphys/kernel.h"
#include "pcphys/plan.h"
#include "pcphys/result.h"
#include "pcphys/types.h"
#include "pcphys/world.h"

namespace pcphys {

class ContactTrace;

enum class NarrowPhase : std::uint8_t { native, fcl };

/// How steps are made. All of it may change between two steps; results do not depend on where a stage runs.
struct StepSettings {
  Place integrate = Place::cpu, joints = Place::cpu, impulses = Place::cpu;
  Integrator integrator = Integrator::verlet;
  std::uint32_t substeps = 4;
  /// Of the motion of joint trees: 2, or 4 where nothing but forces and pins acts on one (docs/integrate.md).
  std::uint32_t order = 2;
  /// Most by which a step may multiply the sub-steps of an island that needs it (docs/substeps.md); 1: never.
  std::uint32_t refinement = 16;
  /// Lanes of the CPU: 1, 4, 8 (f32) or 1, 4 (f64); 0: the widest there is, or fewer where those are enough.
  std::uint32_t lanes = 0;
  std::uint32_t threads = 1;  // of the CPU, up to 256; 0: as many as the processor runs at a time
  NarrowPhase narrow = NarrowPhase::native;
  int device = -1;            // EGL device; -1: the first that works
  bool host_context = false;  // use the GL context that is current on this thread
  /// On GL, where nothing meets or holds a body (StepPlan::flight): what a step leaves on the device comes to the host
  /// when something asks for it, a view, a hash or a step that needs it there, by the thread that asks. A device that
  /// fails takes it along.
  bool resident = false;
  bool timings = true;  // clock the step and each stage (StepReport); on GL this waits for the device after each

  /// Islands at rest stop being stepped until something wakes them (docs/sleeping.md).
  /// A step with it off wakes what sleeps.
  bool sleep = false;
  /// Where who is in which island is found after a step: by union-find on the CPU, or by label propagation on the
  /// device. The result is the same.
  Place islands = Place::cpu;
  double sleep_speed = constants::sleep_speed;  // what is faster is not at rest [m/s]
  double sleep_spin = constants::sleep_spin;    // nor what spins faster [rad/s]
  double sleep_time = constants::sleep_time;    // how long an island is at rest before it sleeps, above 0 [s]

  double push_speed = 3;               // at which an overlap is undone, at most (docs/limits.md) [m/s]
  double restitution_threshold = 0.5;  // approach speeds below it do not bounce [m/s]; 0 switches it off
  /// Contacts are kept up to this gap [m]; 0: up to constants::contact_share of the smaller shape.
  double contact_margin = 0;
  std::size_t max_pairs = 1u << 24;  // more is an error that says how many there are

  /// What Stepper::events tells of; nothing is spent on the rest (docs/events.md).
  bool contact_events = false;  // begun and ended
  bool hit_events = false;
  bool body_events = false;  // moved, fell asleep, woke
  double hit_speed = 1;      // contacts that meet slower are no hits [m/s]

  void set_all(Place place) { integrate = joints = impulses = place; }
};

enum class Timer : std::uint8_t { forces, broad, narrow, plan, upload, integrate, joints, impulses, download, count };
const char* name(Timer timer);

struct StepReport {
  Error error;                 // code none: the step was made. Otherwise the world is as it was before
  std::uint64_t step = 0;      // how many steps this stepper has made
  std::uint32_t substeps = 0;  // the most that an island made: the setting, or more (StepSettings::refinement)
  std::uint32_t refined = 0;   // bodies whose islands made more than the setting
  std::uint32_t limited = 0;   // bodies whose islands would have made more yet: beyond StepSettings::refinement
  /// Times that this step was undone and made anew: for what turned out to need far more sub-steps (docs/substeps.md),
  /// for bodies that went further than contacts were looked for, for one that had to be frozen.
  std::uint32_t repeats = 0;
  bool given_up = false;  // the step was kept as it was after eight tries, though it asked to be made anew once more
  std::uint32_t fourth_order = 0;  // bodies that moved in fourth order (StepSettings::order)
  std::uint32_t bodies = 0, joints = 0, pairs = 0, contacts = 0, points = 0, colours = 0;
  std::uint32_t asleep = 0, islands_asleep = 0;  // bodies that sleep after this step, and how many islands they make
  std::uint32_t fell_asleep = 0, woke = 0;       // bodies, in this step
  /// What the direct solve of joint trees does not carry: joints with angles that close a loop beside another joint of
  /// the same bodies, joints that do in a net, and contacts of trees with more than 64 bodies.
  /// They are solved as rows (docs/joint-trees.md).
  std::uint32_t joints_as_rows = 0, tree_contacts_as_rows = 0;
  std::uint64_t transfer_bytes = 0;                    // between host and device
  std::uint64_t upload_bytes = 0;                      // of them, to the device
  std::vector<BodyId> frozen;                          // in this step; see World::frozen
  double total_ms = 0;                                 // and `ms`: zeros without StepSettings::timings
  std::array<double, std::size_t(Timer::count)> ms{};  // by Timer

  explicit operator bool() const { return error.code == ErrorCode::none; }
};

/// Memory of a step, of one buffer in one place.
struct BufferUse {
  std::string_view name, table;  // as long as the world has that property; table: empty where it is of none
  Place place = Place::cpu;
  std::size_t bytes = 0;
};

/// A world may be stepped by several steppers, one after the other: what comes of a step follows from the world and the
/// settings, not from what its stepper made before (but for Stepper::events, which tell of changes since its last
/// step). While one steps a world, and of itself, any other change is ErrorCode::busy.
class Stepper {
 public:
  explicit Stepper(const StepSettings& settings = {});
  ~Stepper();
  Stepper(Stepper&&) noexcept;
  Stepper& operator=(Stepper&&) noexcept;

  /// Takes effect at the next step. Values out of their range are refused here and leave the settings as they
  /// were; what the machine lacks (a GL device, a lane width of the world's precision) is reported by the step.
  /// The constructor's settings are checked at the first step.
  Status configure(const StepSettings& settings);
  const StepSettings& settings() const;

  /// Moves the world on by dt [s]. The report stands until the next call.
  const StepReport& step(World& world, double dt);

  /// What happened in the last step, of what the settings ask for; empty if it failed.
  /// It stands until the next call of `step`.
  StepEvents events() const;

  /// A kernel of the host's own runs in every step of this world from now on; a stepper has kernels of one world at a
  /// time. Errors: bad_argument (signature, more than eight buffers, order), unknown_name, wrong_type, name_taken,
  /// unavailable; device_error where a stage is on gl and its compiler refuses the text. Nothing is added then.
  Status add_kernel(World& world, const KernelDef& def);
  Status remove_kernel(World& world, std::string_view name);
  /// All of them, whether their world is still there or not: then this stepper can step another. Where it is, its next
  /// step, by whatever stepper, wakes who sleeps there, as remove_kernel does at once; so it is when a stepper goes
  /// that has kernels.
  Status remove_kernels();
  /// From the next step on; of the type that it was given as.
  Status set_parameter(std::string_view kernel, const KernelParameter& parameter);

  /// What the last step ran, or (`plan_for`) what a step of this world would, with the bytes of its transfers: for
  /// contacts as the last step left them, and islands of the sub-steps that the settings ask for. It needs no device.
  const StepPlan& plan() const;
  Result<StepPlan> plan_for(const World& world, double dt);

  /// What this world and the stepper take, with the device's copies: buffers, the host's own properties among them, and
  /// by parts of the step what stands in none ("objects" are the world's). Nothing of it is named twice;
  /// World::memory_bytes is part of it.
  std::vector<BufferUse> memory(const World& world) const;
  /// Gives back all memory, and the devices. The next step makes again what it needs, and takes as long as a new
  /// stepper's; what comes of it is the same.
  Status shrink();

  /// For tests and `pcphys wild`: told what contacts do in each sub-step (src/step/contact_trace.h), where all stages
  /// are on the CPU; null: nobody is.
  void set_trace(ContactTrace* trace);

  /// "cpu, 8 lanes", or the GL renderer's name; empty when no stage runs there.
  std::string device(Place place) const;

 private:
  struct Inside;
  Inside& inside(const char* call = __builtin_FUNCTION());
  const Inside& inside(const char* call = __builtin_FUNCTION()) const;
  /// Whether no step of it runs, nor of the world.
  Status changeable(const char* call = __builtin_FUNCTION()) const;
  Status changeable(const World& world, const char* call = __builtin_FUNCTION()) const;
  std::unique_ptr<Inside> inside_;
};

}  // namespace pcphys
