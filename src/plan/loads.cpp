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
    if (x >= constants::uneven_masses * y) uneven_.push_back({row, x / y});
    if (y >= constants::uneven_masses * x) uneven_.push_back({row, -y / x});
  }
}

std::uint32_t Loads::refinement(const WorldState& state, const StepSettings& settings, double dt) const {
  double largest = 0;  // acceleration that the load would give to what carries it [m/s^2]
  for (const Uneven& u : uneven_)
    largest = std::max(largest, -u.ratio * dot(state.tables.get3(Buffer::contact, u.contact, 0), state.gravity));
  const double h = dt / settings.substeps, frequency = constants::contact_frequency_times_h / h;
  const double aim = constants::load_overlap * settings.contact_margin;
  double overlap = largest / (frequency * frequency);
  if (overlap <= constants::heavy_overlap * settings.contact_margin) return 1;
  std::uint32_t times = 1;
  for (; overlap > aim && 2 * times <= settings.load_refinement; overlap /= 4) times *= 2;
  return times;
}

}  // namespace pcphys
