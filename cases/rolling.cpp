// A22, A23: a sphere that rolls and slides.
#include <cmath>
#include <numbers>

#include "case.h"
#include "measures.h"

namespace pcphys::cases {
namespace {

constexpr double radius = 0.1, incline = std::numbers::pi / 6;

/// A ball of 1 kg whose moment is `share` m r^2 on a plane that falls by `slope` towards x.
Simulated& ball_on_plane(Trial& trial, double friction, double slope, double share, double speed = 0, double spin = 0) {
  return trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(friction, 0);
    const Quat turn = axis_angle({0, 1, 0}, slope);
    builder.add(floor_plane(turn));
    BodyDef ball;
    ball.shapes = {ShapeDef::sphere(radius)};
    ball.mass = 1;
    const double moment = share * radius * radius;
    ball.moments = Vec3{moment, moment, moment};
    ball.pose.position = rotate(turn, {0, 0, radius});
    ball.velocity = rotate(turn, {speed, 0, 0});
    ball.angular_velocity = {0, spin, 0};
    builder.add(ball);
  });
}

double way(const Simulated& run, double slope) {
  return dot(run.pose(1).position - run.problem().scene.bodies[1].start.position,
             rotate(axis_angle({0, 1, 0}, slope), {1, 0, 0}));
}

/// Of the surface against the plane, downhill [m/s].
double slip(const Simulated& run, double slope) {
  return dot(run.velocity(1), rotate(axis_angle({0, 1, 0}, slope), {1, 0, 0})) - radius * run.angular_velocity(1).y;
}

std::optional<double> at_fine_steps(const Trial& trial, double bound) {
  return trial.at({infinite, infinite, bound, bound}, 3);
}

// ---- A22 -----------------------------------------------------------------------------------------------

void rolls(Trial& trial, double friction, double share) {
  Simulated& run = ball_on_plane(trial, friction, incline, share);
  run.step(trial.dt(), trial.steps(1));
  const double a = gravity * std::sin(incline) / (1 + share);
  trial.report("displacement, relative", std::fabs(way(run, incline) / (0.5 * a) - 1), at_fine_steps(trial, 1e-4));
  trial.report("slip [m/s]", std::fabs(slip(run, incline)), 1e-6);
}

void slides(Trial& trial, double friction) {
  Simulated& run = ball_on_plane(trial, friction, incline, 0.4);
  run.step(trial.dt(), trial.steps(1));
  const double load = gravity * std::cos(incline), a = gravity * std::sin(incline) - friction * load,
               alpha = friction * load / (0.4 * radius);
  trial.report("displacement, relative", std::fabs(way(run, incline) / (0.5 * a) - 1), at_fine_steps(trial, 1e-4));
  trial.report("spin, relative", std::fabs(run.angular_velocity(1).y / alpha - 1), at_fine_steps(trial, 1e-4));
}

/// Just below the least friction that lets it roll it slips, by what the formula says.
void slips_below_threshold(Trial& trial) {
  const double threshold = std::tan(incline) * 2 / 7;
  Simulated& run = ball_on_plane(trial, 0.99 * threshold, incline, 0.4);
  run.step(trial.dt(), trial.steps(1));
  const double expected = 0.01 * gravity * std::sin(incline);
  trial.report("slip, relative", std::fabs(slip(run, incline) / expected - 1), at_fine_steps(trial, 0.5));
}

// ---- A23 -----------------------------------------------------------------------------------------------

/// v0 = 7 m/s on level ground, mu = 0.2, until it rolls; 2 s in all.
void slides_then_rolls(Trial& trial, double spin) {
  constexpr double v0 = 7, mu = 0.2;
  Simulated& run = ball_on_plane(trial, mu, 0, 0.4, v0, spin);
  run.step(trial.dt(), trial.steps(2));
  const double t = (v0 - radius * spin) / (3.5 * mu * gravity), v = (5 * v0 + 2 * radius * spin) / 7;
  const double x = 0.5 * (v0 + v) * t + v * (2 - t);
  trial.report("displacement [m]", std::fabs(way(run, 0) - x), v0 * trial.dt() / 6);
  trial.report("velocity [m/s]", std::fabs(run.velocity(1).x - v), 1e-6);
}

}  // namespace

void add_rolling(std::vector<Case>& cases) {
  cases.push_back({"A22",
                   "sphere on an incline",
                   {{.name = "rolls, mu = .5",
                     .run = [](Trial& t) { rolls(t, 0.5, 0.4); },
                     .coarse = true,
                     .substeps = {1, 4},
                     .lost_at = 1},
                    {.name = "rolls, shell",
                     .run = [](Trial& t) { rolls(t, 0.5, 2.0 / 3); },
                     .coarse = true,
                     .substeps = {1, 4},
                     .lost_at = 1},
                    {.name = "slides, mu = .1",
                     .run = [](Trial& t) { slides(t, 0.1); },
                     .coarse = true,
                     .substeps = {1, 4},
                     .lost_at = 1},
                    {.name = "1 % above least mu",
                     .run = [](Trial& t) { rolls(t, 1.01 * std::tan(incline) * 2 / 7, 0.4); },
                     .coarse = true,
                     .substeps = {1, 4},
                     .lost_at = 1},
                    {.name = "1 % below least mu",
                     .run = slips_below_threshold,
                     .coarse = true,
                     .substeps = {1, 4},
                     .lost_at = 1}}});
  cases.push_back({"A23",
                   "sliding to rolling",
                   {{.name = "forward",
                     .run = [](Trial& t) { slides_then_rolls(t, 0); },
                     .coarse = true,
                     .substeps = {1, 4},
                     .second_order = "displacement [m]",
                     .order_is_target = true},
                    {.name = "backspin",
                     .run = [](Trial& t) { slides_then_rolls(t, -35); },
                     .coarse = true,
                     .substeps = {1, 4},
                     .second_order = "displacement [m]",
                     .order_is_target = true}}});
}

}  // namespace pcphys::cases
