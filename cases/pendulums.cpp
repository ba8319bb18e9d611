// A6 to A8: what turns about pins, solved directly. Bounds are twice the errors of converged second-order methods.
#include <numbers>

#include "case.h"
#include "measures.h"

namespace pcphys::cases {
namespace {

using std::numbers::pi;

// ---- A6 ------------------------------------------------------------------------------------------------

constexpr double top_mass = 2, top_radius = 0.2, top_height = 0.04;
constexpr double across = top_mass * (top_radius * top_radius / 4 + top_height * top_height / 12);
constexpr double along = top_mass * top_radius * top_radius / 2;

/// Pinned 0.2 m below its centre of mass at the origin.
Simulated& pinned_top(Trial& trial, Quat orientation, Vec3 spin) {
  return trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    const Vec3 centre = rotate(orientation, {0, 0, 0.2});
    BodyDef def = free_body(top_mass, {across, across, along}, cross(spin, centre));
    def.pose = {centre, orientation};
    def.angular_velocity = spin;
    pin(builder, builder.world().ground(), {}, builder.add(def), {0, 0, -0.2});
  });
}

struct TopBounds {
  Bounds theta, phi;
};

void heavy_top(Trial& trial, const Csv& reference, const TopBounds& must) {
  Simulated& run = pinned_top(trial, reference.quaternion(0, "q"), reference.vector(0, "w"));
  const auto axial_spin = [&] { return rotate(conjugate(run.pose(0).orientation), run.angular_velocity(0)).z; };
  const double l0 = angular_momentum(run).z, w0 = axial_spin();
  Worst theta, phi, spin, momentum;
  walk(run, trial.dt(), reference, 5, [&](std::size_t row, double) {
    const Vec3 axis = rotate(run.pose(0).orientation, {0, 0, 1});
    theta.add(std::fabs(std::acos(axis.z) - reference.at(row, "theta")));
    phi.add(std::fabs(std::remainder(std::atan2(axis.y, axis.x) - reference.at(row, "phi"), 2 * pi)));
    spin.add(std::fabs(axial_spin() / w0 - 1));
    momentum.add(std::fabs(angular_momentum(run).z / l0 - 1));
  });
  const auto twice_only = [&](double bound) { return trial.is_double() ? std::optional(bound) : std::nullopt; };
  trial.report("inclination [rad]", theta, trial.at(must.theta));
  trial.report("azimuth [rad]", phi, trial.at(must.phi));
  trial.report("spin about the axis / w3", spin, twice_only(1e-9));
  trial.report("Lz / Lz0", momentum, twice_only(1e-9));
}

/// Upright: above the critical spin it stays so, below it must fall.
void sleeping_top(Trial& trial, double spin, double lean, double seconds, bool falls) {
  const Quat leaning = axis_angle({0, 1, 0}, lean);
  Simulated& run = pinned_top(trial, leaning, spin * rotate(leaning, {0, 0, 1}));
  Worst theta;
  for (long k = 0, steps = trial.steps(seconds); k < steps; ++k) {
    run.step(trial.dt());
    const Vec3 axis = rotate(run.pose(0).orientation, {0, 0, 1});
    theta.add(std::atan2(std::hypot(axis.x, axis.y), axis.z));
  }
  if (falls)
    trial.report("short of a lean of 0.5 rad [rad]", std::max(0.0, 0.5 - theta), 0);
  else
    trial.report("largest lean [rad]", theta, trial.is_double() ? std::optional(1e-9) : std::nullopt);
}

// ---- A7 ------------------------------------------------------------------------------------------------

struct Amplitude {
  const char *name, *file;
  double degrees;
  Bounds shake;
};
const Amplitude amplitudes[] = {{"10 deg", "A07_pendulum_10.csv", 10, {5.5e-4, 3.5e-5, 1.4e-6, 2.0e-8}},
                                {"90 deg", "A07_pendulum_90.csv", 90, {1.2e-2, 7.3e-4, 2.9e-5, 4.2e-7}},
                                {"170 deg", "A07_pendulum_170.csv", 170, {1.2e-2, 7.7e-4, 3.1e-5, 4.6e-7}}};

