// B8, B12: motors, and what is stiff or drags.
#include <cmath>
#include <numbers>

#include "parts.h"

namespace pcphys::cases {
namespace {

// ---- B8 ------------------------------------------------------------------------------------------------

constexpr double rotor_inertia = 0.02, rotor_torque = 0.5, rotor_speed = 20, reached_after = 0.8;

/// A rotor on a hinge along x, from rest; after a second a load brakes it for a second.
void rotor(Trial& trial, double load) {
  Simulated& run = trial.start([](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    JointDef joint;
    joint.a = builder.world().ground();
    joint.b = builder.id(builder.add(free_body(1, {rotor_inertia, rotor_inertia, rotor_inertia})));
    joint.freedom = AngleFreedom::hinge();
    joint.motor = {rotor_speed, rotor_torque};
    builder.add_joint(joint);
  });
  double reached = std::numeric_limits<double>::infinity();
  Worst speed, overshoot, off;
  const long second = trial.steps(1);
  for (long k = 1; k <= 2 * second; ++k) {
    if (k == second + 1 && load > 0) run.set_wrench(0, {{}, {-load, 0, 0}});
    run.step(trial.dt());
    const double w = run.angular_velocity(0).x, t = double(k) * trial.dt();
    overshoot.add(w / rotor_speed - 1);
    if (t < reached_after - trial.dt()) speed.add(std::fabs(w / (rotor_torque / rotor_inertia * t) - 1));
    if (w > (1 - 1e-4) * rotor_speed) reached = std::min(reached, t);
    if (k <= second) continue;
    const double expected = rotor_speed - std::max(0.0, load - rotor_torque) / rotor_inertia * (t - 1);
    off.add(std::fabs(w / expected - 1));
  }
  trial.report("instant of full speed [s]", std::fabs(reached - reached_after), 1.001 * trial.dt());
  trial.report("speed on the way, relative", speed, trial.either(1e-6, 1e-2));
  trial.report("overshoot, relative", overshoot, 1e-3);
  trial.report(load > rotor_torque ? "speed while overloaded, relative" : "speed under load, relative", off, 1e-2);
}

// ---- B12 -----------------------------------------------------------------------------------------------

void stiff_drag(Trial& trial) {
  Simulated& run = trial.start([](scenes::Builder& builder) {
    BodyDef def = free_body(1, {0.4, 0.4, 0.4}, {3, -2, 8});
    def.linear_drag = def.angular_drag = 1e4;
    def.angular_velocity = {1, 2, 3};
    builder.add(def);
  });
  Vec3 v = run.velocity(0), w = run.angular_velocity(0);
  int wrong = 0;
  const double rounding = trial.either(1e-12, 1e-6);  // of 9 m/s
  const auto decays = [=](double now, double before) {
    return std::fabs(now) < rounding || (now * before >= 0 && std::fabs(now) <= std::fabs(before));
  };
  for (int k = 0; k < 100; ++k) {
    run.step(trial.dt());
    const Vec3 v1 = run.velocity(0), w1 = run.angular_velocity(0);
    for (const auto& [now, before] :
         {std::pair{v1.x, v.x}, {v1.y, v.y}, {v1.z, v.z}, {w1.x, w.x}, {w1.y, w.y}, {w1.z, w.z}})
      wrong += !decays(now, before);
    v = v1, w = w1;
  }
  trial.report("components that grow or change sign", wrong, 0.0);
  trial.report("distance after the decay [m]", std::fabs(length(run.pose(0).position) - length(Vec3{3, -2, 8}) / 1e4),
               trial.either(1e-12, 1e-8));
}

constexpr double spring_mass = 1e-3, rest_length = 0.5;

/// A light ball on a stiff spring from the origin along x, drawn out by 1 cm;
/// at rest, or let go with a speed from its rest length.
Simulated& stiff_spring(Trial& trial, double stiffness, double mass, double damping, double drawn, double speed) {
  return trial.start([=](scenes::Builder& builder) {
    BodyDef def = free_body(mass, {1e-2 * mass, 1e-2 * mass, 1e-2 * mass}, {speed, 0, 0});
    def.pose.position = {rest_length + drawn, 0, 0};
    SpringDef spring;
    spring.a = builder.world().ground();
    spring.b = builder.id(builder.add(def));
    spring.rest_length = rest_length;
    spring.stiffness = stiffness;
    spring.damping = damping;
    (void)builder.world().create_spring(spring);
  });
}

/// Critically damped: it comes back to its length without passing it.
void damped_spring(Trial& trial) {
  const double stiffness = 1e6, drawn = 0.01;
  Simulated& run = stiff_spring(trial, stiffness, spring_mass, 2 * std::sqrt(stiffness * spring_mass), drawn, 0);
  const double rounding = trial.either(1e-12, 1e-7);
  double before = drawn;
  int wrong = 0;
  for (int k = 0; k < 100; ++k) {
    run.step(trial.dt());
    const double now = run.pose(0).position.x - rest_length;
    wrong += now < -rounding || now > before + rounding;
    before = now;
  }
  trial.report("steps that grow or change sign", wrong, 0.0);
  trial.report("from its length at the end [m]", std::fabs(before), rounding);
}

/// Nothing damps it; whatever its frequency, it has no more energy than it began with.
void free_spring(Trial& trial, double drawn, double speed) {
  const double stiffness = 1e6, start = 0.5 * stiffness * drawn * drawn + 0.5 * spring_mass * speed * speed;
  Simulated& run = stiff_spring(trial, stiffness, spring_mass, 0, drawn, speed);
  Worst most;
  for (int k = 0; k < 1000; ++k) {
    run.step(trial.dt());
    const double x = run.pose(0).position.x - rest_length, v = run.velocity(0).x;
    most.add((0.5 * stiffness * x * x + 0.5 * spring_mass * v * v) / start);
  }
  trial.report("energy / that of the start, largest", most, 1.01);
}

/// One kilogram at 2 Hz, against the cosine.
void slow_spring(Trial& trial) {
  const double w = 4 * std::numbers::pi, drawn = 0.1;
  Simulated& run = stiff_spring(trial, w * w, 1, 0, drawn, 0);
  Worst position;
  for (long k = 1, count = trial.steps(2); k <= count; ++k) {
    run.step(trial.dt());
    position.add(std::fabs(run.pose(0).position.x - rest_length - drawn * std::cos(w * double(k) * trial.dt())));
  }
  // of the implicit midpoint rule: w (w h)^2 t / 12 in phase
  const double h = trial.dt() / trial.substeps();
  trial.report("position [m]", position,
               trial.either(1.2, 2) * drawn * std::pow(w * h, 2) * w * 2 / 12 + trial.either(1e-9, 1e-4));
}

}  // namespace

void add_drives(std::vector<Case>& cases) {
  const std::vector<double> fine{1.0 / 240};
  Case& motors = cases.emplace_back(Case{"B8", "motors", {}});
  for (const auto& [name, load] : {std::pair{"reaches 20 rad/s", 0.0}, {"holds under load", 0.4}, {"overloaded", 0.6}})
    motors.variants.push_back({.name = name,
                               .run = [load = load](Trial& t) { rotor(t, load); },
                               .steps = fine,
                               .substeps = {4},
                               .own = true});
  motors.variants.push_back(
      {.name = "door of A9b", .run = door_with_motor, .own = true, .second_order = "angle [rad]"});

  const std::vector<double> coarse{0.01};
  const std::vector<std::uint32_t> both{1, 4};
  cases.push_back(
      {"B12",
       "stiff decay",
       {{.name = "drag 1e4 1/s", .run = stiff_drag, .steps = coarse, .substeps = both},
        {.name = "spring 1e6 N/m, damped", .run = damped_spring, .steps = coarse, .substeps = both, .own = true},
        {.name = "spring 1e6 N/m, drawn out",
         .run = [](Trial& t) { free_spring(t, 0.01, 0); },
         .steps = coarse,
         .substeps = both,
         .own = true},
        {.name = "spring 1e6 N/m, struck",
         .run = [](Trial& t) { free_spring(t, 0, 10); },
         .steps = coarse,
         .substeps = both,
         .own = true},
        {.name = "spring at 2 Hz", .run = slow_spring, .own = true, .second_order = "position [m]"}}});
}

}  // namespace pcphys::cases
