// A21: a box on an incline of 30 degrees and on level ground.
#include <algorithm>
#include <numbers>

#include "case.h"
#include "measures.h"

namespace pcphys::cases {
namespace {

constexpr double incline = std::numbers::pi / 6;
const double tangent = std::tan(incline);

/// A box of 1 kg that just touches a plane which falls by `slope` towards `yaw`; `speed` is downhill.
struct Slide {
  double static_friction, kinetic_friction, speed = 0, slope = incline, yaw = 0;

  Quat turn() const { return axis_angle({0, 0, 1}, yaw) * axis_angle({0, 1, 0}, slope); }
  Vec3 downhill() const { return rotate(turn(), {1, 0, 0}); }
  Vec3 upward() const { return rotate(turn(), {0, 0, 1}); }
};

Simulated& start(Trial& trial, const Slide& s) {
  return trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(Material{s.static_friction, s.kinetic_friction, 0});
    builder.add(floor_plane(s.turn()));
    BodyDef box;
    box.shapes = {ShapeDef::box({0.2, 0.2, 0.1})};
    box.mass = 1;
    box.pose = {0.1 * s.upward(), s.turn()};
    box.velocity = s.speed * s.downhill();
    builder.add(box);
  });
}

/// Way along the plane, in the plane's own directions.
Vec3 way(const Simulated& run, const Slide& s) {
  return rotate(conjugate(s.turn()), run.pose(1).position - run.problem().scene.bodies[1].start.position);
}

double creep(const Simulated& run, const Slide& s) {
  const Vec3 w = way(run, s);
  return std::hypot(w.x, w.y);
}

void sticks(Trial& trial, const Slide& s, double seconds) {
  Simulated& run = start(trial, s);
  run.step(trial.dt(), trial.steps(1));
  const double settling = creep(run, s);
  run.step(trial.dt(), trial.steps(std::min(seconds, 10.0)) - trial.steps(1));
  trial.report("creep in 10 s [m]", creep(run, s), 1e-6);
  trial.report("creep from 1 s to 10 s [m]", std::fabs(creep(run, s) - settling), 1e-6);
  if (seconds <= 10) return;
  run.step(trial.dt(), trial.steps(seconds) - trial.steps(10));
  trial.report("creep in 100 s [m]", creep(run, s), {}, 1e-6);
}

/// Displacement after 1 s at constant acceleration.
void slides(Trial& trial, const Slide& s) {
  Simulated& run = start(trial, s);
  run.step(trial.dt(), trial.steps(1));
  const double a = gravity * (std::sin(s.slope) - s.kinetic_friction * std::cos(s.slope));
  const Vec3 w = way(run, s);
  trial.report("displacement [m]", std::hypot(w.x - (s.speed + 0.5 * a), w.y), a * trial.dt(),
               trial.is_double() ? std::optional(1e-9) : std::nullopt);
}

/// Until friction stops it, and then it stays.
void stops(Trial& trial, const Slide& s) {
  const double slowing =
      gravity * (s.kinetic_friction * std::cos(s.slope) + std::copysign(std::sin(s.slope), -s.speed));
  const double speed = std::fabs(s.speed), expected = std::copysign(speed * speed / (2 * slowing), s.speed);
  Simulated& run = start(trial, s);
  run.step(trial.dt(), trial.steps(speed / slowing) + 5);
  const double stopped = way(run, s).x;
  trial.report("displacement [m]", std::fabs(stopped - expected), 0.5 * speed * trial.dt());
  run.step(trial.dt(), trial.steps(1));
  trial.report("creep after the stop, 1 s [m]", std::fabs(way(run, s).x - stopped), 1e-6);
}

/// The same slide in eight directions.
void all_directions(Trial& trial) {
  double least = infinite, most = -infinite;
  for (int i = 0; i < 8; ++i) {
    const Slide s{0.3, 0.3, 0, incline, i * std::numbers::pi / 4 + 0.1};
    Simulated& run = start(trial, s);
    run.step(trial.dt(), trial.steps(1));
    least = std::min(least, way(run, s).x);
    most = std::max(most, way(run, s).x);
  }
  trial.report("spread of the displacements [m]", most - least, trial.is_double() ? std::optional(1e-9) : std::nullopt);
}

}  // namespace

void add_friction(std::vector<Case>& cases) {
  Case& box = cases.emplace_back(Case{"A21", "box on an incline", {}});
  const auto add = [&box](const char* name, void (*run)(Trial&, const Slide&), const Slide& s) {
    box.variants.push_back({.name = name, .run = [=](Trial& t) { run(t, s); }, .coarse = true, .substeps = {1, 4}});
  };
  const auto sticks_10 = [](Trial& t, const Slide& s) { sticks(t, s, 10); };
  box.variants.push_back({.name = "a, stick 100 s",
                          .run =
                              [](Trial& t) {
                                sticks(t, {0.6, 0.6}, 100);
                              },
                          .steps = {ladder[0], ladder[1], ladder[2]},
                          .coarse = true,
                          .substeps = {1, 4}});
  add("a, mu = 1.01 tan", sticks_10, {1.01 * tangent, 1.01 * tangent});
  add("a, mu = .99 tan", slides, {0.99 * tangent, 0.99 * tangent});
  add("b, mu = .1", slides, {0.1, 0.1});
  add("b, mu = .3", slides, {0.3, 0.3});
  add("b, mu = .5", slides, {0.5, 0.5});
  add("c, from rest", sticks_10, {0.6, 0.3});
  add("c, from 1 m/s", slides, {0.6, 0.3, 1});
  add("d, up-slope", stops, {0.7, 0.5, -3});
  add("e, level, mu = .2", stops, {0.2, 0.2, 2, 0});
  add("e, level, mu = .4", stops, {0.4, 0.4, 2, 0});
  add("e, level, mu = .7", stops, {0.7, 0.7, 2, 0});
  box.variants.push_back({.name = "f, 8 directions", .run = all_directions, .coarse = true, .substeps = {1, 4}});
}

}  // namespace pcphys::cases
