// A9, A19, A20: hinges, a hinge's limit as a stop, and steps of changing length.
#include <array>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "case.h"
#include "measures.h"

namespace pcphys::cases {
namespace {

using std::numbers::pi;

// ---- A9 ------------------------------------------------------------------------------------------------

constexpr double door_mass = 20, door_arm = 0.45, hinge_tilt = 5 * pi / 180;
constexpr double hinge_inertia = 5.40266666666667, motor_torque = 3, hinge_friction = 4;  // [kg m^2], [N m], [N m s]

enum class Hinge { two_pins, pin_and_angle };
/// joint: the library's own motor and damper; host: the same torque as a force that the host renews each step; drag:
/// the damping as the body's drag.
enum class Motor { none, host, drag, joint };

Simulated& hang_door(Trial& trial, Hinge hinge, double angle, Motor motor) {
  return trial.start([=](scenes::Builder& builder) {
    const double drag = motor == Motor::drag ? hinge_friction / hinge_inertia : 0;
    (void)builder.world().set_gravity(down);
    const Quat tilt = axis_angle({0, 1, 0}, hinge_tilt);
    BodyDef def;
    def.shapes = {ShapeDef::box({0.45, 0.02, 1})};
    def.mass = door_mass;
    def.pose.orientation = tilt * axis_angle({0, 0, 1}, angle);
    def.pose.position = rotate(def.pose.orientation, {door_arm, 0, 0});
    def.linear_drag = def.angular_drag = drag;
    const int door = builder.add(without_contacts(def));
    const Quat to_z = axis_angle({0, 1, 0}, -0.5 * pi);  // turns the frames' x axis, the hinge's, to z
    JointDef joint;
    joint.a = builder.world().ground();
    joint.b = builder.id(door);
    if (motor == Motor::joint) {
      joint.motor = {1e3, motor_torque};  // [rad/s]: never reached
      joint.spring.damping = hinge_friction;
    }
    if (hinge == Hinge::pin_and_angle) joint.freedom = AngleFreedom::hinge();
    for (double z : hinge == Hinge::two_pins ? std::vector{0.9, -0.9} : std::vector{0.0}) {
      joint.frame_a = {rotate(tilt, {0, 0, z}), tilt * to_z};
      joint.frame_b = {{-door_arm, 0, z}, to_z};
      builder.add_joint(joint);
      joint.motor = {}, joint.spring = {};  // one of the pins drives
    }
  });
}

void door(Trial& trial, Hinge hinge, Motor motor, const Csv& reference) {
  const Quat tilt = axis_angle({0, 1, 0}, hinge_tilt);
  const Vec3 downhill = rotate(tilt, {1, 0, 0}), sideways{0, 1, 0}, axis = rotate(tilt, {0, 0, 1});
  Simulated& run = hang_door(trial, hinge, reference.at(0, "phi"), motor);
  Worst angle, bend, force, largest_force;
  const auto compare = [&](std::size_t row) {
    const Vec3 p = run.pose(0).position;
    angle.add(
        std::fabs(std::remainder(std::atan2(dot(p, sideways), dot(p, downhill)) - reference.at(row, "phi"), 2 * pi)));
    const Vec3 is = rotate(run.pose(0).orientation, {0, 0, 1});
    bend.add(std::atan2(length(cross(is, axis)), dot(is, axis)));
  };
  if (motor == Motor::host) {
    // the torque is that of the speed at the start of a step: first order, whatever the engine does with it
    long k = 0;
    for (std::size_t row = 1; row < reference.rows.size(); ++row) {
      const double t = reference.at(row, "t");
      const long until = std::lround(t / trial.dt());
      if (t > 10 + 1e-9 || std::fabs(double(until) * trial.dt() - t) > 1e-9) continue;
      for (; k < until; ++k) {
        run.set_wrench(0, {{}, (motor_torque - hinge_friction * dot(run.angular_velocity(0), axis)) * axis});
        run.step(trial.dt());
      }
      compare(row);
    }
  } else {
    if (motor == Motor::drag) run.set_wrench(0, {{}, motor_torque * axis});
    walk_with_neighbours(run, trial.dt(), reference, 10, [&](std::size_t row, double) {
      compare(row);
      return [&, row](const Neighbours& n) {
        const Vec3 expected = reference.vector(row, "F");
        force.add(length(door_mass * (n.acceleration() - down) - expected));
        largest_force.add(length(expected));
      };
    });
  }
  trial.report("angle [rad]", angle, motor == Motor::host ? std::nullopt : trial.at({1e-3, 6e-5, 2.5e-6, infinite}));
  trial.report("tilt of the hinge's axis [rad]", bend, trial.either(1e-9, 1e-5));
  if (motor == Motor::none)
    trial.report("reaction force / the largest", force / largest_force, trial.at({infinite, 1e-2, 1e-2, 1e-2}));
}

// ---- A19 -----------------------------------------------------------------------------------------------

/// The rod from 90 degrees on a hinge with a limit at -30 degrees.
Simulated& rod_with_a_stop(Trial& trial, double restitution) {
  return trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    const Quat axes = axis_angle({0, 0, 1}, -0.5 * pi);  // turns x to -y, about which the lean grows
    JointDef joint;
    joint.a = builder.world().ground();
    joint.b = builder.id(builder.add(hanging_rod(0.5 * pi)));
    joint.frame_a.orientation = axes;
    joint.frame_b = {{0, 0, 0.5}, axes};
    joint.freedom = AngleFreedom::hinge(-pi / 6);
    joint.freedom.restitution = restitution;
    builder.add_joint(joint);
  });
}
double lean(const Simulated& run) {
  const Vec3 p = run.pose(0).position;
  return std::atan2(p.x, -p.z);
}

