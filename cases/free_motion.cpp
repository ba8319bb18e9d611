// A1, A2, A5: motion whose exact solution is a formula, under constant force, torque and linear drag; and the original
// document's drag, whose error is one.
#include <limits>

#include "case.h"
#include "measures.h"

namespace pcphys::cases {
namespace {

const Vec3 start_velocity{3, -2, 8};

Simulated& throw_ball(Trial& trial, double drag, Integrator integrator = Integrator::verlet) {
  const auto tune = [=](StepSettings& settings) { settings.integrator = integrator; };
  const auto build = [=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    BodyDef def;
    def.shapes = {ShapeDef::sphere(0.1)};
    def.mass = 1;
    def.velocity = start_velocity;
    def.linear_drag = drag;
    builder.add(without_contacts(def));
  };
  return trial.start(build, tune);
}

// ---- A1 ------------------------------------------------------------------------------------------------

void fall_with_drag(Trial& trial, double drag) {
  Simulated& run = throw_ball(trial, drag);
  Worst position;
  double speed = length(start_velocity);
  for (long k = 1; k <= trial.steps(5); ++k) {
    run.step(trial.dt());
    const double t = double(k) * trial.dt();
    position.add(length(run.pose(0).position - thrown(start_velocity, down, drag, t)));
    speed = std::max(speed, length(run.velocity(0)));
  }
  const double limit = std::max(length(start_velocity), gravity / drag);
  trial.report("position [m]", position, trial.either(1e-11, 1e-4));
  trial.report("speed above start and terminal [m/s]", std::max(0.0, speed - limit), trial.either(1e-11, 1e-4));
}

/// Seed: d' = f d + a dt^2 with f = 1 - dt F, so that after n steps d = f^n d0 + a dt^2 (1 - f^n) / (1 - f), and p
/// their sum; f is 0 where dt F is above 1.
void fall_by_seed(Trial& trial, double drag) {
  Simulated& run = throw_ball(trial, drag, Integrator::seed);
  const double dt = trial.dt(), f = std::max(0.0, 1 - dt * drag), loss = 1 - f;
  const Vec3 limit = (dt / loss) * down;
  Worst rate, position;
  double fastest = 0;
  for (long n = 1; n <= 6000; ++n) {
    run.step(dt);
    const double left = std::pow(f, double(n));
    const Vec3 u = left * start_velocity + (1 - left) * limit;
    const Vec3 p = (dt * f * (1 - left) / loss) * (start_velocity - limit) + (double(n) * dt) * limit;
    rate.add(length(run.velocity(0) - u) / length(u));
    position.add(length(run.pose(0).position - p) / std::max(1.0, length(p)));
    fastest = std::max(fastest, length(run.velocity(0)));
  }
  trial.report("displacement a step, relative", rate, trial.either(1e-12, 1e-5));
  trial.report("position, relative", position, trial.either(1e-12, 1e-5));
  const double most = std::max(length(start_velocity), length(limit));
  trial.report("speed above start and terminal [m/s]", std::max(0.0, fastest - most), trial.either(1e-11, 1e-4));
}

// ---- A2 ------------------------------------------------------------------------------------------------

void projectile(Trial& trial) {
  Simulated& run = throw_ball(trial, 0);
  Worst position;
  // in single precision 1200 steps, whatever their length
  const long count = trial.is_double() ? trial.steps(5) : 1200;
  for (long k = 1; k <= count; ++k) {
    run.step(trial.dt());
    const Vec3 p = thrown(start_velocity, down, 0, double(k) * trial.dt());
    const double error = length(run.pose(0).position - p);
    if (trial.is_double())
      position.add(error / (std::max(length(p), 1.0) * std::sqrt(double(k))));
    else if (k == count)
      position.add(error / length(p));
  }
  trial.report(trial.is_double() ? "position / (max(|p|, 1) sqrt(steps))" : "position / |p|", position,
               trial.either(1e-12, 2e-6));
}

// ---- A5 ------------------------------------------------------------------------------------------------

/// What rounding leaves unknown of an angle that follows from the length of the run [rad].
double last_place(double angle) { return angle * std::numeric_limits<double>::epsilon(); }

/// The box of A4 from rest under 2.6 N m about z until `seconds_on`, then none, 10 s in all.
void spin_up(Trial& trial, double seconds_on) {
  Simulated& run = trial.start([](scenes::Builder& builder) { builder.add(free_body(12, {0.2, 0.4, 0.52})); });
  const long on = trial.steps(seconds_on), all = trial.steps(10);
  run.set_wrench(0, {{}, {0, 0, 2.6}});
  run.step(trial.dt(), on);
  run.set_wrench(0, {});
  run.step(trial.dt(), all - on);
  const double acceleration = 2.6 / 0.52, t1 = double(on) * trial.dt(), t2 = double(all - on) * trial.dt();
  const double speed = acceleration * t1, angle = 0.5 * acceleration * t1 * t1 + speed * t2;
  std::optional<double> must;
  if (trial.is_double()) must = 1e-8;
  trial.report("angle [rad]", angle_between(run.pose(0).orientation, axis_angle({0, 0, 1}, angle)), must);
  trial.report("speed [rad/s]", length(run.angular_velocity(0) - Vec3{0, 0, speed}), trial.either(1e-9, 1e-3));
}

std::vector<double> with_long_step() { return {0.1, ladder[0], ladder[1], ladder[2], ladder[3]}; }

}  // namespace

void add_free_motion(std::vector<Case>& cases) {
  Case& drag = cases.emplace_back(Case{"A1", "free fall with linear drag, against the closed form", {}});
  for (const auto& [name, f] :
       {std::pair{"F = 0.5 1/s", 0.5}, {"F = 1 1/s", 1.0}, {"F = 5 1/s", 5.0}, {"F = 30 1/s", 30.0}})
    drag.variants.push_back(
        {.name = name, .run = [f = f](Trial& t) { fall_with_drag(t, f); }, .steps = with_long_step(), .coarse = true});
  for (const auto& [name, f] : {std::pair{"seed, F = 0.5 1/s", 0.5},
                                {"seed, F = 1 1/s", 1.0},
                                {"seed, F = 5 1/s", 5.0},
                                {"seed, F = 30 1/s", 30.0}})
    drag.variants.push_back(
        {.name = name, .run = [f = f](Trial& t) { fall_by_seed(t, f); }, .steps = with_long_step(), .own = true});
  cases.push_back(
      {"A2", "projectile", {{.name = "thrown", .run = projectile, .steps = with_long_step(), .coarse = true}}});
  cases.push_back({"A5",
                   "constant torque spins a box up",
                   {{.name = "10 s",
                     .run = [](Trial& t) { spin_up(t, 10); },
                     .coarse = true,
                     .floor = last_place(250),
                     .lost_at = 1},
                    {.name = "off at 5 s",
                     .run = [](Trial& t) { spin_up(t, 5); },
                     .coarse = true,
                     .floor = last_place(187.5),
                     .lost_at = 1}}});
}

}  // namespace pcphys::cases
