// A12 to A15: the scenes of SimBenchmark (Hwangbo and Lee, leggedrobotics/SimBenchmark),
// with RaiSim's figures as bounds.
#include <algorithm>

#include "case.h"
#include "measures.h"

namespace pcphys::cases {
namespace {

BodyDef sphere(double mass, double radius, Vec3 position) {
  BodyDef def;
  def.shapes = {ShapeDef::sphere(radius)};
  def.mass = mass;
  def.pose.position = position;
  return def;
}

/// A bound that a table names for one step length each; in single precision for those of `single` and longer.
std::optional<double> named(const Trial& trial, std::initializer_list<std::pair<double, double>> bounds,
                            double single = 1e-3) {
  for (const auto& [dt, bound] : bounds)
    if (std::fabs(trial.dt() / dt - 1) < 1e-9 && (trial.is_double() || dt > 0.99 * single)) return bound;
  return {};
}

// ---- A12 -----------------------------------------------------------------------------------------------

/// Materials whose geometric means are the friction that is asked for: ground and box 0.4, ball and box 0.8, ground
/// and ball 0.5.
constexpr double ground_friction = 0.25, box_friction = 0.64, ball_friction = 1;

/// Mean over the steps of the squared errors of the velocities of the box and of the first ball [m^2/s^2].
double drag_box(Trial& trial, Vec3 direction) {
  constexpr double overlap = 2e-5, a_box = 0.7385, a_ball = 0.211, force = 150;
  Simulated& run = trial.start([](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(ground_friction, 0);
    builder.add(floor_plane());
    builder.set_material(box_friction, 0);
    BodyDef box;
    box.shapes = {ShapeDef::box({10, 10, 0.5})};
    box.mass = 10;
    box.pose.position = {0, 0, 0.5 - overlap};
    builder.add(box);
    builder.set_material(ball_friction, 0);
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) builder.add(sphere(1, 0.5, {2.0 * i - 4, 2.0 * j - 4, 1.5 - 3 * overlap}));
  });
  run.set_wrench(1, {force * direction, {}});
  double sum = 0;
  const long steps = trial.steps(4);
  for (long k = 1; k <= steps; ++k) {
    run.step(trial.dt());
    const double t = double(k) * trial.dt();
    const Vec3 box = run.velocity(1) - a_box * t * direction, ball = run.velocity(2) - a_ball * t * direction;
    sum += dot(box, box) + dot(ball, ball);
  }
  return sum / double(steps);
}

void rolling(Trial& trial) {
  const double y = drag_box(trial, {0, 1, 0}), xy = drag_box(trial, {0.5, 0.8660254037844386, 0});
  // asked for with default settings; one sub-step is to be seen beside them
  const bool usual = trial.substeps() == StepSettings{}.substeps;
  const auto must = [&](double bound) { return usual ? std::optional(bound) : std::nullopt; };
  trial.report("velocity squared, y [m^2/s^2]", y, must(1e-8), 1e-20);
  trial.report("velocity squared, xy [m^2/s^2]", xy, must(1e-8), 1e-20);
  trial.report("xy / y", xy / y, must(10));
}

// ---- A13 -----------------------------------------------------------------------------------------------

struct EnergyError {
  double mean_square = 0;  // of E - E0 [J^2]
  double highest = 0;      // of E / E0
  double end = 0;          // of E / E0
};

EnergyError watch_energy(Trial& trial, Simulated& run, double seconds) {
  const double e0 = energy(run);
  const long steps = trial.steps(seconds);
  EnergyError result;
  for (long k = 0; k < steps; ++k) {
    run.step(trial.dt());
    const double e = energy(run);
    result.mean_square += (e - e0) * (e - e0) / double(steps);
    if (!(e / e0 <= result.highest)) result.highest = e / e0;
    result.end = e / e0;
  }
  return result;
}

void bouncing(Trial& trial) {
  Simulated& run = trial.start([](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(0, 1);
    builder.add(floor_plane());
    for (int i = 0; i < 7; ++i)
      for (int j = 0; j < 7; ++j) builder.add(sphere(10, 0.1, {2.0 * i, 2.0 * j, 5}));
  });
  const EnergyError error = watch_energy(trial, run, 20);
  trial.report("(E - E0)^2, mean [J^2]", error.mean_square,
               named(trial, {{0.1, 1.8e6}, {1e-2, 186}, {1e-3, 0.019}, {1e-4, 1.9e-6}}),
               trial.is_double() ? std::optional(1e-12 * 24034.5 * 24034.5) : std::nullopt);
}

// ---- A14, A15 ------------------------------------------------------------------------------------------

/// 6 x 6 x 6 balls, each a little off its place; the lowest layer's centres at `height`.
Simulated& cube_of_balls(Trial& trial, double height, double restitution) {
  return trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(0, restitution);
    builder.add(floor_plane());
    scenes::Random draws(42);
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j)
        for (int k = 0; k < 6; ++k) {
          const double x = draws.between(0, 0.001), y = draws.between(0, 0.001), z = draws.between(0, 0.001);
          builder.add(sphere(10, 0.1, {0.21 * i + x, 0.21 * j + y, height + 0.21 * k + z}));
        }
  });
}

