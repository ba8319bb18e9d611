// C3, C5, C6, C7: bodies that are thin, spin or fly fast, and steps of any length.
#include <algorithm>
#include <numbers>

#include "parts.h"

namespace pcphys::cases {
namespace {

using std::numbers::pi;

// ---- C3 ------------------------------------------------------------------------------------------------

struct Thin {
  const char* name;
  Vec3 half;
  std::optional<Vec3> moments;
};
const Thin thin_bodies[] = {{"needle", {0.5, 0.005, 0.005}, {}},
                            {"disc", {0.5, 0.5, 0.0025}, {}},
                            {"moments 1:1e4", {0.5, 0.05, 0.05}, Vec3{1e-4, 1, 1}}};

BodyDef thin_body(const Thin& thin, Vec3 spin) {
  BodyDef def;
  def.shapes = {ShapeDef::box(thin.half)};
  def.mass = 1;
  def.moments = thin.moments;
  def.angular_velocity = spin;
  return def;
}

void thin_free(Trial& trial, const Thin& thin) {
  Simulated& run = trial.start([&](scenes::Builder& builder) {
    builder.add(without_contacts(thin_body(thin, {30, 30, 26.46})));
  });
  const Vec3 before = angular_momentum(run);
  const double start = energy(run);
  Worst turn, change;
  for (long k = 0; k < trial.steps(10); ++k) {
    run.step(trial.dt());
    turn.add(length(angular_momentum(run) - before) / length(before));
    change.add(std::fabs(energy(run) / start - 1));
  }
  trial.report("angular momentum, relative", turn, trial.either(1e-10, 2e-5));
  trial.report("energy, relative", change, 1e-3);
}

void thin_dropped(Trial& trial, const Thin& thin) {
  Simulated& run = trial.start([&](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(0.5, 0);
    add_floor(builder);
    BodyDef def = thin_body(thin, {30, 30, 26.46});
    def.pose.position = {0, 0, 1};
    builder.add(def);
  });
  const double start = energy(run);
  double least = start;
  Worst gain;
  for (long k = 0; k < trial.steps(5); ++k) {
    run.step(trial.dt());
    const double now = energy(run);
    least = std::min(least, now);
    gain.add((now - least) / start);
  }
  trial.report("energy above its least before / that of the start", gain, 1e-2);
  trial.report("energy left at 5 s, relative", energy(run) / start);
  trial.report("not finite", nonfinite(run), 0.0);
}

// ---- C5 ------------------------------------------------------------------------------------------------

void fast_spin(Trial& trial, bool box, double speed, bool floor) {
  Simulated& run = trial.start([=](scenes::Builder& builder) {
    builder.set_material(0.5, 0);
    if (floor) {
      (void)builder.world().set_gravity(down);
      add_floor(builder);
    }
    BodyDef def;
    def.shapes = {box ? ShapeDef::box({0.3, 0.2, 0.1}) : ShapeDef::sphere(0.2)};
    def.mass = 12;
    def.pose.position = {0, 0, 0.5};
    def.angular_velocity = {0.02 * speed, 0.3 * speed, speed};
    builder.add(def);
  });
  const int body = floor ? 1 : 0;
  const Vec3 before = angular_momentum(run);
  const double start = energy(run);
  Worst turn, gain;
  int backwards = 0;
  const long steps = trial.steps(1), look = std::max(1L, steps / 2000);
  for (long k = 0; k < steps; k += look) {
    run.step(trial.dt(), look);
    turn.add(length(angular_momentum(run) - before) / length(before));
    gain.add(energy(run) / start - 1);
    backwards += dot(run.angular_velocity(body), before) < 0;
  }
  if (!floor) {
    trial.report("angular momentum, relative", turn, trial.either(1e-10, 2e-5));
    trial.report("looks at it turning backwards", backwards, 0.0);
  } else {
    trial.report("energy gained, relative", gain, 1e-2);
    trial.report("not finite", nonfinite(run), 0.0);
  }
}

// ---- C6 ------------------------------------------------------------------------------------------------

/// A body towards a wall in x, head on or grazing at 80 degrees.
struct Shot {
  bool box;
  double size, speed, wall;
  bool grazing;
};

/// Whether it came through, and how fast it came back.
struct Hit {
  bool through = false;
  double rebound = 0;  // over the approach
};

Hit shoot(Trial& trial, const Shot& s) {
  const double along = s.grazing ? s.speed * std::sin(80 * pi / 180) : 0,
               across = s.grazing ? s.speed * std::cos(80 * pi / 180) : s.speed;
  Simulated& run = trial.start([=](scenes::Builder& builder) {
    builder.set_material(0, 1);
    builder.add_fixed_box({0.5 * s.wall, 0, 0}, {0.5 * s.wall, 200, 200});
    BodyDef def;
    def.shapes = {s.box ? ShapeDef::box({s.size, s.size, s.size}) : ShapeDef::sphere(s.size)};
    def.mass = 1;
    def.pose.position = {-0.5 - s.size, 0, 0};
    def.velocity = {across, along, 0};
    builder.add(def);
  });
  run.step(trial.dt(), std::max(3L, trial.steps(1.2 / across)));
  return {run.pose(1).position.x > 0, -run.velocity(1).x / across};
}

void tunnelling(Trial& trial, bool box, bool grazing) {
  int shots = 0, through = 0, slow = 0;
  Worst error;
  for (double size : {0.05, 0.01})
    for (double speed : {10.0, 100.0, 240.0, 1e3})
      for (double wall : {1.0, 0.1, 0.01, 0.001}) {
        const Hit hit = shoot(trial, {box, size, speed, wall, grazing});
        ++shots;
        through += hit.through;
        slow += !hit.through && std::fabs(hit.rebound - 1) > 0.01;
        if (!hit.through) error.add(std::fabs(hit.rebound - 1));
      }
  trial.report("of " + std::to_string(shots) + " shots, through the wall", through, 0.0);
  trial.report("of those that bounced, over 1 % off in speed", slow, 0.0);
  trial.report("rebound speed, relative", error);
}

/// Jolt's HighSpeed: a closed room of 100 m with walls of 0.2 m, 5000 bodies at 250 m/s.
void room(Trial& trial, int count) {
  const double half = 50, thick = 0.1;
  Simulated& run = trial.start([=](scenes::Builder& builder) {
    builder.set_material(0.5, 0.9);
    for (int axis = 0; axis < 3; ++axis)
      for (double side : {-1.0, 1.0}) {
        const double c = side * (half + thick), e = half + 2 * thick;
        if (axis == 0) builder.add_fixed_box({c, 0, 0}, {thick, e, e});
        if (axis == 1) builder.add_fixed_box({0, c, 0}, {e, thick, e});
        if (axis == 2) builder.add_fixed_box({0, 0, c}, {e, e, thick});
      }
    scenes::Random random(5489);
    for (int i = 0; i < count; ++i) {
      const double x = random.between(-48, 48), y = random.between(-48, 48), z = random.between(-48, 48);
      const double a = random.between(0, 2 * pi), u = random.between(-1, 1), r = std::sqrt(1 - u * u);
      const Vec3 v{250 * r * std::cos(a), 250 * r * std::sin(a), 250 * u};
      if (i % 2)
        add_ball(builder, 0.5, 1, {x, y, z}, v);
      else
        add_block(builder, {0.5, 0.5, 0.5}, 1, {{x, y, z}, {}}, v);
    }
  });
  const double start = kinetic_energy(run);
  run.step(trial.dt(), trial.steps(2));
  int out = 0;
  for (int i = 6; i < run.bodies(); ++i) {
    const Vec3 p = run.pose(i).position;
    out += std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) > half;
  }
  trial.report("bodies outside after 2 s", out, 0.0);
  trial.report("energy gained, relative", std::max(0.0, kinetic_energy(run) / start - 1), 1e-2);
}

// ---- C7 ------------------------------------------------------------------------------------------------

struct Swing {
  Worst off, gain;  // from the reference [m]; energy above the start, over m g l / 2
};

/// The rod of A7, let go from level, for a second.
Swing swing_for_a_second(Trial& trial, double dt) {
  static const Csv reference = read_csv("A07_pendulum_90.csv");
  Simulated& run = trial.start([](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    BodyDef rod;
    rod.shapes = {ShapeDef::box({0.05, 0.05, 0.5})};
    rod.mass = 1;
    rod.pose = {{0.5, 0, 0}, exponential({0, -0.5 * pi, 0})};
    const BodyId id = builder.id(builder.add(without_contacts(rod)));
    add_pin(builder, builder.world().ground(), {}, id, {0, 0, 0.5});
  });
  const double start = energy(run);
  Swing swing;
  // where a sample falls on a step; else the energy alone
  std::size_t row = 1;
  for (long k = 1; k <= std::lround(1 / dt); ++k) {
    run.step(dt);
    const double t = double(k) * dt;
    while (row + 1 < reference.rows.size() && reference.rows[row][0] < t - 1e-9) ++row;
    if (std::fabs(reference.rows[row][0] - t) < 1e-9)
      swing.off.add(length(run.pose(0).position - Vec3{reference.at(row, "px"), 0, reference.at(row, "pz")}));
    swing.gain.add((energy(run) - start) / (gravity * 0.5));
  }
  return swing;
}

void any_step_pendulum(Trial& trial) {
  const Swing swing = swing_for_a_second(trial, trial.dt());
  std::optional<double> must;
  // in single precision no more than three times what it is at ten times the step
  if (!trial.is_double() && trial.dt() < 2e-5) must = 3 * swing_for_a_second(trial, 1e-4).off;
  trial.report("position in 1 s [m]", swing.off, must);
  trial.report("energy above the start / (m g l / 2)", swing.gain, 1e-2);
}

void any_step_tower(Trial& trial) {
  Simulated& run = trial.start([](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    add_tower(builder, 10);
  });
  const double start = energy(run);
  Worst gain;
  const long steps = trial.steps(2), look = std::max(1L, steps / 1000);
  for (long k = 0; k < steps; k += look) {
    run.step(trial.dt(), std::min(look, steps - k));
    gain.add(energy(run) / start - 1);
  }
  trial.report("across [m]", moved(run).across, 0.05);
  trial.report("down [m]", moved(run).down);
  trial.report("energy above the start, relative", gain, 1e-2);
  trial.report("not finite", nonfinite(run), 0.0);
}

void any_step_ragdoll(Trial& trial) {
  Simulated& run = trial.start([](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(0.5, 0);
    add_floor(builder);
    builder.add_ragdoll(free_human(), {{0, 0, 1}, axis_angle({1, 0, 0}, 0.3)}, {}, 1);
  });
  const double start = energy(run);
  Worst gap, gain;
  const long steps = trial.steps(1), look = std::max(1L, steps / 1000);
  for (long k = 0; k < steps; k += look) {
    run.step(trial.dt(), look);
    gap.add(joint_gap(run));
    gain.add(energy(run) / start - 1);
  }
  trial.report("joint gap [m]", gap, 0.01);
  trial.report("energy above the start, relative", gain, 1e-2);
  trial.report("not finite", nonfinite(run), 0.0);
}

}  // namespace

