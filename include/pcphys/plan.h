// The step plan: data that says what a step runs, in which order, where, and what was left out and why.
// A pure function of what the world holds and of the settings; it can be printed and compared.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace pcphys {

/// Where a stage runs.
enum class Place : std::uint8_t { cpu, gl };
const char* name(Place place);

/// The parts of a sub-step that are put on a place each, and what comes after the last where islands are found
/// on a device (StepSettings::islands).
enum class Stage : std::uint8_t { integrate, joints, impulses, islands };
std::string_view name(Stage stage);

/// How bodies move between impulses (docs/integrate.md). `verlet`: exact drag, and free rotation of second order.
/// `seed`: the scheme of the document that pcphys began with, to compare with it: drag by a factor 1 - F h, constant
/// angular velocity, velocities half a sub-step late.
enum class Integrator : std::uint8_t { verlet, seed };
const char* name(Integrator integrator);

/// Which coefficients a kernel is given: those of the step's start, of the solve, of contacts
/// that joints have brought together in it, of what undoes overlaps by poses, of the relax pass, or of the step's end.
enum class Phase : std::uint8_t { first, biased, sent, push, relax, last };
inline constexpr unsigned phase_count = 6;

/// Sub-step classes: islands of octave k make 2^k times the sub-steps that the settings ask for (docs/substeps.md).
inline constexpr unsigned octave_count = 10;

enum class Kernel : std::uint8_t;
enum class Buffer : std::uint16_t;
enum class Domain : std::uint8_t;
struct OwnKernel;

struct PlanEntry {
  /// `collide`: the narrow phase of a sub-step, on the host.
  enum class Kind : std::uint8_t { kernel, upload, download, collide };
  Kind kind = Kind::kernel;
  Place place = Place::cpu;
  Kernel kernel{};  // of a kernel
  Buffer buffer{};  // of a transfer
  Phase phase = Phase::biased;
  bool barrier = false;       // uses what a kernel before it wrote, or writes what one read, on the same device
  std::uint32_t substep = 0;  // of the octave's
  std::uint8_t octave = 0;    // of the islands that a kernel is for; octave_count more for those of fourth order
  /// A kernel of the host's own, in place of `kernel`; of a transfer, one that uses the buffer.
  const OwnKernel* own = nullptr;
  /// It runs only while the kernel's run before struck something, and at most so often; 0: once, always.
  std::uint32_t again = 0;
  /// Of a transfer that `Stepper::plan_for` names: the whole buffer, in that world. 0 in plans of no world
  /// (`Stepper::plan`), which stand for steps of any size.
  std::uint64_t bytes = 0;
  bool transfers() const { return kind == Kind::upload || kind == Kind::download; }
  friend bool operator==(const PlanEntry&, const PlanEntry&) = default;
};

struct LeftOut {
  std::string what, why;
  friend bool operator==(const LeftOut&, const LeftOut&) = default;
};

/// A buffer that kernels of the plan use, and what the first of them runs over.
struct PlanBinding {
  Place place = Place::cpu;
  Buffer buffer{};
  Domain domain{};
  friend bool operator==(const PlanBinding&, const PlanBinding&) = default;
};

struct StepPlan {
  std::uint32_t substeps = 0;  // of octave 0
  bool flight = false;         // nothing meets or holds a body: one kernel makes all sub-steps of each
  std::vector<PlanEntry> entries;
  std::vector<LeftOut> left_out;
  std::vector<PlanBinding> bindings;                  // each buffer of each place once
  std::vector<Buffer> left_there;                     // on the device, until the host asks (StepSettings::resident)
  std::vector<Buffer> overwritten;                    // in the host's tables
  std::vector<std::shared_ptr<const OwnKernel>> own;  // kernels of the host's own that entries name
  friend bool operator==(const StepPlan&, const StepPlan&) = default;
};

/// Bytes of all transfers of a step whose plan has them (PlanEntry::bytes). The most that go: an upload is spared where
/// the device has what the host has.
struct TransferBytes {
  std::uint64_t up = 0, down = 0;
};
TransferBytes transfer_bytes(const StepPlan& plan);

/// A line an entry: where, what, its phase, what it reads and writes, of a transfer its bytes; then their sums, and
/// what was left out.
std::string to_text(const StepPlan& plan);
std::string_view kernel_name(const PlanEntry& entry);
std::string_view buffer_name(const PlanEntry& entry);
std::string_view stage_name(const PlanEntry& entry);
std::string_view phase_name(const PlanEntry& entry);
/// Names of the buffers that a kernel entry reads, and of those it writes.
std::vector<std::string_view> reads(const PlanEntry& entry);
std::vector<std::string_view> writes(const PlanEntry& entry);

}  // namespace pcphys
