// Joint trees that are torn: they hang on what does not answer, which is fixed or driven, and were pulled through what does not give way, so
// that no motion keeps both joints and contacts. What such a tree needs to come together again without a blow (docs/substeps.md#torn).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "plan/wanted.h"
#include "world/state.h"

namespace pcphys {

class Forest;

class Tears {
 public:
  /// Follows a change of objects.
  void update_structure(const WorldState& state, const Forest& forest);

  /// Body rows, ascending, of trees that no turning closes: some joint's bodies are further apart than their pins reach, by more than
  /// constants::tear_apart of the body's size. Contacts with what stands or is driven are none of theirs. The span lasts until the next call.
  std::span<const std::uint32_t> apart(const WorldState& state);
  /// After a try of a step with sub-steps of `h` [s] in octave 0: adds `octave` for torn trees that whirl.
  void want(const WorldState& state, double h, std::uint8_t octave, std::vector<Wanted>& wanted) const;

  /// Finds torn trees, of which a body turns by more than constants::largest_joint_turn in the shortest sub-step of `h` [s].
  /// How many bodies they have.
  std::uint32_t find_unresolved(const WorldState& state, double h);
  /// Slows them, about what they hang on, until they turn by that.
  void slow(WorldState& state) const;

 private:
  struct Link {
    std::uint32_t body, parent, joint;  // rows
    double reach, size;                 // [m]: of the arms of its pin; twice the body's largest radius of gyration
  };
  /// Whether some joint of it is open by more than constants::torn of its body's size.
  bool torn(const WorldState& state, std::size_t tree) const;
  template <class Scalar> void want_of(const WorldState& state, double h, std::uint8_t octave, std::vector<Wanted>& wanted) const;
  std::span<const Link> links(std::size_t tree) const {
    return std::span(links_).subspan(first_[tree], first_[tree + 1] - first_[tree]);
  }
  std::size_t trees() const { return first_.size() - 1; }

  std::vector<Link> links_;            // of trees on a root that does not answer, but for pivots; parents first
  std::vector<std::size_t> first_{0};  // of each such tree
  std::vector<std::uint32_t> apart_;   // rows
  std::vector<std::pair<std::size_t, double>> unresolved_;  // trees, and the share of their motion that is left to them
};

}  // namespace pcphys
