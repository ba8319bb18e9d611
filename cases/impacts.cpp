// A16, A18: impacts of free bodies, without gravity.
#include <numbers>
#include <string>

#include "parts.h"

namespace pcphys::cases {
namespace {

// ---- A16 -----------------------------------------------------------------------------------------------

constexpr double radius1 = 0.1, radius2 = 0.2;
const Vec3 approach{2, 0, 0};

/// One row of the table: what flies at what, and what it becomes.
struct Collision {
  double mass2, e, friction;
  Vec3 normal;  // from 1 to 2
  Vec3 w1, w2, v1_after, v2_after, w1_after, w2_after;
};

std::vector<Collision> collisions(double mass2) {
  const Csv csv = read_csv("A16_sphere_collisions.csv");
  std::vector<Collision> rows;
  for (std::size_t i = 0; i < csv.rows.size(); ++i) {
    if (csv.at(i, "m2") != mass2) continue;
    const double beta = csv.at(i, "beta_deg") * std::numbers::pi / 180;
    Collision c{mass2,
                csv.at(i, "e"),
                csv.at(i, "mu"),
                {std::cos(beta), -std::sin(beta), 0},
                {},
                {},
                csv.vector(i, "v1"),
                csv.vector(i, "v2"),
                csv.vector(i, "w1"),
                csv.vector(i, "w2")};
    if (csv.at(i, "spin") != 0) c.w1 = {0, 0, 20}, c.w2 = {0, 15, 0};
    rows.push_back(c);
  }
  return rows;
}

/// `gap` is what is left to fly, along the velocity.
Simulated& start(Trial& trial, const Collision& c, double gap) {
  return trial.start([&](scenes::Builder& builder) {
    builder.set_material({c.friction, c.friction, c.e});
    const Vec3 touching = -(radius1 + radius2) * c.normal;
    builder.add(ball(1, radius1, touching - (gap / length(approach)) * approach, approach, c.w1));
    builder.add(ball(c.mass2, radius2, {}, {}, c.w2));
  });
}

/// Largest error of a component, relative to the largest speed (or spin, or speed over radius) of the row.
double linear_scale(const Collision& c) { return std::max({length(approach), length(c.v1_after), length(c.v2_after)}); }
double spin_scale(const Collision& c) {
  return std::max({linear_scale(c) / radius2, length(c.w1), length(c.w2), length(c.w1_after), length(c.w2_after)});
}
double error_of(const Collision& c, Vec3 v1, Vec3 v2, Vec3 w1, Vec3 w2) {
  const double linear = linear_scale(c), spin = spin_scale(c);
  return std::max({length(v1 - c.v1_after) / linear, length(v2 - c.v2_after) / linear, length(w1 - c.w1_after) / spin,
                   length(w2 - c.w2_after) / spin});
}
double error_of(const Simulated& run, const Collision& c) {
  return error_of(c, run.velocity(0), run.velocity(1), run.angular_velocity(0), run.angular_velocity(1));
}

/// From 0.05 m apart, to a few steps after the impact; momenta at every step.
void collide(Trial& trial, const std::vector<Collision>& all) {
  Worst velocity, bouncing, linear, angular, gained;
  for (const Collision& c : all) {
    const double gap = 0.05 / c.normal.x;
    Simulated& run = start(trial, c, gap);
    const Vec3 p0 = momentum(run), l0 = angular_momentum(run);
    const double e0 = kinetic_energy(run), spin_scale = length(l0) + length(p0) * (radius1 + radius2);
    for (long k = 0, steps = long(std::ceil(gap / length(approach) / trial.dt())) + 3; k < steps; ++k) {
      run.step(trial.dt());
      linear.add(length(momentum(run) - p0) / length(p0));
      angular.add(length(angular_momentum(run) - l0) / spin_scale);
      gained.add(kinetic_energy(run) / e0 - 1);
    }
    const double error = error_of(run, c);
    velocity.add(error);
    if (c.e > 0) bouncing.add(error);
  }
  trial.report("velocity and spin, relative", velocity, 2 * trial.dt() / (radius1 + radius2));
  trial.report("velocity and spin where e > 0, relative", bouncing, 2 * trial.dt() / (radius1 + radius2));
  trial.report("momentum, relative", linear, trial.either(1e-12, 1e-6));
  trial.report("angular momentum, relative", angular, trial.either(1e-12, 1e-6));
  trial.report("energy gained, relative", gained, trial.either(1e-9, 1e-6));
}

/// Straight through the solver.
void resolve(Trial& trial, const std::vector<Collision>& all) {
  Worst velocity, component;
  bool alike = true;
  for (const Collision& c : all) {
    alike = alike && c.mass2 == 1;
    SphereContact contact;
    contact.mass2 = c.mass2;
    contact.normal = c.normal;
    contact.v1 = approach;
    contact.w1 = c.w1;
    contact.w2 = c.w2;
    contact.friction = c.friction;
    contact.restitution = c.e;
    trial.resolve(contact);
    velocity.add(error_of(c, contact.v1, contact.v2, contact.w1, contact.w2));
    const double linear = linear_scale(c), spin = spin_scale(c);
    component.add(error_of_components(contact.v1, c.v1_after, linear));
    component.add(error_of_components(contact.v2, c.v2_after, linear));
    component.add(error_of_components(contact.w1, c.w1_after, spin));
    component.add(error_of_components(contact.w2, c.w2_after, spin));
  }
  trial.report("velocity and spin, relative", velocity, trial.either(1e-12, 2e-6));
  // what unlike masses leave of a speed is less than that, and rounded as that is
  trial.report("each component, relative", component, alike ? std::optional(trial.either(1e-12, 2e-6)) : std::nullopt);
}

/// All but touching, through one step so short that nothing moves. What the digits of the positions leave of the gap
/// bounds the error from below.
void touch(Trial& trial, const std::vector<Collision>& all) {
  Worst velocity;
  for (const Collision& c : all) {
    Simulated& run = start(trial, c, 1e-15);
    run.step(trial.dt());
    velocity.add(error_of(run, c));
  }
  trial.report("velocity and spin, relative", velocity, 2e-6);
}

// ---- A18 -----------------------------------------------------------------------------------------------

/// Balls of these masses on a line, the first at 1 m/s; elastic, without friction.
Simulated& line_of_balls(Trial& trial, const std::vector<double>& masses, double gap) {
  return trial.start([&](scenes::Builder& builder) {
    builder.set_material(0, 1);
    for (std::size_t i = 0; i < masses.size(); ++i)
      builder.add(ball(masses[i], 0.1, {(0.2 + gap) * double(i), 0, 0}, {i == 0 ? 1.0 : 0.0, 0, 0}));
  });
}

void cradle(Trial& trial, double gap) {
  Simulated& run = line_of_balls(trial, {1, 1, 1, 1, 1}, gap);
  const Vec3 p0 = momentum(run);
  const double e0 = kinetic_energy(run);
  run.step(trial.dt(), trial.steps(0.2));
  Worst worst;
  for (int i = 0; i < 5; ++i) worst.add(length(run.velocity(i) - Vec3{i == 4 ? 1.0 : 0.0, 0, 0}));
  const bool apart = gap > 0;
  trial.report("velocity [m/s]", worst, apart && trial.is_double() ? trial.at({1e-9, 1e-9, 1e-9, 1e-9}) : std::nullopt,
               apart ? std::nullopt : std::optional(0.01));
  trial.report("momentum, relative", length(momentum(run) - p0), trial.either(1e-12, 1e-6));
  trial.report("energy, relative", std::fabs(kinetic_energy(run) / e0 - 1), 1e-6);
}

void mass_chain(Trial& trial) {
  Simulated& run = line_of_balls(trial, {1, 2, 4}, 1e-3);
  run.step(trial.dt(), trial.steps(0.2));
  trial.report("velocity of the last [m/s]", std::fabs(run.velocity(2).x - 4.0 / 9),
               trial.is_double() ? trial.at({1e-9, 1e-9, 1e-9, 1e-9}) : std::nullopt);
}

struct Strike {
  double offset, e, ball, rod, spin;  // and the velocities after it
};

/// A ball of 0.5 kg at 2 m/s strikes a free rod of 1 kg beside its centre.
void strike(Trial& trial, const Strike& s) {
  Simulated& run = trial.start([&](scenes::Builder& builder) {
    builder.set_material(0, s.e);
    BodyDef rod;
    rod.shapes = {ShapeDef::box({0.5, 0.02, 0.02})};
    rod.mass = 1;
    builder.add(rod);
    builder.add(ball(0.5, 0.1, {s.offset, -0.12 - 0.05, 0}, {0, 2, 0}));
  });
  run.step(trial.dt(), long(std::ceil(0.025 / trial.dt())) + 3);
  Worst worst;
  worst.add(length(run.velocity(1) - Vec3{0, s.ball, 0}) / 2);
  worst.add(length(run.velocity(0) - Vec3{0, s.rod, 0}) / 2);
  worst.add(length(run.angular_velocity(0) - Vec3{0, 0, s.spin}) / s.spin);
  trial.report("velocity and spin, relative", worst, trial.at({infinite, infinite, 1e-3, 1e-3}, 4));
}

/// The same strikes straight through the solver, against their formula: J = (1 + e) v / (1 / m + 1 / M + d^2 / I).
void strike_directly(Trial& trial) {
  constexpr double ball_mass = 0.5, rod_mass = 1, speed = 2;
  const Vec3 half{0.5, 0.02, 0.02};
  const double inertia = rod_mass / 3 * (half.x * half.x + half.y * half.y);
  Worst velocity, still;
  for (const auto& [offset, e] : {std::pair{0.25, 0.0}, {0.25, 1.0}, {0.5, 1.0}}) {
    const double impulse = (1 + e) * speed / (1 / ball_mass + 1 / rod_mass + offset * offset / inertia);
    const Vec3 ball_after{0, speed - impulse / ball_mass, 0}, rod_after{0, impulse / rod_mass, 0},
        spin_after{0, 0, offset * impulse / inertia};
    SphereContact contact;
    contact.mass1 = ball_mass;
    contact.mass2 = rod_mass;
    contact.normal = {0, 1, 0};
    contact.v1 = {0, speed, 0};
    contact.half2 = half;
    contact.at2 = {offset, -half.y, 0};
    contact.restitution = e;
    trial.resolve(contact);
    velocity.add(length(contact.v1 - ball_after) / length(ball_after));
    velocity.add(length(contact.v2 - rod_after) / length(rod_after));
    velocity.add(length(contact.w2 - spin_after) / length(spin_after));
    velocity.add(length(contact.w1));
    // about this point, on the other side of the centre, the rod begins to turn
    const Vec3 percussion{-inertia / (rod_mass * offset), 0, 0};
    still.add(length(contact.v2 + cross(contact.w2, percussion)) / length(rod_after));
  }
  trial.report("velocity and spin, relative", velocity, trial.either(1e-12, 2e-6));
  trial.report("speed of the centre of percussion, relative", still, trial.either(1e-12, 2e-6));
}

}  // namespace

void add_impacts(std::vector<Case>& cases) {
  Case& spheres = cases.emplace_back(Case{"A16", "oblique collisions of two spheres", {}});
  for (const auto& [name, mass] :
       {std::pair{"m2 = 1 kg", 1.0}, {"m2 = 10 kg", 10.0}, {"m2 = 1e3 kg", 1e3}, {"m2 = 1e6 kg", 1e6}}) {
    const std::vector<Collision> rows = collisions(mass);
    spheres.variants.push_back(
        {.name = std::string(name) + ", direct", .run = [rows](Trial& t) { resolve(t, rows); }, .direct = true});
    spheres.variants.push_back(
        {.name = name, .run = [rows](Trial& t) { collide(t, rows); }, .coarse = true, .lost_at = 1});
    spheres.variants.push_back({.name = std::string(name) + ", touching",
                                .run = [rows](Trial& t) { touch(t, rows); },
                                .steps = {1e-8},
                                .single = false,
                                .lost_at = 1});
  }
  Case& chains = cases.emplace_back(Case{"A18", "Newton's cradle, a mass chain, a struck rod", {}});
  chains.variants = {{.name = "cradle, gaps", .run = [](Trial& t) { cradle(t, 1e-3); }, .coarse = true, .lost_at = 1},
                     {.name = "cradle, touching", .run = [](Trial& t) { cradle(t, 0); }, .coarse = true, .lost_at = 1},
                     {.name = "masses 1, 2, 4", .run = mass_chain, .coarse = true, .lost_at = 1}};
  for (const auto& [name, s] :
       {std::pair{"rod, d = .25, e = 0", Strike{0.25, 0, 2 - 2 * 0.533503781826, 0.533503781826, 1.597954618}},
        {"rod, d = .25, e = 1", Strike{0.25, 1, -0.134015127, 1.067007563652, 3.195909236}},
        {"rod, d = .5, e = 1", Strike{0.5, 1, 0.665600853, 0.667199573674, 3.996802558}}})
    chains.variants.push_back({.name = name, .run = [s = s](Trial& t) { strike(t, s); }, .coarse = true, .lost_at = 1});
  chains.variants.push_back({.name = "rod, direct", .run = strike_directly, .direct = true});
}

}  // namespace pcphys::cases
