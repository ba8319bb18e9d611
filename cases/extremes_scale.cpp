// C1, C2, C4, C10: the same motion in other units: masses, sizes, gravity, and far from the origin.
#include <algorithm>
#include <numbers>

#include "parts.h"

namespace pcphys::cases {
namespace {

using std::numbers::pi;
using Path = std::vector<Vec3>;

/// Where all bodies are after each of these many steps, less `offset`, over `size`.
Path follow(Simulated& run, double dt, long steps, Vec3 offset = {}, double size = 1) {
  Path path;
  for (long k = 0; k < steps; ++k) {
    run.step(dt);
    for (int i = 0; i < run.bodies(); ++i)
      if (run.moves(i)) path.push_back((1 / size) * (run.pose(i).position - offset));
  }
  return path;
}

double difference(const Path& a, const Path& b) {
  Worst worst;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) worst.add(length(a[i] - b[i]));
  return worst;
}

// ---- C1 ------------------------------------------------------------------------------------------------

/// A ball that bounces, a box on a slope of 30 degrees, and two balls that collide, all masses times `unit`.
void masses_scene(scenes::Builder& builder, double unit) {
  (void)builder.world().set_gravity(down);
  builder.set_material(0.3, 0.8);
  add_floor(builder);
  add_ball(builder, 0.1, unit, {0, 0, 1.1});
  const Quat slope = axis_angle({0, 1, 0}, pi / 6);
  BodyDef plane;
  plane.kind = BodyKind::fixed;
  plane.shapes = {ShapeDef::box({5, 1, 0.1})};
  plane.pose = {{0, 10, 5}, slope};
  builder.set_material(0.3, 0);
  builder.add(plane);
  add_block(builder, {0.2, 0.2, 0.1}, unit, {plane.pose.position + rotate(slope, {-2, 0, 0.2}), slope});
  builder.set_material(0.1, 0.5);
  add_ball(builder, 0.1, unit, {0, -10, 5}, {2, 0, 1});
  add_ball(builder, 0.2, 10 * unit, {1, -10, 5.1});
}

void masses(Trial& trial, double unit) {
  const long steps = trial.steps(1);
  Simulated& one = trial.start([](scenes::Builder& builder) { masses_scene(builder, 1); });
  const Path reference = follow(one, trial.dt(), steps);
  Simulated& other = trial.start([=](scenes::Builder& builder) { masses_scene(builder, unit); });
  trial.report("positions beside those of 1 kg [m]", difference(follow(other, trial.dt(), steps), reference),
               trial.either(1e-11, 1e-4));
  trial.report("not finite", nonfinite(other), 0.0);
}

// ---- C2 ------------------------------------------------------------------------------------------------

/// A body of this kind and half size falls five sizes onto the floor.
Simulated& drop(Trial& trial, ShapeKind kind, double size, double restitution) {
  return trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(0.5, restitution);
    add_floor(builder);
    const double half = 0.5 * size;
    BodyDef def;
    def.shapes = {kind == ShapeKind::sphere    ? ShapeDef::sphere(half)
                  : kind == ShapeKind::capsule ? ShapeDef::capsule(half, half)
                                               : ShapeDef::box({half, half, half})};
    def.pose.position = {0, 0, 5.5 * size};
    builder.add(def);
  });
}

void size_of_drop(Trial& trial, ShapeKind kind, double size, double restitution) {
  const double time = std::sqrt(size), dt = trial.dt() * time;
  const long steps = trial.steps(6);
  Simulated& one = drop(trial, kind, 1, restitution);
  const Path reference = follow(one, trial.dt(), steps);
  Simulated& other = drop(trial, kind, size, restitution);
  const Path path = follow(other, dt, steps, {}, size);
  // a box that lands flat and bounces turns by its rounding, so in single precision paths part
  const bool bounded = trial.is_double() || restitution == 0 || kind == ShapeKind::sphere;
  trial.report("path / size beside that of 1 m", difference(path, reference),
               bounded ? std::optional(trial.either(1e-6, 1e-4)) : std::nullopt);
  // a capsule lies: half a size is its radius
  trial.report("penetration at rest / size", std::max(0.0, 0.5 - path.back().z), 1e-3);
  trial.report("speed at rest / sqrt(size) [m/s]", length(other.velocity(1)) / time, restitution > 0 ? 1e-2 : 1e-3);
}

