// What cases measure with: reference tables, rotations as vectors, and sums over bodies and joints as any engine
// shows them.
#pragma once
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/builder.h"
#include "simulated.h"

namespace pcphys::cases {

inline constexpr double gravity = 9.81;  // [m/s^2]
inline constexpr double infinite = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline const Vec3 down{0, 0, -gravity};  // z is up in all cases

/// A table of cases/reference: named columns of numbers, '#' starts a comment line.
struct Csv {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;

  /// NaN where there is no such column.
  double at(std::size_t row, std::string_view column) const;
  /// The columns NAMEx, NAMEy, NAMEz.
  Vec3 vector(std::size_t row, const std::string& name) const;
  /// The columns NAMEw, NAMEx, NAMEy, NAMEz.
  Quat quaternion(std::size_t row, const std::string& name) const;
};
/// Without rows when there is no such file.
Csv read_csv(std::string_view file);

/// Steps through the rows of a reference whose times (first column) are multiples of dt, and tells of each.
template <class Tell> void walk(Simulated& run, double dt, const Csv& reference, double seconds, Tell&& tell) {
  long done = 0;
  for (std::size_t row = 1; row < reference.rows.size(); ++row) {
    const double t = reference.rows[row][0];
    const long k = std::lround(t / dt);
    if (t > seconds + 1e-9 || std::fabs(double(k) * dt - t) > 1e-9) continue;
    run.step(dt, k - done);
    done = k;
    tell(row, t);
  }
}

/// Three poses of a body, dt apart: motion from poses alone, the same for engines that store velocities in different
/// phases.
struct Neighbours {
  Pose before, now, after;
  double dt = 0;

  Vec3 velocity() const { return (0.5 / dt) * (after.position - before.position); }
  Vec3 acceleration() const {
    return (1 / (dt * dt)) * ((after.position - now.position) - (now.position - before.position));
  }
  Vec3 angular_velocity() const;
  /// Kinetic, and potential in `gravity`, of a body of this mass [J].
  double energy(const MassProperties& mass, Vec3 gravity) const;
};

/// As `walk`; `tell(row, t)` sees the run at each time and gives what takes the neighbours of body 0 there.
template <class Tell>
void walk_with_neighbours(Simulated& run, double dt, const Csv& reference, double seconds, Tell&& tell) {
  long done = 0;
  for (std::size_t row = 1; row < reference.rows.size(); ++row) {
    const double t = reference.rows[row][0];
    const long k = std::lround(t / dt);
    if (t > seconds + 1e-9 || std::fabs(double(k) * dt - t) > 1e-9 || k <= done) continue;
    run.step(dt, k - 1 - done);
    Neighbours n;
    n.dt = dt;
    n.before = run.pose(0);
    run.step(dt);
    n.now = run.pose(0);
    const auto rest = tell(row, t);
    run.step(dt);
    n.after = run.pose(0);
    done = k + 1;
    rest(n);
  }
}

/// Keeps NaN: once an error is not a number, its maximum is none either.
class Worst {
 public:
  void add(double error) { value_ = error > value_ || std::isnan(error) ? error : value_; }
  operator double() const { return value_; }

 private:
  double value_ = 0;
};

/// What should oscillate about one value: how far its mean over the last tenth of a run lies from that over the first.
class Trend {
 public:
  explicit Trend(long steps) : steps_(steps), tenth_(steps / 10) {}
  void add(double value) {
    if (done_ < tenth_) first_ += value / double(tenth_);
    if (done_ >= steps_ - tenth_) last_ += value / double(tenth_);
    ++done_;
  }
  operator double() const { return std::fabs(last_ - first_); }

 private:
  long steps_, tenth_, done_ = 0;
  double first_ = 0, last_ = 0;
};

/// Largest error of a component relative to itself; of one that is zero, but for the table's rounding,
/// relative to `scale`.
double error_of_components(Vec3 found, Vec3 expected, double scale);

/// exp of a rotation vector [rad].
Quat exponential(Vec3 rotation);
/// The angle that turns a into b, in [0, pi] [rad].
double angle_between(Quat a, Quat b);

/// I w of one body, world axes [kg m^2/s].
Vec3 spin_momentum(const Simulated& run, int body);
/// Kinetic, and potential in the world's gravity; zero at the origin [J].
double kinetic_energy(const Simulated& run);
double energy(const Simulated& run);
Vec3 momentum(const Simulated& run);
/// About the world's origin.
Vec3 angular_momentum(const Simulated& run);
/// The largest distance between the two pins of a joint [m].
double joint_gap(const Simulated& run);

/// Displacement after t from velocity v0, under constant acceleration a and linear drag.
Vec3 thrown(Vec3 v0, Vec3 a, double drag, double t);
/// Pins body b, at a place of its own, to body a at a place of its.
void pin(scenes::Builder& builder, BodyId a, Vec3 at_a, int b, Vec3 at_b);
/// A rod of 1 m, 0.1 m wide, and 1 kg, that hangs from the origin: its axis, body z, leans by `angle` from straight
/// down towards x.
BodyDef hanging_rod(double angle);
/// The period of that rod's small swings is 2 pi over this [rad/s].
double rod_frequency();

/// A fixed half space below z = 0, turned by `orientation` about the origin.
BodyDef floor_plane(Quat orientation = {});
/// A body that touches nothing.
BodyDef free_body(double mass, Vec3 moments, Vec3 velocity = {});
/// Does not collide.
BodyDef without_contacts(BodyDef def);

}  // namespace pcphys::cases
