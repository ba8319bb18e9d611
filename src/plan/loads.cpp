#include "plan/loads.h"

#include <algorithm>

#include "pcphys/constants.h"
#include "plan/tree_paths.h"

namespace pcphys {

void Loads::find(const WorldState& state, const TreeNodes& trees) {
  uneven_.clear();
  for (std::uint32_t row = 1; row < state.contacts.ends.size(); row++) {
    const auto [a, b] = state.contacts.ends[row];
    if (!state.responds(a) || !state.responds(b) || path_kind(trees, a, b) > 0) continue;
    const double x = state.tables.get(Buffer::motion, a, 3), y = state.tables.get(Buffer::motion, b, 3);
    if (std::max(x, y) >= constants::uneven_masses * std::min(x, y)) uneven_.push_back({row, std::max(x, y)});
  }
}

std::uint32_t Loads::refinement(const WorldState& state, const StepSettings& settings, double dt) const {
  if (uneven_.empty() || state.last_substep <= 0) return 1;
  double largest = 0;  // [m/s^2]
  for (const Uneven& u : uneven_) {
    const Quat impulses = state.tables.get4(Buffer::contact, u.contact, 20);
    largest = std::max(largest, (impulses.x + impulses.y + impulses.z + impulses.w) * u.inverse_mass / state.last_substep);
  }
  const double h = dt / settings.substeps, frequency = constants::contact_frequency_times_h / h;
  const double aim = constants::load_overlap * settings.contact_margin;
  double overlap = largest / (frequency * frequency);
  if (overlap <= 4 * aim) return 1;
  std::uint32_t times = 1;
  for (; overlap > aim && 2 * times <= settings.load_refinement; overlap /= 4) times *= 2;
  return times;
}

}  // namespace pcphys
