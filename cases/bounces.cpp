// A11, A17: a ball on a floor.
#include <cstdio>
#include <utility>

#include "case.h"
#include "measures.h"

namespace pcphys::cases {
namespace {

constexpr double radius = 0.1;

std::string text(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%g", value);
  return digits;
}

/// A solid ball of 1 kg above a floor at z = 0; no gravity unless it is set. Bodies: floor, ball.
Simulated& ball_over_floor(Trial& trial, const Material& material, double height, Vec3 gravity_, Vec3 velocity = {},
                           Vec3 spin = {}) {
  return trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(gravity_);
    builder.set_material(material);
    builder.add(floor_plane());
    BodyDef def;
    def.shapes = {ShapeDef::sphere(radius)};
    def.mass = 1;
    def.pose.position = {0, 0, height};
    def.velocity = velocity;
    def.angular_velocity = spin;
    builder.add(def);
  });
}

// ---- A11 -----------------------------------------------------------------------------------------------

/// Apexes and impacts of a ball from its clearances at equal times: in free flight a parabola through three is exact.
struct Flights {
  std::vector<double> apexes;   // of the n-th bounce's flight [m]
  std::vector<double> impacts;  // instants at which the parabola before an impact meets the floor [s]

  void add(double t, double dt, double clearance) {
    const double a = last_[0], b = last_[1], c = clearance, bend = a - 2 * b + c, slope = 0.5 * (c - a);
    if (++count_ > 2) {
      if (b > a && b >= c) apexes.push_back(bend < 0 ? b - 0.5 * slope * slope / bend : b);
      if (c > b && impacts.size() <= apexes.size() && foot_ > 0) impacts.push_back(std::exchange(foot_, 0));
      const bool free = std::fabs(bend / (dt * dt) + gravity) < 0.01 * gravity;
      const double fall = -(slope + bend) / dt;  // speed at c
      if (free && c < b) foot_ = t + (std::sqrt(fall * fall + 2 * gravity * c) - fall) / gravity;
    }
    last_[0] = b;
    last_[1] = c;
  }

 private:
  double last_[2] = {0, 0}, foot_ = 0;
  long count_ = 0;
};

struct Restitution {
  double e;
  int bounces;  // that are compared
};

void bouncing(Trial& trial, Restitution r) {
  static const Csv reference = read_csv("A11_bouncing_ball.csv");
  double seconds = 0, fifth = 0;
  std::vector<double> apexes;
  for (std::size_t row = 0; row < reference.rows.size(); ++row) {
    if (reference.at(row, "e") != r.e || reference.at(row, "n") > r.bounces) continue;
    seconds = reference.at(row, "t_apex");
    fifth = reference.at(row, "t_n");
    apexes.push_back(reference.at(row, "apex"));
  }
  Simulated& run = ball_over_floor(trial, {0, 0, r.e}, 1 + radius, down);
  Flights flights;
  flights.add(0, trial.dt(), 1);
  for (long k = 1, steps = trial.steps(1.1 * seconds + 0.1); k <= steps && flights.apexes.size() < apexes.size(); ++k) {
    run.step(trial.dt());
    flights.add(double(k) * trial.dt(), trial.dt(), run.pose(1).position.z - radius);
  }
  // one that never came is all of it off
  const auto apex = [&](std::size_t n) {
    return n <= flights.apexes.size() ? flights.apexes[n - 1] / apexes[n - 1] - 1 : -1;
  };
  trial.report("apex 1, relative", std::fabs(apex(1)), trial.at({infinite, infinite, 1e-3, 1e-3}),
               trial.at({1e-10, 1e-10, 1e-10, 1e-10}, 0));
  if (r.bounces < 5) return;
  trial.report("apex 5, relative", std::fabs(apex(5)), trial.at({infinite, infinite, 4e-3, 4e-3}),
               trial.at({1e-10, 1e-10, 1e-10, 1e-10}, 0));
  if (flights.impacts.size() >= 5)
    trial.report("instant of impact 5 [s]", std::fabs(flights.impacts[4] - fifth), {},
                 trial.at({1e-10, 1e-10, 1e-10, 1e-10}, 0));
}

/// After the last of infinitely many bounces the ball is at rest.
void comes_to_rest(Trial& trial, double e) {
  const double zeno = std::sqrt(2 / gravity) * (1 + e) / (1 - e);
  Simulated& run = ball_over_floor(trial, {0, 0, e}, 1 + radius, down);
  Worst rebound;
  bool landed = false;
  for (long k = 1, steps = trial.steps(zeno + 1); k <= steps; ++k) {
    run.step(trial.dt());
    landed = landed || run.pose(1).position.z - radius < 1e-3;
    if (e == 0 && landed && double(k) * trial.dt() > zeno + 2 * trial.dt())
      rebound.add(run.pose(1).position.z - radius);
  }
  if (e == 0) trial.report("rebound [m]", rebound, 1e-4);
  trial.report("speed at rest [m/s]", length(run.velocity(1)), trial.at({infinite, infinite, 1e-3, 1e-3}, 3));
  trial.report("penetration at rest [m]", std::max(0.0, radius - run.pose(1).position.z),
               trial.at({infinite, infinite, 1e-4, 1e-4}, 3));
}

/// e = 1: no trend over 1000 bounces.
void keeps_bouncing(Trial& trial) {
  Simulated& run = ball_over_floor(trial, {0, 0, 1}, 1 + radius, down);
  Flights flights;
  flights.add(0, trial.dt(), 1);
  for (long k = 1, steps = trial.steps(1000); k <= steps && flights.apexes.size() < 1000; ++k) {
    run.step(trial.dt());
    flights.add(double(k) * trial.dt(), trial.dt(), run.pose(1).position.z - radius);
  }
  trial.report("apex 1000, relative", flights.apexes.size() == 1000 ? std::fabs(flights.apexes.back() - 1) : 1.0,
               trial.at({infinite, infinite, 1e-3, 1e-3}, 3));
}

