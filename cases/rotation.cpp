// A3, A4, A10: free rotation, with and without drag. Angular momentum is kept, attitude is second order; where two
// moments are equal the motion is exact.
#include "case.h"
#include "measures.h"

namespace pcphys::cases {
namespace {

double relative(Vec3 is, Vec3 expected) { return length(is - expected) / length(expected); }

// ---- A3 ------------------------------------------------------------------------------------------------

/// Turns the top's axis, z, to the body axis that the variant names.
Quat turned(int axis) {
  if (axis == 0) return axis_angle({0, 1, 0}, std::acos(0.0));
  if (axis == 1) return axis_angle({1, 0, 0}, -std::acos(0.0));
  return {};
}

/// A solid cylinder about body axis `axis`; the motion in the world is the same for all three.
void symmetric_top(Trial& trial, int axis) {
  constexpr double m = 2, r = 0.2, h = 0.04, across = m * (r * r / 4 + h * h / 12), along = m * r * r / 2;
  const Quat q0 = exponential((0.5 / std::sqrt(5.0)) * Vec3{1, 2, 0}), turn = turned(axis);
  const Vec3 wb{5, 0, 30}, l = rotate(q0, {across * wb.x, across * wb.y, along * wb.z});
  Simulated& run = trial.start([&](scenes::Builder& builder) {
    BodyDef def = free_body(m, {axis == 0 ? along : across, axis == 1 ? along : across, axis == 2 ? along : across});
    def.pose.orientation = q0 * conjugate(turn);
    def.angular_velocity = rotate(q0, wb);
    builder.add(def);
  });
  const double e0 = kinetic_energy(run);
  Worst attitude, kept, energy;
  const long steps = trial.steps(10), every = std::max(1L, steps / 500);
  for (long k = every; k <= steps; k += every) {
    run.step(trial.dt(), every);
    const double t = double(k) * trial.dt();
    const Quat q = exponential((t / across) * l) * q0 * exponential({0, 0, t * wb.z * (1 - along / across)});
    attitude.add(angle_between(run.pose(0).orientation * turn, q));
    kept.add(relative(spin_momentum(run, 0), l));
    energy.add(std::fabs(kinetic_energy(run) / e0 - 1));
  }
  std::optional<double> must = trial.at({infinite, infinite, 1e-2, 1.5e-4}, 4);
  trial.report("attitude [rad]", attitude, must, trial.is_double() ? std::optional(1e-9) : std::nullopt);
  trial.report("|L - L0| / |L0|", kept, trial.either(1e-12, 1e-6));
  trial.report("energy / E0", energy, trial.is_double() ? std::optional(1e-12) : std::nullopt);
}

// ---- A4 ------------------------------------------------------------------------------------------------

const Vec3 generic_spin{4, 3, 2}, flipping_spin{0.02, 6, 0.02}, box_moments{0.2, 0.4, 0.52};

Simulated& tumbling_box(Trial& trial, Quat q, Vec3 body_spin) {
  return trial.start([=](scenes::Builder& builder) {
    BodyDef def;
    def.shapes = {ShapeDef::box({0.3, 0.2, 0.1})};
    def.mass = 12;
    def.pose.orientation = q;
    def.angular_velocity = rotate(q, body_spin);
    builder.add(without_contacts(def));
  });
}

/// Largest errors until 4 s and until the end, and of the angular momentum.
struct Tumble {
  Worst early, late, kept;
};

Tumble tumble(Trial& trial, const Csv& reference, Vec3 body_spin, double seconds) {
  Simulated& run = tumbling_box(trial, reference.quaternion(0, "q"), body_spin);
  const Vec3 l0 = spin_momentum(run, 0);
  Tumble worst;
  walk(run, trial.dt(), reference, seconds, [&](std::size_t row, double t) {
    const double error = angle_between(run.pose(0).orientation, reference.quaternion(row, "q"));
    worst.late.add(error);
    if (t <= 4 + 1e-9) worst.early.add(error);
    worst.kept.add(relative(spin_momentum(run, 0), l0));
  });
  return worst;
}

void generic_tumble(Trial& trial) {
  static const Csv reference = read_csv("A04b_tumble_generic.csv");
  const Tumble worst = tumble(trial, reference, generic_spin, 10);
  trial.report("attitude [rad]", worst.late, trial.at({4e-2, 2.4e-3, 1e-4, 1.2e-6}, 3),
               trial.at({9.6e-4, 6.0e-5, 2.4e-6, 3.5e-8}, 0));
  trial.report("|L - L0| / |L0|", worst.kept, trial.either(1e-11, 2e-5));
}

void flips(Trial& trial) {
  static const Csv reference = read_csv("A04a_dzhanibekov.csv");
  const Tumble worst = tumble(trial, reference, flipping_spin, 20);
  trial.report("attitude until 4 s [rad]", worst.early, trial.at({6e-3, 4e-4, 1.5e-5, 2e-7}, 3));
  trial.report("attitude until 20 s [rad]", worst.late, trial.at({infinite, 5e-4, 2e-5, 3e-7}, 0),
               trial.at({1.2e-4, 7e-6, 2.8e-7, infinite}, 0));
  trial.report("|L - L0| / |L0|", worst.kept, trial.either(1e-11, 2e-5));
}

/// Instants at which the spin about the intermediate axis changes sign, by Euler's equations and the classical
/// fourth-order Runge-Kutta method. What each step rounds joins the next:
/// flips grow it, to 3e-9 s at the fourth without that.
std::vector<double> flip_times(double seconds) {
  const Vec3 i = box_moments;
  const auto rate = [i](Vec3 w) {
    return Vec3{(i.y - i.z) / i.x * w.y * w.z, (i.z - i.x) / i.y * w.z * w.x, (i.x - i.y) / i.z * w.x * w.y};
  };
  const double dt = 5e-5;
  Vec3 w = flipping_spin, low;
  std::vector<double> times;
  for (long k = 1; double(k) * dt <= seconds; ++k) {
    const Vec3 a = rate(w), b = rate(w + 0.5 * dt * a), c = rate(w + 0.5 * dt * b), d = rate(w + dt * c);
    const Vec3 change = low + dt / 6 * (a + 2 * b + 2 * c + d), next = w + change;
    low = change - (next - w);
    if (w.y * next.y < 0) times.push_back((double(k) - next.y / (next.y - w.y)) * dt);
    w = next;
  }
  return times;
}

void flip_instants(Trial& trial) {
  static const std::vector<double> expected = flip_times(20);
  Simulated& run = tumbling_box(trial, {}, flipping_spin);
  const auto middle_spin = [&run] { return rotate(conjugate(run.pose(0).orientation), run.angular_velocity(0)).y; };
  std::size_t seen = 0;
  Worst worst;
  double before = middle_spin();
  for (long k = 1, steps = trial.steps(20); k <= steps; ++k) {
    run.step(trial.dt());
    const double now = middle_spin();
    if (before * now < 0 && seen < expected.size())
      worst.add(std::fabs((double(k) - now / (now - before)) * trial.dt() - expected[seen++]));
    before = now;
  }
  trial.report("flip time [s]", worst, trial.at({infinite, 5e-4 / 3, 2e-5 / 3, 1e-7}, 0));
  trial.report("flips that are missing", double(expected.size() - seen), 0);
}

/// Energy oscillates within bounds and has no trend, 1000 s.
void long_tumble(Trial& trial) {
  Simulated& run = tumbling_box(trial, exponential({0.2, 0.4, 0.6}), generic_spin);
  const double e0 = kinetic_energy(run);
  const long steps = trial.steps(1000);
  Worst worst;
  Trend trend(steps);
  for (long k = 0; k < steps; ++k) {
    run.step(trial.dt());
    const double error = kinetic_energy(run) / e0 - 1;
    worst.add(std::fabs(error));
    trend.add(error);
  }
  trial.report("energy / E0", worst, trial.at({1e-4, 4e-6, infinite, infinite}));
  trial.report("trend of the energy / its oscillation", trend / worst,
               trial.is_double() ? std::optional(0.1) : std::nullopt);
}

/// Angular momentum after 100,000 steps of a millisecond; longer steps make the same 100 s.
void many_steps(Trial& trial) {
  Simulated& run = tumbling_box(trial, exponential({0.2, 0.4, 0.6}), generic_spin);
  const Vec3 l0 = spin_momentum(run, 0);
  run.step(trial.dt(), trial.steps(100));
  trial.report("|L - L0| / |L0|", relative(spin_momentum(run, 0), l0), trial.either(1e-11, 2e-5));
}

// ---- A10 -----------------------------------------------------------------------------------------------

void tumble_with_drag(Trial& trial) {
  static const Csv reference = read_csv("A10_tumble_drag.csv");
  constexpr double drag = 0.5, angular_drag = 0.8;
  Simulated& run = trial.start([](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    BodyDef def;
    def.shapes = {ShapeDef::box({0.3, 0.2, 0.1})};
    def.mass = 12;
    def.pose = {reference.vector(0, "p"), reference.quaternion(0, "q")};
    def.velocity = reference.vector(0, "v");
    def.angular_velocity = reference.vector(0, "w");
    def.linear_drag = drag;
    def.angular_drag = angular_drag;
    builder.add(without_contacts(def));
  });
  const Vec3 l0 = spin_momentum(run, 0);
  Worst attitude, position, velocity, momentum;
  walk(run, trial.dt(), reference, 1e9, [&](std::size_t row, double t) {
    attitude.add(angle_between(run.pose(0).orientation, reference.quaternion(row, "q")));
    position.add(length(run.pose(0).position - reference.vector(row, "p")));
    velocity.add(length(run.velocity(0) - reference.vector(row, "v")));
    momentum.add(length(spin_momentum(run, 0) - std::exp(-angular_drag * t) * l0) / length(l0));
  });
  trial.report("attitude [rad]", attitude, trial.at({3e-3, 2e-4, 8e-6, infinite}, 3));
  trial.report("position [m]", position, trial.either(1e-11, 1e-4));
  trial.report("velocity [m/s]", velocity, trial.is_double() ? std::optional(1e-11) : std::nullopt);
  trial.report("|L - L0 e^(-Fr t)| / |L0|", momentum, trial.is_double() ? std::optional(1e-12) : std::nullopt);
}

}  // namespace

void add_rotation(std::vector<Case>& cases) {
  Case& top = cases.emplace_back(Case{"A3", "torque-free symmetric top", {}});
  for (const auto& [name, axis] : {std::pair{"about z", 2}, {"about x", 0}, {"about y", 1}})
    top.variants.push_back(
        {.name = name, .run = [axis = axis](Trial& t) { symmetric_top(t, axis); }, .coarse = true, .lost_at = 1});
  cases.push_back(
      {"A4",
       "torque-free asymmetric box",
       {{.name = "b, tumble", .run = generic_tumble, .coarse = true, .second_order = "attitude [rad]", .lost_at = 1},
        {.name = "a, flips", .run = flips, .coarse = true, .second_order = "attitude until 4 s [rad]", .lost_at = 1},
        {.name = "a, flip times", .run = flip_instants, .coarse = true, .single = false, .lost_at = 1},
        {.name = "energy 1000 s", .run = long_tumble, .steps = {ladder[0], ladder[1]}, .coarse = true, .single = false},
        {.name = "1e5 steps", .run = many_steps, .steps = {1e-3}, .more_steps = {1.0 / 60, 1.0 / 240}}}});
  cases.push_back(
      {"A10",
       "tumbling box with drag",
       {{.name = "thrown", .run = tumble_with_drag, .coarse = true, .second_order = "attitude [rad]", .lost_at = 1}}});
}

}  // namespace pcphys::cases
