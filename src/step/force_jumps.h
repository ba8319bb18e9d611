// Forces of the host's own that jump between two steps, since the host changed a parameter of a kernel that makes them.
//
// The stored velocity lags half a sub-step, which the old force would have filled (docs/integrate.md): it moves by half
// a kick of what the force changes by, as where the host changes gravity or a constant force (WorldState::kick). So the
// kernels of that moment run twice at the pose of now, with the parameters of before and with those of now, and what
// they wrote goes back. On the CPU, wherever their stage is: the bits are the same, and only steps after a change pay.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "step/runner.h"
#include "world/state.h"

namespace pcphys {

class ForceJumps {
 public:
  /// Before the kernels of a step: the old force until now, the new one from now on, of the bodies of these rows. `h`:
  /// the sub-step, of `step`. What pairs, joints with their bodies and kernels without a C++ side make is not looked
  /// at: it jumps half a sub-step early.
  void act(WorldState& state, OwnKernels::Ordered kernels, std::span<const std::uint32_t> bodies, double h, double step,
           Runner& runner);
  /// The step was made.
  static void forget(OwnKernels::Ordered kernels);

 private:
  /// What forces and torques are, with the parameters of before or with those of now; tables are left as they are.
  void evaluate(WorldState& state, OwnKernels::Ordered kernels, std::span<const std::uint32_t> bodies, bool before,
                std::vector<std::byte>& forces);
  void run(WorldState& state, const OwnKernel& kernel, std::span<const std::uint32_t> bodies, bool before) const;
  void keep(const WorldState& state, OwnKernels::Ordered kernels);
  void put_back(WorldState& state) const;

  struct Kept {
    Buffer buffer{};
    std::vector<std::byte> bytes;
  };
  std::vector<Kept> kept_;  // what kernels write, from jump to jump
  std::vector<std::byte> old_, new_;
  std::byte given_[5 * sizeof(double)] = {};  // in the world's precision
};

}  // namespace pcphys
