// What the tests against closed forms share: worlds in every precision and on every backend, reference
// tables, rotations as vectors, conserved quantities, and one contact handed straight to the solver.
#pragma once
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "pcphys/pcphys.h"

namespace physics {
using namespace pcphys;

inline constexpr double gravity = 9.81;  // [m/s^2]
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinite = std::numeric_limits<double>::infinity();

/// Which arithmetic a run is made with, and where.
struct Mode {
  Precision precision = Precision::f64;
  Place place = Place::cpu;
  std::uint32_t lanes = 0;

  bool is_double() const { return precision == Precision::f64; }
  std::string name() const;
};

/// Single and double on the CPU, widest lanes.
std::vector<Mode> precisions();
/// Every lane width of the CPU, and GL.
std::vector<Mode> everywhere();

/// A world and its stepper. A step that is refused fails the test.
struct Run {
  World world;
  Stepper stepper;

  explicit Run(const Mode& mode, Vec3 gravity = {}, std::uint32_t substeps = 1);
  BodyId add(const BodyDef& def);
  void step(double dt, long count = 1);
  void set_substeps(std::uint32_t substeps);
  Vec3 position(BodyId body) const { return world.pose(body)->position; }
  Quat orientation(BodyId body) const { return world.pose(body)->orientation; }
};

/// A body that touches nothing.
BodyDef free_body(double mass, Vec3 moments, Vec3 velocity = {});

/// A table of cases/reference: named columns of numbers, '#' starts a comment line.
struct Csv {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;

  double at(std::size_t row, const char* column) const;
};
Csv read_csv(const char* file);

/// Steps through the rows of a reference whose times (first column) are multiples of dt, and tells of each.
template <class Tell> void walk(Run& run, double dt, const Csv& reference, double seconds, Tell&& tell) {
  long done = 0;
  for (std::size_t row = 1; row < reference.rows.size(); row++) {
    const double t = reference.rows[row][0];
    const long k = std::lround(t / dt);
    if (t > seconds + 1e-9 || std::fabs(double(k) * dt - t) > 1e-9) continue;
    run.step(dt, k - done);
    done = k;
    tell(row, t);
  }
}

/// exp of a rotation vector [rad].
Quat exponential(Vec3 rotation);
/// The angle that turns a into b, in [0, pi] [rad].
double angle_between(Quat a, Quat b);
/// Slope of log(error) over log(dt) between two runs.
double order(double coarse_error, double fine_error, double dt_ratio);

/// Momentum and angular momentum about the origin, with the sums of sizes they are judged by:
/// sum of m|v|, and sum of |r||m v| + |L|.
struct Momenta {
  Vec3 linear, angular;
  double linear_scale = 0, angular_scale = 0;
};
/// From velocities as they are read, in phase with positions.
Momenta momenta_in_phase(const World& world);
/// From what is stored: positions at the end of the sub-step, velocities over it. This is what impulses conserve.
Momenta momenta_stored(const World& world);

/// Two spheres that touch, and what the impulse stage makes of their velocities.
struct SphereContact {
  double mass1 = 1, mass2 = 1, radius1 = 0.1, radius2 = 0.2;
  Vec3 normal{1, 0, 0};  // unit, from 1 to 2
  Vec3 v1, v2, w1, w2;   // before and after
  double friction = 0, restitution = 0;
};
/// Runs the kernels of one step, as the plan orders them, on exactly this configuration: the narrow phase
/// cannot give it, since the digits of a gap end where those of the positions do.
void resolve(SphereContact& contact, const Mode& mode);

}  // namespace physics
