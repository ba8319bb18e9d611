#include "plan/infos.h"

#include <algorithm>
#include <limits>

#include "pcphys/constants.h"

namespace pcphys {
namespace {

/// A spring-damper of angular frequency w and damping ratio z, taken implicitly over a sub-step h, as scales of
/// a rigid row's impulse: rate = w / (2 z + h w), mass scale = c / (1 + c), impulse scale = 1 / (1 + c) with
/// c = h w (2 z + h w). (E. Catto, Solver2D, 2024; Soft constraints, GDC 2011.)
struct Soft {
  double rate, mass_scale, impulse_scale;
};
Soft soft(double frequency_times_h, double damping_ratio, double h) {
  const double a = 2 * damping_ratio + frequency_times_h, c = frequency_times_h * a;
  return {frequency_times_h / (h * a), c / (1 + c), 1 / (1 + c)};
}

}  // namespace

double soft_substep_length(double before, double h, double dt) {
  return std::max(h, before / (1 + dt / constants::stiffening_time));
}

template <class Scalar> void fill_infos(const InfoInputs& from, InfoOf<Scalar> (&infos)[phase_count], unsigned octave) {
  const double h = from.h / double(1u << octave), step = from.h * from.substeps, gravity = length(from.gravity);
  const Soft rows =
      soft(constants::soft_frequency_times_h * (from.h / from.soft_substep), constants::soft_damping_ratio, h);

  InfoOf<Scalar>& biased = infos[unsigned(Phase::biased)];
  biased = {};
  biased.h = Scalar(h);
  biased.inverse_h = Scalar(1 / h);
  biased.gravity_x = Scalar(from.gravity.x);
  biased.gravity_y = Scalar(from.gravity.y);
  biased.gravity_z = Scalar(from.gravity.z);
  biased.h_before = Scalar(h);
  biased.by_forces = octave > 0;
  biased.impulse_ratio = 1;
  biased.soft_rate = Scalar(rows.rate);
  biased.soft_mass_scale = Scalar(rows.mass_scale);
  biased.soft_impulse_scale = Scalar(rows.impulse_scale);
  biased.soft_trend = Scalar(std::max(0.0, 1 - 2 * rows.impulse_scale / (rows.rate * h)));
  biased.contact_preload = Scalar(constants::contact_preload * gravity * h);
  biased.settled_load = Scalar(constants::settled_load);
  biased.least_load = Scalar(constants::least_load * gravity * h);
  biased.push_speed = Scalar(from.push_speed);
  biased.row_push_speed = Scalar(std::min(from.push_speed, std::max(gravity, from.push_speed) * step));
  biased.tree_push_speed = Scalar(std::min(from.push_speed, gravity * step));
  biased.joint_push_speed = Scalar(constants::joint_push_speed);
  biased.limit_give = Scalar(constants::largest_give);
  biased.loop_give = Scalar(constants::loop_give);
  biased.spin_floor = Scalar(constants::tree_spin_floor);
  biased.rounds = constants::rounds;
  biased.net_made = Scalar(constants::net_made);
  biased.stale_share = Scalar(constants::stale_share);
  biased.locked_interval = Scalar(constants::locked_interval);
  biased.limit_stiffness = Scalar(rows.mass_scale / rows.impulse_scale);
  biased.tree_damping = Scalar(constants::tree_damping);
  biased.lock_stiffness = Scalar(constants::lock_stiffness);
  biased.restitution_threshold = Scalar(from.restitution_threshold);
  biased.struck_speed = Scalar(constants::struck_speed);
  biased.rounding = Scalar(constants::roundings * std::numeric_limits<Scalar>::epsilon());

  biased.carries = from.carries;
  biased.substeps = Scalar(from.substeps << octave);
  biased.step = Scalar(from.h * from.substeps);
  biased.largest_state = Scalar(constants::largest_state);
  biased.largest_momentum = Scalar(constants::largest_momentum);

  const auto change = [&](Phase phase, double before, double after) {
    InfoOf<Scalar>& info = infos[unsigned(phase)];
    info = biased;
    info.h = Scalar(after);
    info.inverse_h = Scalar(1 / after);
    info.h_change = Scalar(1 - after / before);
    info.h_before = Scalar(before);
    info.impulse_ratio = Scalar(after / before);
  };
  change(Phase::first, from.last_substep > 0 ? from.last_substep : from.h, h);
  infos[unsigned(Phase::first)].begins = 1;
  change(Phase::last, h, from.h);

  infos[unsigned(Phase::sent)] = biased;
  infos[unsigned(Phase::sent)].sent = 1;
  infos[unsigned(Phase::push)] = biased;
  infos[unsigned(Phase::push)].push = 1;

  InfoOf<Scalar>& relax = infos[unsigned(Phase::relax)];
  relax = biased;
  relax.soft_rate = 0;
  relax.soft_mass_scale = 1;
  relax.soft_impulse_scale = 0;
  relax.load_ahead = 1;
}

template void fill_infos<float>(const InfoInputs&, InfoOf<float> (&)[phase_count], unsigned);
template void fill_infos<double>(const InfoInputs&, InfoOf<double> (&)[phase_count], unsigned);

}  // namespace pcphys