/// Energy that the pendulum gained: rounding, which in single precision is judged at the two longer steps. Where all of
/// it comes back, at 1/60 s what a swing without stops has between its ends (A7: 6e-10).
std::optional<double> never_gains(const Trial& trial, double restitution) {
  const double rounding = trial.either(1e-12, 1e-5);
  return trial.at({restitution == 1 ? std::max(1e-9, rounding) : rounding, rounding, rounding, rounding});
}

/// The instant at which an angle that grows through four steps is zero,
/// by the polynomial through them [steps from the first].
double instant_of_zero(const std::array<double, 4>& angles) {
  double instant = 0;
  for (int i = 0; i < 4; ++i) {
    double share = 1;
    for (int k = 0; k < 4; ++k)
      if (k != i) share *= angles[std::size_t(k)] / (angles[std::size_t(k)] - angles[std::size_t(i)]);
    instant += i * share;
  }
  return instant;
}

/// Which stops it without a rebound. The instant is told by the swing that follows: a quarter of its period later the
/// rod hangs down. (By the first step that is slow it is known to a step, whatever an engine does.)
void stop_at_limit(Trial& trial) {
  constexpr double t_hit = 0.5828961625247803, w_hit = 5.042178964653778, limit = -pi / 6, period = 1.668543042785553;
  Simulated& run = rod_with_a_stop(trial, 0);
  const double e0 = energy(run);
  double hit = -1, low = -1, beyond = 0, later = 0, amplitude = 0, gained = 0, last = 0.5 * pi;
  bool fast = false;
  std::array<double, 4> leans{};  // of the last steps
  Neighbours n;
  n.dt = trial.dt();
  n.now = n.after = run.pose(0);
  for (long k = 1, hit_step = 0, steps = trial.steps(5); k <= steps; ++k) {
    run.step(trial.dt());
    n.before = std::exchange(n.now, std::exchange(n.after, run.pose(0)));
    const double angle = lean(run), speed = std::fabs(angle - std::exchange(last, angle)) / trial.dt();
    fast = fast || speed > w_hit;
    if (hit < 0 && fast && angle < 0 && speed < 0.5 * w_hit) hit = double((hit_step = k) - 1) * trial.dt();
    leans = {leans[1], leans[2], leans[3], angle};
    if (low < 0 && hit_step > 0 && leans[1] < 0 && leans[2] >= 0)
      low = (double(k) - 3 + instant_of_zero(leans)) * trial.dt();
    beyond = std::max(beyond, limit - angle);
    if (hit_step > 0 && k >= hit_step + 3)
      later = std::max(later, limit - angle), amplitude = std::max(amplitude, angle);
    if (k > 1) gained = std::max(gained, (n.energy(run.mass(0), down) - e0) / gravity);
  }
  trial.report("instant of the stop by the next swing [s]", std::fabs(low - 0.25 * period - t_hit));
  trial.report("instant of the stop by the step [s]", std::fabs(hit - t_hit), 1.001 * trial.dt());
  trial.report("beyond the limit at the stop [rad]", beyond, w_hit * trial.dt());
  trial.report("beyond the limit from 3 steps later [rad]", later, 1e-4);
  trial.report("swings back to 30 deg, relative", std::fabs(amplitude / (pi / 6) - 1),
               trial.at({infinite, infinite, 1e-2, 1e-2}, 3));
  trial.report("energy gained / (2 m g l)", gained, never_gains(trial, 0));
}