Bounds twice(const Bounds& b) { return {2 * b[0], 2 * b[1], 2 * b[2], 2 * b[3]}; }

Simulated& pendulum(Trial& trial, double angle) {
  return trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    pin(builder, builder.world().ground(), {}, builder.add(hanging_rod(angle)), {0, 0, 0.5});
  });
}

void swing(Trial& trial, const Amplitude& amplitude, const Csv& reference) {
  Simulated& run = pendulum(trial, amplitude.degrees * pi / 180);
  const double e0 = energy(run);
  Worst position, gap, gained, read, force, largest_force;
  walk_with_neighbours(run, trial.dt(), reference, 10, [&](std::size_t row, double) {
    position.add(length(run.pose(0).position - Vec3{reference.at(row, "px"), 0, reference.at(row, "pz")}));
    gap.add(joint_gap(run));
    read.add(std::fabs(energy(run) - e0) / gravity);  // 2 m g l of the rod
    return [&, row](const Neighbours& n) {
      const double angle = reference.at(row, "theta");
      const Vec3 outward{std::sin(angle), 0, -std::cos(angle)}, transverse{std::cos(angle), 0, std::sin(angle)};
      const Vec3 expected = reference.at(row, "Ft") * transverse - reference.at(row, "Fr") * outward;
      force.add(length(n.acceleration() - down - expected));
      largest_force.add(length(expected));
      gained.add(std::fabs(n.energy(run.mass(0), down) - e0) / gravity);
    };
  });
  trial.report("position [m]", position, trial.at(twice(amplitude.shake)), trial.at(amplitude.shake, 0));
  trial.report("joint gap [m]", gap, trial.either(1e-12, 2e-6));
  // of velocities in phase with the position: by central differences the exact motion has 1.7e-3 at 1/60 s, which is
  // more than the bound
  const bool level = amplitude.degrees == 90 && trial.substeps() == 1;
  trial.report("energy / (2 m g l)", read, level ? trial.at({1.36e-3, 8.4e-5, 3.4e-6, 4.8e-8}) : std::nullopt);
  trial.report("energy by central differences / (2 m g l)", gained);
  trial.report("pivot force / the largest", force / largest_force, trial.at({infinite, infinite, 1e-2, 1e-2}, 0));
}

/// No trend of the energy over 1000 s.
void long_swing(Trial& trial) {
  Simulated& run = pendulum(trial, 0.5 * pi);
  const double e0 = energy(run);
  const long steps = trial.steps(1000);
  Worst worst;
  Trend trend(steps);
  for (long k = 0; k < steps; ++k) {
    run.step(trial.dt());
    const double error = (energy(run) - e0) / gravity;
    worst.add(std::fabs(error));
    trend.add(error);
  }
  trial.report("energy / (2 m g l)", worst, trial.at({1.36e-3, 8.4e-5, infinite, infinite}));
  const double oscillation = std::max<double>(worst, 1e-9);  // what is kept to less is rounding
  trial.report("trend of the energy / its oscillation", trend / oscillation,
               trial.is_double() ? std::optional(0.1) : std::nullopt);
}

// ---- A8 ------------------------------------------------------------------------------------------------

