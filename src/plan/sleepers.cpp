#include "plan/sleepers.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pcphys {
namespace {

/// What tells whether a body is slow, straight from the tables' rows.
template <class Scalar> class Slowness {
 public:
  Slowness(const WorldState& state, const AlignedBytes* before, double dt, const StepSettings& settings)
      : state_(state),
        motion_(state.tables.data<Scalar>(Buffer::motion)),
        parts_(state.tables.data<Scalar>(Buffer::velocity_parts)),
        pose_(state.tables.data<Scalar>(Buffer::pose)),
        before_(before ? reinterpret_cast<const Scalar*>(before->data()) : nullptr),
        inverse_(state.tables.data<Scalar>(Buffer::mass) + 4),
        speed_(settings.sleep_speed),
        spin_(settings.sleep_spin),
        dt_(dt) {}

  bool slow(std::uint32_t row) const {
    const Scalar* motion = motion_ + row * reals_of(Buffer::motion);
    const Vec3 u = at(motion), l = at(motion + 4);
    if (!state_.responds(row)) return u == Vec3{} && l == Vec3{};  // what carries others moves them however slow it is
    // as it is read: what hangs on springs is stored half a sub-step's fall away from rest
    const Scalar* parts = parts_ + row * reals_of(Buffer::velocity_parts);
    const Vec3 v = u + at(parts);
    return dot(v, v) <= speed_ * speed_ && (!before_ || went_little(row)) && spins_little(row, l + at(parts + 4));
  }

 private:
  static Vec3 at(const Scalar* v) { return {double(v[0]), double(v[1]), double(v[2])}; }
  static Quat turn(const Scalar* q) { return {double(q[0]), double(q[1]), double(q[2]), double(q[3])}; }
  /// The mean over the step: velocities are those of its last sub-step.
  bool went_little(std::uint32_t row) const {
    const Scalar *p = pose_ + row * reals_of(Buffer::pose), *q = before_ + row * reals_of(Buffer::pose);
    const Vec3 way = (at(p) - at(q)) + (at(p + 8) - at(q + 8));
    const Quat turned = turn(p + 4) * conjugate(turn(q + 4));  // twice its vector: the angle
    const double angle2 = 4 * (turned.x * turned.x + turned.y * turned.y + turned.z * turned.z);
    return dot(way, way) <= speed_ * speed_ * dt_ * dt_ && angle2 <= spin_ * spin_ * dt_ * dt_;
  }
  /// From above first, as if it turned about the axis of its least moment.
  bool spins_little(std::uint32_t row, Vec3 momentum) const {
    const Vec3 inverse = at(inverse_ + row * reals_of(Buffer::mass));
    const double most = std::max({inverse.x, inverse.y, inverse.z});
    if (most * most * dot(momentum, momentum) <= spin_ * spin_) return true;
    const Vec3 spin = state_.spin_of(row, momentum);
    return dot(spin, spin) <= spin_ * spin_;
  }

  const WorldState& state_;
  const Scalar *motion_, *parts_, *pose_, *before_, *inverse_;
  double speed_, spin_, dt_;
};

/// Counts the time of each body that moved; whether some have been quiet for `settings.sleep_time`.
template <class Scalar>
bool count_time(WorldState& state, std::span<const std::uint32_t> moved, const AlignedBytes* before, double dt,
                std::span<const char> restless, const StepSettings& settings) {
  const Slowness<Scalar> slowness(state, before, dt, settings);
  const Scalar enough = normal<Scalar>(settings.sleep_time);
  Scalar* rest = state.tables.data<Scalar>(Buffer::rest);
  bool some = false;
  for (const std::uint32_t row : moved) {
    if (state.stands(row)) continue;  // it pads, or was frozen by this step
    Scalar& time = rest[row * rest_fields + rest_quiet_time];
    const bool slow =
        rest[row * rest_fields + rest_can_sleep] > 0 && (restless.empty() || !restless[row]) && slowness.slow(row);
    time = slow ? std::min(Scalar(double(time) + dt), enough) : Scalar(0);
    some |= time >= enough;
  }
  return some;
}

/// It comes to rest where it is, and wakes as it slept: its contacts keep their impulses.
void stop(WorldState& s, std::uint32_t row) {
  for (const std::uint32_t offset : {0u, 4u}) s.tables.set3(Buffer::motion, row, offset, {});
  for (const std::uint32_t offset : {0u, 4u, 8u, 12u}) s.tables.set3(Buffer::velocity_parts, row, offset, {});
  s.tables.set(Buffer::velocity_parts, row, place::settling, 0);
}

}  // namespace

void Sleepers::build(const WorldState& state) {
  islands_.forget();
  if (labels_.empty()) islands_.build(state);
  awake_.assign(state.bodies.size(), false);
}