/// Which throws it back, up to `height` [rad].
void thrown_back(Trial& trial, double restitution, double height) {
  constexpr double t_hit = 0.5828961625247803, w_hit = 5.042178964653778, limit = -pi / 6;
  Simulated& run = rod_with_a_stop(trial, restitution);
  const double e0 = energy(run);
  double hit = -1, beyond = 0, back = -1, gained = 0, last = 0.5 * pi;
  bool falls = true;  // until it turns round, at the limit and then at the top
  Neighbours n;
  n.dt = trial.dt();
  n.now = n.after = run.pose(0);
  for (long k = 1, steps = trial.steps(5); k <= steps; ++k) {
    run.step(trial.dt());
    n.before = std::exchange(n.now, std::exchange(n.after, run.pose(0)));
    const double angle = lean(run), before = std::exchange(last, angle);
    if (falls && angle > before && hit < 0) hit = double(k - 1) * trial.dt();
    if (!falls && angle < before && back < 0) back = before;
    falls = angle < before;
    beyond = std::max(beyond, limit - angle);
    if (k > 1) gained = std::max(gained, (n.energy(run.mass(0), down) - e0) / gravity);
  }
  trial.report("instant of the rebound [s]", std::fabs(hit - t_hit), 1.001 * trial.dt());
  trial.report("beyond the limit [rad]", beyond, w_hit * trial.dt());
  trial.report("swings back, relative", std::fabs(back / height - 1), trial.at({infinite, infinite, 1e-2, 1e-2}, 3));
  trial.report("energy gained / (2 m g l)", gained, never_gains(trial, restitution));
}

// ---- A20 -----------------------------------------------------------------------------------------------

constexpr double mean_of_random = 1.0 / 240, mean_of_turns = 0.5 * (1.0 / 60 + 1.0 / 240);

/// Step lengths: 1/60 and 1/240 s in turn, or uniform in [0.5, 1.5] / 240 s;
/// or all of them in proportion to another mean.
std::vector<double> step_lengths(bool random, double mean, double seconds) {
  const double scale = mean / (random ? mean_of_random : mean_of_turns);
  std::vector<double> lengths;
  scenes::Random draws(20);
  for (double t = 0; t < seconds; t += lengths.back())
    lengths.push_back(scale * (random ? draws.between(0.5, 1.5) / 240 : lengths.size() % 2 ? 1.0 / 240 : 1.0 / 60));
  return lengths;
}

/// Angle and rate of the rod's swing, by the classical Runge-Kutta method with steps far below those compared.
struct ExactSwing {
  double angle = 0.5 * pi, rate = 0;
  void advance(double dt) {
    const int parts = int(std::ceil(dt / 5e-4));
    const double h = dt / parts, w2 = rod_frequency() * rod_frequency();
    const auto bend = [w2](double a) { return -w2 * std::sin(a); };
    for (int i = 0; i < parts; ++i) {
      const double a1 = rate, r1 = bend(angle), a2 = rate + 0.5 * h * r1, r2 = bend(angle + 0.5 * h * a1);
      const double a3 = rate + 0.5 * h * r2, r3 = bend(angle + 0.5 * h * a2), a4 = rate + h * r3,
                   r4 = bend(angle + h * a3);
      angle += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
      rate += h / 6 * (r1 + 2 * r2 + 2 * r3 + r4);
    }
  }
};

double swing_error(Trial& trial, const std::vector<double>& lengths) {
  Simulated& run = trial.start([](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    pin(builder, builder.world().ground(), {}, builder.add(hanging_rod(0.5 * pi)), {0, 0, 0.5});
  });
  ExactSwing exact;
  Worst worst;
  for (double dt : lengths) {
    run.step(dt);
    exact.advance(dt);
    worst.add(length(run.pose(0).position - 0.5 * Vec3{std::sin(exact.angle), 0, -std::cos(exact.angle)}));
  }
  return worst;
}