/// At rest, with steps as long as they are whatever its size.
void rests_at_any_size(Trial& trial, ShapeKind kind, double size) {
  Simulated& run = drop(trial, kind, size, 0);
  run.step(trial.dt(), trial.steps(6 * std::max(1.0, std::sqrt(size))));
  trial.report("penetration at rest / size", deepest_contact(run.problem().world) / size, 1e-3);
}

void tiny_pyramid(Trial& trial) {
  const double edge = 0.05;
  Simulated& run = trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(0.6, 0);
    add_floor(builder);
    add_pyramid(builder, {.base = 30, .edge = edge, .mass = 0.125});
  });
  run.step(trial.dt(), trial.steps(5));
  const Moved m = moved(run);
  trial.report("across / edge", m.across / edge, 0.1);
  trial.report("down / edge", m.down / edge, 0.1);
  trial.report("deepest contact / edge", deepest_contact(run.problem().world) / edge);
}

// ---- C4 ------------------------------------------------------------------------------------------------

enum class Far { pendulum, double_pendulum, tower, bounce, ragdolls };

void far_scene(scenes::Builder& builder, Far what, Vec3 offset) {
  (void)builder.world().set_gravity(down);
  const auto post = [&] {
    BodyDef def;
    def.kind = BodyKind::fixed;
    def.shapes = {ShapeDef::sphere(0.1)};
    def.pose.position = offset;
    return builder.id(builder.add(without_contacts(def)));
  };
  const auto rods = [&](int count, Vec3 towards, Quat turned) {
    BodyId above = post();
    for (int i = 0; i < count; ++i) {
      BodyDef rod;
      rod.shapes = {ShapeDef::box({0.05, 0.05, 0.5})};
      rod.mass = 1;
      rod.pose = {offset + (i + 0.5) * towards, turned};
      const BodyId id = builder.id(builder.add(without_contacts(rod)));
      add_pin(builder, above, i == 0 ? Vec3{} : Vec3{0, 0, -0.5}, id, {0, 0, 0.5});
      above = id;
    }
  };
  const Quat level = exponential({0, -0.5 * pi, 0});
  switch (what) {
    case Far::pendulum: return rods(1, {1, 0, 0}, level);
    case Far::double_pendulum: return rods(2, {1, 0, 0}, level);
    case Far::tower: return add_tower(builder, 10, 1, offset);
    case Far::bounce:
      builder.set_material(0, 0.9);
      add_floor(builder, offset);
      add_ball(builder, 0.1, 1, offset + Vec3{0, 0, 1.1});
      return;
    case Far::ragdolls:
      builder.set_material(0.5, 0);
      add_floor(builder, offset);
      for (int i = 0; i < 5; ++i)
        builder.add_ragdoll(
            free_human(), {offset + Vec3{0.1 * i, 0.05 * i, 0.3 + 0.6 * i}, axis_angle({1, 0, 0}, 0.1 * i)}, {}, i + 1);
  }
}

void far_away(Trial& trial, Far what, double distance) {
  const Vec3 offset{distance, -0.8 * distance, 0.5 * distance};
  const long steps = trial.steps(what == Far::ragdolls ? 3 : 4);
  Simulated& here = trial.start([=](scenes::Builder& builder) { far_scene(builder, what, {}); });
  const Path reference = follow(here, trial.dt(), steps);
  Simulated& there = trial.start([=](scenes::Builder& builder) { far_scene(builder, what, offset); });
  const Path path = follow(there, trial.dt(), steps, offset);
  const bool single_must = distance <= 1e4;
  if (what == Far::tower)
    trial.report("across [m]", moved(there).across,
                 trial.is_double() || single_must ? std::optional(0.05) : std::nullopt);
  if (what == Far::ragdolls) {
    trial.report("joint gap [m]", joint_gap(there),
                 trial.is_double() || single_must ? std::optional(0.01) : std::nullopt);
    trial.report("speed at the end [m/s]", largest_speed(there));
  } else {
    // a double pendulum and a tower amplify rounding
    const double grown = what == Far::pendulum || what == Far::bounce ? 1 : 1e3;
    std::optional<double> must;
    if (trial.is_double()) must = 1e-9 * distance * grown;
    if (!trial.is_double() && single_must && what == Far::pendulum) must = 1e-2;
    trial.report("path beside the one at the origin [m]", difference(path, reference), must);
  }
  trial.report("not finite", nonfinite(there), 0.0);
}

