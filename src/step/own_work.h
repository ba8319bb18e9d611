// A stepper's kernels of the host's own, and what forces are before they add to them.
#pragma once
#include <memory>
#include <string_view>

#include "plan/own_kernels.h"
#include "world/state.h"

namespace pcphys {

/// Whether what the kernel wrote, as it stands in the host's tables, is finite.
/// Error: not_finite, naming kernel and object.
Status check_written(const WorldState& state, const OwnKernel& kernel);
/// Whether what it reads is.
bool reads_finite(const WorldState& state, const OwnKernel& kernel);

class OwnWork {
 public:
  /// Before a step of this world, and before a kernel is added: whether the kernels fit it still. Where forces are
  /// made, by this stepper or another, they begin anew in each (sub-)step with what constants and callbacks give
  /// (WorldState::gathered), which is a kernel too; where some are made once a step and others in each sub-step, these
  /// begin with what those have made. Errors: bad_argument where they are of another world;
  /// stale_id where a property was removed.
  Status follow(WorldState& state);
  /// The same where nothing may change.
  Status check(const WorldState& state) const;

  /// Errors: those of `resolve` and OwnKernels::add. `follow` comes first, and after it.
  Result<const OwnKernel*> add(WorldState& state, const KernelDef& def);
  Status remove(WorldState& state, std::string_view name);
  OwnKernel* find(std::string_view name) const { return kernels_.find(name); }
  /// Their world learns of it when a stepper next follows it: it may be gone.
  void clear();
  /// What was copied before a `clear`.
  void put_back(const OwnWork& before);

  const OwnKernels& kernels() const { return kernels_; }
  OwnKernels::Ordered ordered() const { return kernels_.ordered(); }
  /// Whether there are some of the host's, and not of the library alone.
  bool hosts() const;
  /// Of properties of the host's own, after a step: as check_written.
  Status check_written(const WorldState& state) const;
  bool of_another(const WorldState& state) const { return hosts() && serial_ != state.serial; }

 private:
  /// When kernels of the host's own make forces.
  struct Makers {
    bool once = false, each = false;
    bool any() const { return once || each; }
    bool both() const { return once && each; }
  };
  Makers makers() const;
  Status begin_forces(WorldState& state);
  Status add_beginning(const WorldState& state, const KernelText& text, bool once_a_step);
  void forget_beginning();
  void take_hold(WorldState& state);
  void let_go(WorldState& state);

  OwnKernels kernels_;
  std::uint64_t serial_ = 0;    // of the world that they are of
  std::uint64_t removals_ = 0;  // of its properties, when they were last looked at
  /// Lasts as long as there are kernels of the host's for that world (WorldState::kernel_holds).
  std::shared_ptr<const char> hold_;
};

}  // namespace pcphys