struct Overlap {
  double squares = 0, deepest = 0;  // sum over pairs and the ground [m^2], [m]
  void add(double depth) {
    if (depth <= 0) return;
    squares += depth * depth;
    deepest = std::max(deepest, depth);
  }
};

Overlap overlap(const Simulated& run) {
  constexpr double radius = 0.1;
  static thread_local std::vector<Vec3> p;
  p.clear();
  for (int i = 1; i < run.bodies(); ++i) p.push_back(run.pose(i).position);
  Overlap sum;
  for (std::size_t i = 0; i < p.size(); ++i) {
    sum.add(radius - p[i].z);
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 d = p[i] - p[j];
      const double square = dot(d, d);
      if (square < 4 * radius * radius) sum.add(2 * radius - std::sqrt(square));
    }
  }
  return sum;
}

void pile(Trial& trial) {
  Simulated& run = cube_of_balls(trial, 0.101, 0);
  const double e0 = energy(run);
  const long steps = trial.steps(10), every = std::max(1L, steps / 10000);
  double squares = 0, deepest = 0;
  for (long k = every; k <= steps; k += every) {
    run.step(trial.dt(), every);
    const Overlap now = overlap(run);
    squares += now.squares * double(every) / double(steps);
    deepest = std::max(deepest, now.deepest);
  }
  trial.report("penetration squared, mean [m^2]", squares,
               named(trial, {{1e-2, 1.5e-2}, {1e-3, 1.35e-4}, {1e-4, 1.6e-6}}), named(trial, {{1e-3, 1e-6}}));
  trial.report("penetration, largest [m]", deepest, named(trial, {{1e-3, 2e-3}}));
  trial.report("energy gained at the end, relative", std::max(0.0, energy(run) / e0 - 1), 0);
}

void elastic(Trial& trial) {
  Simulated& run = cube_of_balls(trial, 1.101, 1);
  const EnergyError error = watch_energy(trial, run, 10);
  trial.report("(E - E0)^2, mean [J^2]", error.mean_square, named(trial, {{1e-2, 5.2e6}, {1e-3, 8.37}}),
               named(trial, {{4e-3, 264}, {1e-4, 1.1e-3}}));
  trial.report("largest energy / E0", error.highest, trial.dt() < 5e-3 ? std::optional(1.05) : std::nullopt);
}

}  // namespace

void add_simbenchmark(std::vector<Case>& cases) {
  cases.push_back(
      {"A12",
       "SimBenchmark rolling: a dragged box with balls on it",
       {{.name = "F = 150 N", .run = rolling, .steps = {1e-2, 1e-3, 1e-4}, .substeps = {1, 4}, .slow = {1e-4}}}});
  cases.push_back(
      {"A13",
       "SimBenchmark bouncing: 49 elastic balls",
       {{.name = "20 s", .run = bouncing, .steps = {0.1, 1e-2, 1e-3, 1e-4}, .substeps = {1, 4}, .slow = {1e-4}}}});
  cases.push_back({"A14",
                   "SimBenchmark 666: 216 balls fall together",
                   {{.name = "10 s", .run = pile, .steps = {1e-2, 1e-3, 1e-4}, .substeps = {1, 4}, .slow = {1e-4}}}});
  cases.push_back(
      {"A15",
       "SimBenchmark elastic 666",
       {{.name = "10 s", .run = elastic, .steps = {1e-2, 4e-3, 1e-3, 1e-4}, .substeps = {1, 4}, .slow = {1e-4}}}});
}

}  // namespace pcphys::cases