std::uint32_t Sleepers::wake_stirred(WorldState& state) {
  if (state.sleepers == 0) return 0;
  build(state);
  const auto stirred = [&](std::uint32_t row) { return state.tables.get(Buffer::rest, row, rest_stirred) > 0; };
  for (std::uint32_t row = 1; row < state.bodies.size(); row++)
    if (state.goes(row) || (state.asleep(row) && stirred(row))) awake_[root(row)] = true;
  const auto wake_other = [&](std::uint32_t a, std::uint32_t b) {
    if (stirred(a) || stirred(b)) awake_[root(state.stands(a) ? b : a)] = true;
  };
  if (state.stirred > 0) {
    for (const auto& [a, b] : state.contacts.ends) wake_other(a, b);
    for (std::uint32_t row = 1; row < state.joints.size(); row++)
      wake_other(state.body_ids.row(state.joints[row].body_a), state.body_ids.row(state.joints[row].body_b));
  }
  return wake_marked(state);
}

std::uint32_t Sleepers::wake_all(WorldState& state) {
  build(state);
  std::ranges::fill(awake_, true);
  return wake_marked(state);
}

std::uint32_t Sleepers::wake_touched(WorldState& state, std::span<const std::uint32_t> touched) {
  if (touched.empty()) return 0;
  build(state);
  for (const std::uint32_t row : touched) awake_[root(row)] = true;
  return wake_marked(state);
}

std::uint32_t Sleepers::wake_marked(WorldState& state) {
  std::uint32_t woke = 0;
  for (std::uint32_t row = 1; row < state.bodies.size(); row++) {
    if (!state.asleep(row) || !awake_[root(row)]) continue;
    for (const RestField field : {rest_quiet_time, rest_asleep, rest_stirred})
      state.tables.set(Buffer::rest, row, field, 0);
    woke++;
  }
  if (woke > 0) state.count_rest();
  return woke;
}

void Sleepers::follow(WorldState& state, std::span<const std::uint32_t> moved, const AlignedBytes* before, double dt,
                      const StepSettings& settings, std::span<const std::uint32_t> labels, StepReport& report) {
  labels_ = labels;
  const bool single = state.tables.precision() == Precision::f32;
  // as in the table
  const double wanted = settings.sleep_time,
               sleep_time = single ? double(normal<float>(wanted)) : normal<double>(wanted);
  const bool some = single ? count_time<float>(state, moved, before, dt, restless_, settings)
                           : count_time<double>(state, moved, before, dt, restless_, settings);
  if (!moved.empty()) {
    state.tables.touch(Buffer::rest);
    state.rests = true;
  }
  if (some) report.fell_asleep = choose(state, moved, sleep_time);
  if (state.stirred > 0) state.calm();
  report.asleep = state.sleepers;
  report.islands_asleep = count_islands(state);
  labels_ = {};
  disturb({}, false);
}

std::uint32_t Sleepers::choose(WorldState& state, std::span<const std::uint32_t> moved, double sleep_time) {
  build(state);
  for (const std::uint32_t row : moved)
    if (!state.stands(row) && state.tables.get(Buffer::rest, row, rest_quiet_time) < sleep_time)
      awake_[root(row)] = true;
  mark_kept_awake(state);
  if (together_ && std::ranges::find(awake_, true) != awake_.end()) return 0;
  return lay_down(state, moved);
}

/// What a motor turns or a callback pushes does not rest, however slow it is.
void Sleepers::mark_kept_awake(const WorldState& state) {
  for (std::uint32_t row = 1; row < state.joints.size(); row++) {
    const JointRecord& joint = state.joints[row];
    if (joint.def.motor.torque <= 0 || joint.def.motor.speed == 0) continue;
    for (const std::uint32_t body : {joint.body_a, joint.body_b}) awake_[root(state.body_ids.row(body))] = true;
  }
  for (std::uint32_t i = 0; state.callbacks > 0 && i < state.forces.size(); i++)
    if (state.forces[i].callback) awake_[root(state.body_ids.row(state.forces[i].body))] = true;
}

std::uint32_t Sleepers::lay_down(WorldState& state, std::span<const std::uint32_t> moved) {
  std::uint32_t fell = 0;
  for (const std::uint32_t row : moved) {
    if (state.stands(row) || awake_[root(row)]) continue;
    stop(state, row);
    state.tables.set(Buffer::rest, row, rest_asleep, 1);
    fell++;
  }
  if (fell > 0) state.count_rest();
  return fell;
}

std::uint32_t Sleepers::count_islands(const WorldState& state) {
  if (serial_ == state.serial && counted_ == state.rest_version) return count_;
  serial_ = state.serial;
  counted_ = state.rest_version;
  count_ = 0;
  if (state.sleepers == 0) return 0;
  build(state);
  for (std::uint32_t row = 1; row < state.bodies.size(); row++)
    count_ += state.asleep(row) && root(row) == row;  // a root is the lowest row of its island
  return count_;
}

}  // namespace pcphys