void double_pendulum(Trial& trial) {
  static const Csv reference = read_csv("A08_double_pendulum.csv");
  Simulated& run = trial.start([](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    BodyDef rod = hanging_rod(0.5 * pi);
    const int first = builder.add(rod);
    rod.pose.position = {1.5, 0, 0};
    const int second = builder.add(rod);
    pin(builder, builder.world().ground(), {}, first, {0, 0, 0.5});
    pin(builder, builder.id(first), {0, 0, -0.5}, second, {0, 0, 0.5});
  });
  Worst early, all, gap;
  walk(run, trial.dt(), reference, 4, [&](std::size_t row, double t) {
    for (int i = 0; i < 2; ++i) {
      const char* const x[] = {"x1", "x2"};
      const char* const z[] = {"z1", "z2"};
      const double error = length(run.pose(i).position - Vec3{reference.at(row, x[i]), 0, reference.at(row, z[i])});
      if (t <= 2 + 1e-9) early.add(error);
      all.add(error);
    }
    gap.add(joint_gap(run));
  });
  const bool second = trial.order() == 2;
  const std::size_t singles = second ? 2 : 1;
  trial.report(
      "position until 2 s [m]", early,
      trial.at(second ? Bounds{1.5e-2, 9.1e-4, 3.6e-5, 5.2e-7} : Bounds{2.2e-5, 1.3e-7, 2.3e-10, 1e-11}, singles));
  trial.report("position until 4 s [m]", all,
               trial.at(second ? Bounds{1e-1, 6e-3, 2.4e-4, 3.5e-6} : Bounds{4.4e-4, 6.2e-7, 1e-9, 1e-11}, singles));
  trial.report("joint gap [m]", gap);
}

}  // namespace

void add_pendulums(std::vector<Case>& cases) {
  const TopBounds steady{{infinite, 2e-5, 6e-7, infinite}, {infinite, 1.4e-3, 5.4e-5, infinite}};
  const TopBounds cuspidal{{infinite, 4e-3, 1.6e-4, 2.4e-6}, {infinite, 8e-4, 2.2e-5, 3e-7}};
  const auto top = [](const char* file, const TopBounds& must) {
    return [reference = read_csv(file), must](Trial& t) { heavy_top(t, reference, must); };
  };
  cases.push_back(
      {"A6",
       "heavy symmetric top",
       {{.name = "a, steady",
         .run = top("A06a_heavy_top_steady.csv", steady),
         .coarse = true,
         .second_order = "azimuth [rad]",
         .lost_at = 1},
        {.name = "b, cusps",
         .run = top("A06b_heavy_top_cuspidal.csv", cuspidal),
         .coarse = true,
         .second_order = "azimuth [rad]",
         .lost_at = 1},
        {.name = "sleeping", .run = [](Trial& t) { sleeping_top(t, 60, 0, 60, false); }, .coarse = true, .lost_at = 1},
        {.name = "below critical", .run = [](Trial& t) { sleeping_top(t, 25, 1e-3, 10, true); }, .coarse = true}}});

  Case& compound = cases.emplace_back(Case{"A7", "compound pendulum", {}});
  for (const Amplitude& a : amplitudes)
    compound.variants.push_back({.name = a.name,
                                 .run = [a, reference = read_csv(a.file)](Trial& t) { swing(t, a, reference); },
                                 .coarse = true,
                                 .substeps = {1, 4},
                                 .second_order = "position [m]",
                                 .lost_at = 0.5});
  compound.variants.push_back(
      {.name = "90 deg, 1000 s", .run = long_swing, .steps = {ladder[0], ladder[1]}, .coarse = true, .single = false});
  cases.push_back({"A8",
                   "double compound pendulum",
                   {{.name = "from level",
                     .run = double_pendulum,
                     .coarse = true,
                     .substeps = {1, 4},
                     .second_order = "position until 2 s [m]",
                     .lost_at = 0.5},
                    {.name = "from level, order 4",
                     .run = double_pendulum,
                     .coarse = true,
                     .substeps = {1, 4},
                     .order = 4,
                     .second_order = "position until 2 s [m]",
                     .lost_at = 0.5},
                    // (there are no iterations to count: what the direct solve leaves is the gap)
                    {.name = "many sub-steps",
                     .run = double_pendulum,
                     .steps = {ladder[0], ladder[1]},
                     .substeps = {},
                     .more_substeps = {16, 64},
                     .own = true}}});
}

}  // namespace pcphys::cases
