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

/// Of the phase that all others differ little from; `h`: the sub-step of the octave.
template <class Scalar> InfoOf<Scalar> biased_info(const InfoInputs& from, double h, unsigned octave) {
  const double step = from.h * from.substeps, gravity = length(from.gravity);
  const Soft rows =
      soft(constants::soft_frequency_times_h * (from.h / from.soft_substep), constants::soft_damping_ratio, h);

  InfoOf<Scalar> info{};
  info.h = Scalar(h);
  info.inverse_h = Scalar(1 / h);
  info.gravity_x = Scalar(from.gravity.x);
  info.gravity_y = Scalar(from.gravity.y);
  info.gravity_z = Scalar(from.gravity.z);
  info.h_before = Scalar(h);
  info.by_forces = octave > 0;
  info.impulse_ratio = 1;
  info.soft_rate = Scalar(rows.rate);
  info.soft_mass_scale = Scalar(rows.mass_scale);
  info.soft_impulse_scale = Scalar(rows.impulse_scale);
  info.soft_trend = Scalar(std::max(0.0, 1 - 2 * rows.impulse_scale / (rows.rate * h)));
  info.contact_preload = Scalar(constants::contact_preload * gravity * h);
  info.settled_load = Scalar(constants::settled_load);
  info.least_load = Scalar(constants::least_load * gravity * h);
  info.push_speed = Scalar(from.push_speed);
  info.row_push_speed = Scalar(std::min(from.push_speed, std::max(gravity, from.push_speed) * step));
  info.tree_push_speed = Scalar(std::min(from.push_speed, gravity * step));
  info.joint_push_speed = Scalar(constants::joint_push_speed);
  info.limit_give = Scalar(constants::largest_give / double(1u << octave));
  info.loop_give = Scalar(constants::loop_give);
  info.spin_floor = Scalar(constants::tree_spin_floor);
  info.rounds = constants::rounds;
  info.net_made = Scalar(constants::net_made);
  info.stale_share = Scalar(constants::stale_share);
  info.locked_interval = Scalar(constants::locked_interval);
  info.limit_stiffness = Scalar(rows.mass_scale / rows.impulse_scale);
  info.tree_damping = Scalar(constants::tree_damping);
  info.lock_stiffness = Scalar(constants::lock_stiffness);
  info.restitution_threshold = Scalar(from.restitution_threshold);
  info.struck_speed = Scalar(constants::struck_speed);
  info.rounding = Scalar(constants::roundings * std::numeric_limits<Scalar>::epsilon());

  info.carries = from.carries;
  info.substeps = Scalar(from.substeps << octave);
  info.step = Scalar(from.h * from.substeps);
  info.largest_state = Scalar(constants::largest_state);
  info.largest_momentum = Scalar(constants::largest_momentum);
  return info;
}

}  // namespace

double soft_substep_length(double before, double h, double dt) {
  return std::max(h, before / (1 + dt / constants::stiffening_time));
}

template <class Scalar> void fill_infos(const InfoInputs& from, InfoOf<Scalar> (&infos)[phase_count], unsigned octave) {
  const double h = from.h / double(1u << octave);
  InfoOf<Scalar>& biased = infos[unsigned(Phase::biased)];
  biased = biased_info<Scalar>(from, h, octave);

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
