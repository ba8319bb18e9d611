#include "plan/loads.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcphys/constants.h"
#include "plan/tree_paths.h"

namespace pcphys {

namespace {
double inverse_mass(const WorldState& state, std::uint32_t row) { return state.tables.get(Buffer::motion, row, 3); }
}  // namespace

void Loads::find(const WorldState& state, const TreeNodes& trees, Islands& islands) {
  listed_.clear();
  if (state.contacts.ends.size() < 2) return;
  islands.build(state);
  masses_.assign(state.bodies.size(), {});
  for (std::uint32_t row = 1; row < state.bodies.size(); row++) {
    if (!state.responds(row)) continue;
    Masses& of = masses_[islands.root(row)];
    const double inverse = inverse_mass(state, row);
    of.lightest = std::max(of.lightest, inverse);
    of.heaviest = of.heaviest > 0 ? std::min(of.heaviest, inverse) : inverse;
  }
  for (std::uint32_t row = 1; row < state.contacts.ends.size(); row++) {
    const auto [a, b] = state.contacts.ends[row];
    if (trees.node(a) > 0 || trees.node(b) > 0 || state.asleep(a)) continue;
    const Masses& of = masses_[islands.root(state.responds(a) ? a : b)];
    if (of.heaviest > 0 && of.lightest > of.heaviest)
      listed_.push_back({row, of.lightest >= constants::uneven_masses * of.heaviest});
  }
}

void Loads::hand_down(const WorldState& state) {
  const Vec3 up = (-1 / length(state.gravity)) * state.gravity;
  rests_.clear();
  for (const Rest& rest : listed_)
    if (rest.uneven || state.tables.get(Buffer::contact, rest.contact, 3) >= 2) rests_.push_back(rest);
  if (rests_.empty()) return;
  held_.assign(state.bodies.size(), 0);
  for (Rest& rest : rests_) {
    const double rises = dot(state.tables.get3(Buffer::contact, rest.contact, 0), up);
    const auto [a, b] = state.contacts.ends[rest.contact];
    rest.lower = rises < 0 ? b : a;
    rest.upper = rises < 0 ? a : b;
    rest.share = std::fabs(rises);
    rest.height = dot(state.tables.get3(Buffer::pose, rest.upper, 0), up);
    held_[rest.upper] += rest.share;
  }
  std::ranges::sort(rests_, {}, [](const Rest& rest) { return std::pair(-rest.height, rest.contact); });
  carried_.assign(state.bodies.size(), 0);
  for (const Rest& rest : rests_) {
    if (!state.responds(rest.upper) || !(rest.share > 0)) continue;
    const double load = 1 / inverse_mass(state, rest.upper) + carried_[rest.upper];
    carried_[rest.lower] += load * rest.share / held_[rest.upper];
  }
}

void Loads::want(const WorldState& state, double h, std::uint8_t highest_octave, std::vector<Wanted>& wanted) {
  const double g = length(state.gravity), frequency = constants::soft_frequency_times_h / h;
  if (listed_.empty() || g == 0) return;
  hand_down(state);
  if (rests_.empty()) return;
  const double give = g / (frequency * frequency);  // how far the weight of one body presses in one as heavy [m]
  for (std::uint32_t row = 1; row < carried_.size(); row++) {
    if (!(carried_[row] > 0) || !state.responds(row)) continue;
    const double times = carried_[row] * inverse_mass(state, row), size = state.size(row);
    if (!(size > 0)) continue;  // it does not rotate, and is as large as one likes
    const double most = times < constants::uneven_masses ? constants::largest_give : constants::load_give;
    const std::uint8_t octave = octave_for(give * times / size, most, highest_octave);
    if (octave > 0) wanted.push_back({row, octave});
  }
}

}  // namespace pcphys
