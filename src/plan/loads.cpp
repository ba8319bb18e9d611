#include "plan/loads.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcphys/constants.h"
#include "plan/tree_paths.h"

namespace pcphys {

void Loads::find(const WorldState& state, const TreeNodes& trees) {
  uneven_.clear();
  for (std::uint32_t row = 1; row < state.contacts.ends.size(); row++) {
    const auto [a, b] = state.contacts.ends[row];
    if (!state.responds(a) || !state.responds(b) || trees.node(a) > 0 || trees.node(b) > 0 || state.asleep(a)) continue;
    const double x = state.tables.get(Buffer::motion, a, 3), y = state.tables.get(Buffer::motion, b, 3);
    if (x >= constants::uneven_masses * y) uneven_.push_back({row, a, x / y});
    if (y >= constants::uneven_masses * x) uneven_.push_back({row, b, -y / x});
  }
}

void Loads::want(const WorldState& state, double h, std::uint8_t highest_octave, std::vector<Wanted>& wanted) const {
  const double frequency = constants::soft_frequency_times_h / h;
  for (const Uneven& u : uneven_) {
    // acceleration that the load would give to what carries it [m/s^2], and how far it is then pressed in [m]
    const double load = -u.ratio * dot(state.tables.get3(Buffer::contact, u.contact, 0), state.gravity);
    const double overlap = load / (frequency * frequency), size = state.size(u.lighter);
    if (!(size > 0)) continue;  // it does not rotate, and is as large as one likes
    const std::uint8_t octave = octave_for(overlap / size, constants::load_give, highest_octave);
    if (octave > 0) wanted.push_back({u.lighter, octave});
  }
}

}  // namespace pcphys