// ---- A17 -----------------------------------------------------------------------------------------------

/// All impacts of the table, 0.05 m of fall before each, without gravity.
void spin_bounces(Trial& trial, double e) {
  static const Csv reference = read_csv("A17_spin_bounce.csv");
  Worst velocity, about_contact;
  for (std::size_t row = 0; row < reference.rows.size(); ++row) {
    if (reference.at(row, "e") != e) continue;
    const double vx = reference.at(row, "vx"), wy = reference.at(row, "wy"), vz = reference.at(row, "vz"),
                 mu = reference.at(row, "mu");
    Simulated& run = ball_over_floor(trial, {mu, mu, e}, radius + 0.05, {}, {vx, 0, -vz}, {0, wy, 0});
    run.step(trial.dt(), long(std::ceil(0.05 / vz / trial.dt())) + 2);
    const Vec3 v = run.velocity(1), w = run.angular_velocity(1);
    const Vec3 expected{reference.at(row, "vx1"), 0, reference.at(row, "vz1")};
    const double scale = std::hypot(vx, vz), spin_scale = std::max(std::fabs(wy), scale / radius),
                 inertia = 0.4 * radius * radius;
    velocity.add(length(v - expected) / scale);
    velocity.add(std::fabs(w.y - reference.at(row, "wy1")) / spin_scale);
    about_contact.add(std::fabs(inertia * (w.y - wy) + radius * (v.x - vx)) / (inertia * spin_scale + radius * scale));
  }
  trial.report("velocity and spin, relative", velocity, trial.at({infinite, infinite, 1e-3, 1e-3}, 3));
  trial.report("angular momentum about the contact, relative", about_contact, trial.either(1e-12, 1e-6));
}

/// The same impacts, straight through the solver; the floor is a ball too heavy to notice.
void resolve_bounces(Trial& trial) {
  static const Csv reference = read_csv("A17_spin_bounce.csv");
  Worst velocity, component, about_contact;
  for (std::size_t row = 0; row < reference.rows.size(); ++row) {
    const double vx = reference.at(row, "vx"), wy = reference.at(row, "wy"), vz = reference.at(row, "vz");
    SphereContact contact;
    contact.mass2 = 1e18;
    contact.radius1 = radius;
    contact.normal = {0, 0, -1};
    contact.v1 = {vx, 0, -vz};
    contact.w1 = {0, wy, 0};
    contact.friction = reference.at(row, "mu");
    contact.restitution = reference.at(row, "e");
    trial.resolve(contact);
    const double scale = std::hypot(vx, vz), spin_scale = std::max(std::fabs(wy), scale / radius),
                 inertia = 0.4 * radius * radius;
    velocity.add(length(contact.v1 - Vec3{reference.at(row, "vx1"), 0, reference.at(row, "vz1")}) / scale);
    velocity.add(std::fabs(contact.w1.y - reference.at(row, "wy1")) / spin_scale);
    component.add(error_of_components(contact.v1, {reference.at(row, "vx1"), 0, reference.at(row, "vz1")}, scale));
    component.add(error_of_components(contact.w1, {0, reference.at(row, "wy1"), 0}, spin_scale));
    about_contact.add(std::fabs(inertia * (contact.w1.y - wy) + radius * (contact.v1.x - vx)) /
                      (inertia * spin_scale + radius * scale));
  }
  trial.report("velocity and spin, relative", velocity, trial.either(1e-12, 2e-6));
  trial.report("each component, relative", component, trial.either(1e-12, 2e-6));
  trial.report("angular momentum about the contact, relative", about_contact, trial.either(1e-12, 2e-6));
}

}  // namespace

void add_bounces(std::vector<Case>& cases) {
  Case& ball = cases.emplace_back(Case{"A11", "bouncing ball", {}});
  for (const Restitution& r :
       {Restitution{0.25, 3}, Restitution{0.5, 5}, Restitution{0.75, 5}, Restitution{0.9, 5}, Restitution{1, 5}}) {
    ball.variants.push_back({.name = "e = " + text(r.e),
                             .run = [r](Trial& t) { bouncing(t, r); },
                             .coarse = true,
                             .substeps = {1, 4},
                             .lost_at = 1});
  }
  // the plane's normal is turned into place and is off by a rounding, so a ball at rest on it rolls by as much
  const double tilt = 1e-13;
  for (double e : {0.0, 0.25, 0.5, 0.75, 0.9}) {
    ball.variants.push_back({.name = "rest, e = " + text(e),
                             .run = [e](Trial& t) { comes_to_rest(t, e); },
                             .coarse = true,
                             .substeps = {1, 4},
                             .floor = e > 0 ? std::optional(tilt) : std::nullopt});
  }
  ball.variants.push_back({.name = "1000 bounces",
                           .run = keeps_bouncing,
                           .steps = {ladder[1], ladder[2]},
                           .coarse = true,
                           .more_steps = {ladder[0]},
                           .lost_at = 0.5});

  Case& spin = cases.emplace_back(Case{"A17", "spinning ball bounces", {}});
  spin.variants.push_back({.name = "direct", .run = resolve_bounces, .direct = true});
  for (double e : {0.0, 0.5, 0.8, 1.0}) {
    spin.variants.push_back({.name = "e = " + text(e),
                             .run = [e](Trial& t) { spin_bounces(t, e); },
                             .coarse = true,
                             .substeps = {1, 4},
                             .lost_at = 1});
  }
}

}  // namespace pcphys::cases