void add_extreme_motion(std::vector<Case>& cases) {
  const std::vector<double> fine{1.0 / 240};
  Case& slender = cases.emplace_back(Case{"C3", "thin bodies that tumble at 50 rad/s", {}});
  for (const Thin& thin : thin_bodies) {
    slender.variants.push_back({.name = std::string(thin.name) + ", free",
                                .run = [&thin](Trial& t) { thin_free(t, thin); },
                                .steps = fine,
                                .substeps = {4}});
    slender.variants.push_back({.name = std::string(thin.name) + ", dropped",
                                .run = [&thin](Trial& t) { thin_dropped(t, thin); },
                                .steps = {1.0 / 60, 1.0 / 240},
                                .substeps = {4}});
  }

  Case& spins = cases.emplace_back(Case{"C5", "spins of 1e2 to 1e4 rad/s", {}});
  for (bool box : {true, false})
    for (double speed : {1e2, 1e3, 1e4})
      for (bool floor : {false, true}) {
        char name[64];
        std::snprintf(name, sizeof name, "%s, %g rad/s%s", box ? "box" : "sphere", speed, floor ? ", floor" : "");
        spins.variants.push_back({.name = name,
                                  .run = [=](Trial& t) { fast_spin(t, box, speed, floor); },
                                  .steps = {1.0 / 60, 1.0 / 240, 1.0 / 1200, 1e-4, 1e-5},
                                  .substeps = {1}});
      }

  Case& speeds = cases.emplace_back(Case{"C6", "bodies at up to 1000 m/s against thin walls", {}});
  for (bool box : {false, true})
    for (bool grazing : {false, true})
      speeds.variants.push_back({.name = std::string(box ? "box" : "sphere") + (grazing ? ", grazing" : ", head on"),
                                 .run = [=](Trial& t) { tunnelling(t, box, grazing); },
                                 .steps = {1.0 / 60, 1.0 / 240, 1.0 / 1200},
                                 .substeps = {4}});
  speeds.variants.push_back(
      {.name = "5000 in a room", .run = [](Trial& t) { room(t, 5000); }, .steps = {1.0 / 60}, .substeps = {4}});

  const std::vector<double> all{0.1, 1.0 / 30, 1.0 / 60, 1e-3, 1e-4, 1e-5};
  cases.push_back({"C7",
                   "steps from 1e-5 to 0.1 s",
                   {{.name = "pendulum", .run = any_step_pendulum, .steps = all, .substeps = {1}},
                    {.name = "tower of 10", .run = any_step_tower, .steps = all, .substeps = {4}},
                    {.name = "ragdoll", .run = any_step_ragdoll, .steps = all, .substeps = {4}}}});
}

}  // namespace pcphys::cases
