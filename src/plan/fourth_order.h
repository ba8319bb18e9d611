// Which joint trees move in fourth order (StepSettings::order, docs/integrate.md): those on which nothing but forces
// and pins acts, softly enough for the sub-step.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pcphys/step.h"
#include "plan/forest.h"
#include "plan/solved_joints.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

/// Why a tree stays at second order.
enum class SecondOrder : std::uint8_t {
  pivot,
  loop,
  angles,
  drive,
  drag,
  carried,
  contact,
  stiff,
  fast,
  own_kernel,
  count
};
/// What and why, of the plan.
std::array<const char*, 2> reason(SecondOrder why);

class FourthOrder {
 public:
  /// Follows a change of objects; of contacts.
  void forget() { trees_known_ = contacts_known_ = false; }
  void forget_contacts() { contacts_known_ = false; }
  /// Of a step of `dt`; none where StepSettings::order is 2. `closing`: rows of joints that stand in no tree. `own`:
  /// kernels of the host's own act in sub-steps.
  void choose(const WorldState& state, const Forest& forest, const SolvedJoints& joints,
              std::span<const std::uint32_t> closing, bool own, const StepSettings& settings, double dt);

  /// Trees of fourth order, ascending.
  std::span<const std::uint32_t> trees() const { return chosen_; }
  /// Of the others, bits by SecondOrder.
  std::uint32_t reasons() const { return reasons_; }
  /// As Octaves::used, of octave 0, where `moving` bodies move.
  std::uint32_t classes(std::uint32_t moving) const;
  std::size_t memory_bytes() const { return bytes_of(tree_of_, why_not_, pins_, first_pin_, touched_, chosen_); }

 private:
  /// A pin, how much a force on it turns its two bodies (the larger |r| / trace of the inertia) [1/(kg m)], and the
  /// mass that hangs on it.
  struct Pin {
    std::uint32_t joint;  // row
    double response, mass;
  };
  /// Once for each change of objects.
  void find_trees(const WorldState& state, const Forest& forest, const SolvedJoints& joints,
                  std::span<const std::uint32_t> closing);
  void find_pins(const WorldState& state, std::span<const TreeNode> tree, const SolvedJoints& joints);
  void find_touched(const WorldState& state);
  double stiffness(const WorldState& state, std::uint32_t tree, double h) const;

  std::vector<std::uint32_t> tree_of_;  // by body row: tree + 1, of bodies that move
  std::vector<std::uint32_t> why_not_;  // by tree, bits that follow from the objects
  std::vector<Pin> pins_;
  std::vector<std::uint32_t> first_pin_;  // by tree, and the end
  std::vector<char> touched_;             // by tree
  bool trees_known_ = false, contacts_known_ = false;
  std::vector<std::uint32_t> chosen_;
  std::uint32_t bodies_ = 0, reasons_ = 0;  // bodies: of the chosen trees
};

}  // namespace pcphys
