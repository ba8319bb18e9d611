#include "plan/loads.h"

#include <algorithm>

#include "pcphys/constants.h"
#include "plan/tree_paths.h"

namespace pcphys {

void Loads::find(const WorldState& state, const TreeNodes& trees) {
  uneven_.clear();
  for (std::uint32_t row = 1; row < state.contacts.ends.size(); row++) {
    const auto [a, b] = state.contacts.ends[row];
    if (!state.responds(a) || !state.responds(b) || trees.node(a) > 0 || trees.node(b) > 0) continue;
    const double x = state.tables.get(Buffer::motion, a, 3), y = state.tables.get(Buffer::motion, b, 3);
    if (x >= constants::uneven_masses * y) uneven_.push_back({row, a, x / y});
    if (y >= constants::uneven_masses * x) uneven_.push_back({row, a, -y / x});
  }
}

void Loads::want(const WorldState& state, const StepSettings& settings, double dt, std::uint8_t highest_octave,
                 std::vector<Wanted>& wanted) const {
  const double h = dt / settings.substeps, frequency = constants::contact_frequency_times_h / h;
  const double aim = constants::load_overlap * settings.contact_margin;
  for (const Uneven& u : uneven_) {
    // acceleration that the load would give to what carries it [m/s^2], and how far it is then pressed in [m]
    const double load = -u.ratio * dot(state.tables.get3(Buffer::contact, u.contact, 0), state.gravity);
    double overlap = load / (frequency * frequency);
    if (overlap <= constants::heavy_overlap * settings.contact_margin) continue;
    std::uint8_t octave = 0;
    for (; overlap > aim && octave < highest_octave; overlap /= 4) octave++;
    if (octave > 0) wanted.push_back({u.body, octave, true});
  }
}

}  // namespace pcphys
