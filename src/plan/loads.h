// Sub-steps for heavy loads. A contact is as stiff as the lighter of its bodies lets it be (docs/impulses.md), so a
// load of a thousand times that body presses it in by a thousand times as much; sub-steps undo that with their square.
#pragma once
#include <cstdint>
#include <vector>

#include "plan/islands.h"
#include "plan/wanted.h"
#include "world/memory.h"
#include "world/state.h"

namespace pcphys {

class TreeNodes;

class Loads {
 public:
  /// Follows a change of contacts: lists those that could carry something, in islands whose masses differ.
  void find(const WorldState& state, const TreeNodes& trees, Islands& islands);
  void forget_contacts() { listed_.clear(); }
  /// Adds what sub-steps of `h`, as soft rows are made for, need, up to `highest_octave`, for the weights that could
  /// rest on free bodies.
  void want(const WorldState& state, double h, std::uint8_t highest_octave, std::vector<Wanted>& wanted);
  std::size_t memory_bytes() const { return bytes_of(masses_, listed_, rests_, held_, carried_); }

 private:
  struct Masses {
    double lightest = 0, heaviest = 0;  // as inverse masses; 0: none
  };
  /// A contact whose upper body could rest on the lower one.
  struct Rest {
    std::uint32_t contact;
    bool uneven;  // masses of its island differ by constants::uneven_masses
    std::uint32_t lower = 0, upper = 0;
    double share = 0;   // of the normal that is along gravity
    double height = 0;  // of the upper one [m]
  };
  /// Hands all weights down from body to body, each in shares to what it could rest on.
  void hand_down(const WorldState& state);

  std::vector<Masses> masses_;  // by body row, of islands at their roots
  // all; those of several points, or where masses are uneven, from the highest on
  std::vector<Rest> listed_, rests_;
  std::vector<double> held_, carried_;  // by body row: shares of its contacts below; mass that could rest on it [kg]
};

}  // namespace pcphys