// ---- C10 -----------------------------------------------------------------------------------------------

void weak_or_strong(Trial& trial, bool tower, double g) {
  const auto build = [=](double strength) {
    return [=](scenes::Builder& builder) {
      (void)builder.world().set_gravity({0, 0, -strength});
      if (tower) return add_level_tower(builder, 10);
      builder.set_material(0, 0.9);
      add_level_floor(builder);
      add_ball(builder, 0.1, 1, {0, 0, 1.1});
    };
  };
  if (g == 0) {
    Simulated& run = trial.start(build(0));
    run.step(trial.dt(), trial.steps(10));
    const Moved m = moved(run);
    return trial.report("drift [m]", std::max(m.across, m.down), trial.either(1e-15, 1e-7));
  }
  const double time = std::sqrt(gravity / g);
  const long steps = trial.steps(3);
  Simulated& usual = trial.start(build(gravity));
  const Path reference = follow(usual, trial.dt(), steps);
  Simulated& other = trial.start(build(g));
  trial.report("path at equal g t^2 [m]", difference(follow(other, trial.dt() * time, steps), reference),
               trial.either(1e-6, 1e-4));
}

std::string text(const char* format, double x) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, x);
  return buffer;
}

}  // namespace

void add_scales(std::vector<Case>& cases) {
  const std::vector<double> fine{1.0 / 240};
  Case& mass = cases.emplace_back(Case{"C1", "masses from 1e-9 to 1e12 kg", {}});
  for (double unit : {1e-9, 1e-6, 1e6, 1e12})
    mass.variants.push_back({.name = text("%g kg", unit),
                             .run = [=](Trial& t) { masses(t, unit); },
                             .steps = {1.0 / 1200},
                             .substeps = {1, 4}});

  Case& size = cases.emplace_back(Case{"C2", "sizes from 1 mm to 1 km", {}});
  for (const auto& [kind, name] :
       {std::pair{ShapeKind::sphere, "sphere"}, {ShapeKind::box, "box"}, {ShapeKind::capsule, "capsule"}})
    for (double s : {1e-3, 1e-2, 100.0, 1e3})
      for (double e : {0.0, 0.5})
        size.variants.push_back({.name = name + text(" of %g m", s) + text(", e %g", e),
                                 .run = [kind = kind, s, e](Trial& t) { size_of_drop(t, kind, s, e); },
                                 .steps = fine,
                                 .substeps = {4}});
  for (const auto& [kind, name] :
       {std::pair{ShapeKind::sphere, "sphere"}, {ShapeKind::box, "box"}, {ShapeKind::capsule, "capsule"}})
    for (double s : {1e-3, 1e-2, 1.0, 100.0, 1e3})
      size.variants.push_back({.name = name + text(" of %g m, steps as they are", s),
                               .run = [kind = kind, s](Trial& t) { rests_at_any_size(t, kind, s); },
                               .steps = {1.0 / 60, 1.0 / 240},
                               .substeps = {4}});
  size.variants.push_back({.name = "pyramid of 5 cm boxes", .run = tiny_pyramid, .steps = {1.0 / 60}, .substeps = {4}});

  Case& far = cases.emplace_back(Case{"C4", "far from the origin", {}});
  struct Kind {
    const char* name;
    Far what;
  };
  for (const Kind& k : {Kind{"pendulum", Far::pendulum},
                        {"double pendulum", Far::double_pendulum},
                        {"tower of 10", Far::tower},
                        {"bounce", Far::bounce},
                        {"5 ragdolls", Far::ragdolls}})
    for (double distance : {1e3, 1e4, 1e5, 1e6})
      far.variants.push_back({.name = k.name + text(" at %g m", distance),
                              .run = [=](Trial& t) { far_away(t, k.what, distance); },
                              .steps = fine,
                              .substeps = {4}});

  Case& pull = cases.emplace_back(Case{"C10", "gravity of 0, 1e-3 and 1e3 m/s^2", {}});
  for (bool tower : {false, true})
    for (double g : {0.0, 1e-3, 1e3})
      pull.variants.push_back({.name = std::string(tower ? "tower of 10" : "bounce") + text(", g = %g", g),
                               .run = [=](Trial& t) { weak_or_strong(t, tower, g); },
                               .steps = fine,
                               .substeps = {4}});
}

}  // namespace pcphys::cases
