// What cases measure with: reference tables, rotations as vectors, and sums over bodies and joints as any engine
// shows them.
#pragma once
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "simulated.h"

namespace pcphys::cases {

inline constexpr double gravity = 9.81;  // [m/s^2]
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

/// Keeps NaN: once an error is not a number, its maximum is none either.
class Worst {
 public:
  void add(double error) { value_ = error > value_ || std::isnan(error) ? error : value_; }
  operator double() const { return value_; }

 private:
  double value_ = 0;
};

/// exp of a rotation vector [rad].
Quat exponential(Vec3 rotation);
/// The angle that turns a into b, in [0, pi] [rad].
double angle_between(Quat a, Quat b);

/// Kinetic, and potential in the world's gravity; zero at the origin [J].
double kinetic_energy(const Simulated& run);
double energy(const Simulated& run);
Vec3 momentum(const Simulated& run);
/// About the world's origin.
Vec3 angular_momentum(const Simulated& run);
/// The largest distance between the two pins of a joint [m].
double joint_gap(const Simulated& run);

/// A body that touches nothing.
BodyDef free_body(double mass, Vec3 moments, Vec3 velocity = {});
/// Does not collide.
BodyDef without_contacts(BodyDef def);

}  // namespace pcphys::cases