void changing_swing(Trial& trial, bool random) {
  const double longest = (random ? 1.5 : 1.6) * trial.dt();
  const double error = swing_error(trial, step_lengths(random, trial.dt(), 10));
  const double constant = swing_error(trial, std::vector<double>(std::size_t(std::lround(10 / longest)), longest));
  // below what the free flights are allowed it is rounding
  trial.report("position [m]", error, std::max(4 * constant, trial.either(1e-10, 1e-3)));
}

void changing_fall(Trial& trial, bool random, double drag) {
  const Vec3 v0{3, -2, 8};
  Simulated& run = trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    BodyDef def = free_body(1, {0.004, 0.004, 0.004}, v0);
    def.linear_drag = drag;
    builder.add(def);
  });
  double t = 0;
  Worst worst;
  for (double dt : step_lengths(random, trial.dt(), 5)) {
    run.step(dt);
    t += dt;
    worst.add(length(run.pose(0).position - thrown(v0, down, drag, t)));
  }
  trial.report("position [m]", worst, trial.either(1e-10, 1e-3));
}

}  // namespace

void door_with_motor(Trial& trial) {
  static const Csv driven = read_csv("A09b_door_motor_damped.csv");
  door(trial, Hinge::pin_and_angle, Motor::joint, driven);
}

void add_hinges(std::vector<Case>& cases) {
  const Csv open = read_csv("A09a_door_free.csv"), driven = read_csv("A09b_door_motor_damped.csv");
  Case& doors = cases.emplace_back(Case{"A9", "hinged door, its axis tilted by 5 degrees", {}});
  for (const auto& [suffix, hinge] : {std::pair{"two pins", Hinge::two_pins}, {"hinge", Hinge::pin_and_angle}}) {
    const auto run = [hinge = hinge](Motor motor, const Csv& reference) {
      return [=](Trial& t) { door(t, hinge, motor, reference); };
    };
    const std::string end = std::string(", ") + suffix;
    doors.variants.push_back({.name = "a, free" + end,
                              .run = run(Motor::none, open),
                              .coarse = true,
                              .second_order = "angle [rad]",
                              .lost_at = 1});
    doors.variants.push_back({.name = "b, motor" + end,
                              .run = run(Motor::joint, driven),
                              .coarse = true,
                              .second_order = "angle [rad]",
                              .lost_at = 1});
    doors.variants.push_back(
        {.name = "b, host's torque" + end, .run = run(Motor::host, driven), .coarse = true, .lost_at = 1});
    doors.variants.push_back({.name = "b, drag" + end,
                              .run = run(Motor::drag, driven),
                              .coarse = true,
                              .second_order = "angle [rad]",
                              .lost_at = 1});
  }
  cases.push_back(
      {"A19",
       "angle limit as a stop",
       {{.name = "from 90 deg", .run = stop_at_limit, .coarse = true, .substeps = {1, 4}, .lost_at = 0.25}}});
  for (const auto& [name, e, degrees] :
       {std::tuple{"rebound, e = 0.5", 0.5, 49.494649672581}, {"rebound, e = 1", 1.0, 90.0}})
    cases.back().variants.push_back(
        {.name = name,
         .run = [e = e, height = degrees * pi / 180](Trial& t) { thrown_back(t, e, height); },
         .coarse = true,
         .substeps = {1, 4},
         .own = true});

  Case& changing = cases.emplace_back(Case{"A20", "steps of changing length; dt is their mean", {}});
  for (bool random : {false, true}) {
    const std::string prefix = random ? "random, " : "alternating, ";
    const double mean = random ? mean_of_random : mean_of_turns;
    const std::vector<double> steps{mean}, more{8 * mean, 4 * mean, 2 * mean, mean / 4};
    changing.variants.push_back({.name = prefix + "A7",
                                 .run = [=](Trial& t) { changing_swing(t, random); },
                                 .steps = steps,
                                 .more_steps = more,
                                 .lost_at = 0.5});
    changing.variants.push_back({.name = prefix + "A1b",
                                 .run = [=](Trial& t) { changing_fall(t, random, 0.5); },
                                 .steps = steps,
                                 .more_steps = more});
    changing.variants.push_back({.name = prefix + "A2",
                                 .run = [=](Trial& t) { changing_fall(t, random, 0); },
                                 .steps = steps,
                                 .more_steps = more});
  }
}

}  // namespace pcphys::cases
