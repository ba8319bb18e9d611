// What the tests against closed forms share: worlds in every precision and on every backend, conserved quantities,
// and one contact handed straight to the solver. Tables and rotations are those of cases/measures.h.
#pragma once
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "cases/measures.h"
#include "pcphys/pcphys.h"

namespace physics {
using namespace pcphys;

using cases::angle_between, cases::Csv, cases::exponential, cases::free_body, cases::read_csv;
using cases::gravity, cases::infinite, cases::not_a_number;

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
