// C11, C12: what no physics can use is refused by name or kept to the body that has it; nobody else notices.
#include <cstring>
#include <functional>
#include <limits>

#include "parts.h"

namespace pcphys::cases {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

/// A tower of three on a floor and a pendulum: neighbours that must not notice.
void add_neighbours(scenes::Builder& builder) {
  (void)builder.world().set_gravity(down);
  add_tower(builder, 3);
  BodyDef rod;
  rod.shapes = {ShapeDef::capsule(0.05, 0.4)};
  rod.mass = 1;
  rod.pose = {{3.5, 0, 3}, axis_angle({0, 0, 1}, 1.5707963267948966)};
  const BodyId id = builder.id(builder.add(rod));
  add_pin(builder, builder.world().ground(), {3, 0, 3}, id, {0, 0.5, 0});
}
constexpr int neighbours = 5;  // with the floor

std::vector<double> state(const Simulated& run) {
  std::vector<double> out;
  for (int i = 0; i < neighbours; ++i) {
    const Pose p = run.pose(i);
    const Vec3 v = run.velocity(i), w = run.angular_velocity(i);
    for (double x : {p.position.x, p.position.y, p.position.z, p.orientation.x, p.orientation.y, p.orientation.z,
                     p.orientation.w, v.x, v.y, v.z, w.x, w.y, w.z})
      out.push_back(x);
  }
  return out;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

BodyDef plain() {
  BodyDef def;
  def.shapes = {ShapeDef::box({0.2, 0.2, 0.2})};
  def.mass = 1;
  def.pose.position = {0, 30, 30};
  return def;
}

/// Does this to a world of neighbours, and compares them after 60 steps with those of a world without.
using Deed = std::function<void(World&)>;
bool neighbours_noticed(Trial& trial, const Deed& deed) {
  std::vector<double> states[2];
  for (int with = 0; with < 2; ++with) {
    Simulated& run = trial.start([&](scenes::Builder& builder) {
      add_neighbours(builder);
      if (with) deed(builder.world());
    });
    run.allow_frozen();
    run.step(trial.dt(), 60);
    states[with] = state(run);
  }
  return !same_bits(states[0], states[1]);
}

// ---- C11 -----------------------------------------------------------------------------------------------

const std::pair<ErrorCode, std::function<void(BodyDef&)>> degenerate[] = {
    {ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(0)}; }},
    {ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(-1)}; }},
    {ErrorCode::degenerate_shape,
     [](BodyDef& d) {
       d.shapes = {ShapeDef::box({0.5, 0, 0.5})};
     }},
    {ErrorCode::degenerate_shape,
     [](BodyDef& d) {
       d.shapes = {ShapeDef::box({0.5, 0.5, 1e-9})};
     }},
    {ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::capsule(0.1, 0)}; }},
    {ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::capsule(0, 0.1)}; }},
    {ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::cylinder(0.1, 0)}; }},
    {ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(1e30)}; }},
    {ErrorCode::not_finite, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(not_a_number)}; }},
    {ErrorCode::bad_mass, [](BodyDef& d) { d.mass = 0; }},
    {ErrorCode::bad_mass, [](BodyDef& d) { d.mass = -1; }},
    {ErrorCode::not_finite, [](BodyDef& d) { d.mass = infinite; }},
    {ErrorCode::bad_mass,
     [](BodyDef& d) {
       d.moments = Vec3{0, 0, 0};
     }},
    {ErrorCode::bad_mass,
     [](BodyDef& d) {
       d.moments = Vec3{1, -1, 1};
     }},
    {ErrorCode::bad_mass,
     [](BodyDef& d) {
       d.moments = Vec3{1, 1, 3};
     }},
};

void shapes_and_masses(Trial& trial) {
  int wrong = 0;
  const bool noticed = neighbours_noticed(trial, [&](World& world) {
    for (const auto& [code, spoil] : degenerate) {
      BodyDef def = plain();
      spoil(def);
      const auto made = world.create_body(def);
      wrong += made || made.error().code != code;
    }
  });
  trial.report("of " + std::to_string(std::size(degenerate)) + ", not refused by name", wrong, 0.0);
  trial.report("neighbours that changed", noticed ? 1 : 0, 0.0);
}

/// Corners of a cube of 0.4 m.
std::vector<Vec3> cube() {
  std::vector<Vec3> points;
  for (double x : {-0.2, 0.2})
    for (double y : {-0.2, 0.2})
      for (double z : {-0.2, 0.2}) points.push_back({x, y, z});
  return points;
}

const std::pair<ErrorCode, std::vector<Vec3>> no_hulls[] = {
    {ErrorCode::degenerate_shape, {}},
    {ErrorCode::degenerate_shape, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},                          // three
    {ErrorCode::degenerate_shape, {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}}},    // in one place
    {ErrorCode::degenerate_shape, {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}},               // on a line
    {ErrorCode::degenerate_shape, {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {.5, .5, 1}}},  // in a plane
    {ErrorCode::degenerate_shape, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e-6}}},            // nearly
    {ErrorCode::degenerate_shape, {{0, 0, 0}, {1e8, 0, 0}, {0, 1e8, 0}, {0, 0, 1e8}}},         // too large
    {ErrorCode::not_finite, {{0, 0, 0}, {1, 0, 0}, {0, not_a_number, 0}, {0, 0, 1}}},
    {ErrorCode::not_finite, {{0, 0, 0}, {infinite, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
};

/// Points that make no hull are refused by name; points given twice, inside, on edges and on faces change nothing.
void hulls(Trial& trial) {
  int wrong = 0;
  for (const auto& [code, points] : no_hulls) {
    const auto made = make_hull(points);
    wrong += made || made.error().code != code;
  }
  std::vector<Vec3> crowded = cube();
  for (const Vec3& p : cube()) crowded.push_back(p), crowded.push_back(0.5 * p), crowded.push_back({p.x, p.y, 0});
  const auto plain_cube = make_hull(cube()), same_cube = make_hull(crowded);
  double moved = infinite;
  if (plain_cube && same_cube) {
    Simulated* runs[2];
    for (int k = 0; k < 2; ++k)
      runs[k] = &trial.start([&](scenes::Builder& builder) {
        add_neighbours(builder);
        BodyDef def;
        def.shapes = {ShapeDef::hull(k ? *same_cube : *plain_cube)};
        def.pose = {{0, 0, 2}, axis_angle({0.6, 0.8, 0}, 0.4)};
        builder.add(def);
      });
    for (Simulated* run : runs) run->step(trial.dt(), 120);
    moved = length(runs[0]->pose(neighbours).position - runs[1]->pose(neighbours).position);
  }
  bool none_refused = false;
  const bool noticed = neighbours_noticed(trial, [&](World& world) {
    BodyDef def = plain();
    def.shapes = {ShapeDef::hull({})};
    const auto made = world.create_body(def);
    none_refused = !made && made.error().code == ErrorCode::degenerate_shape;
  });
  trial.report("of " + std::to_string(std::size(no_hulls)) + ", not refused by name", wrong + !none_refused, 0.0);
  trial.report("with needless points, moved otherwise [m]", moved, trial.either(1e-9, 1e-4));
  trial.report("neighbours that changed", noticed ? 1 : 0, 0.0);
}

// ---- C12 -----------------------------------------------------------------------------------------------

void refused_input(Trial& trial) {
  int asked = 0, accepted = 0;
  const bool noticed = neighbours_noticed(trial, [&](World& world) {
    const BodyId id = *world.create_body(plain());
    const auto refuse = [&](const Status& status) { ++asked, accepted += bool(status); };
    const auto refuse_force = [&](const Result<ForceId>& made) { ++asked, accepted += bool(made); };
    for (double bad : {not_a_number, infinite, -infinite, 1e30, -1e30})
      for (const Vec3& v : {Vec3{bad, 0, 0}, Vec3{0, bad, 0}, Vec3{0, 0, bad}}) {
        refuse(world.set_pose(id, {v, {}}));
        refuse(world.set_velocity(id, v));
        refuse(world.set_angular_velocity(id, v));
        refuse(world.set_gravity(v));
        refuse_force(world.add_force(id, Wrench{v, {}}));
        refuse_force(world.add_force(id, Wrench{{}, v}));
      }
    for (const Quat& q : {Quat{0, 0, 0, 0}, Quat{0, 0, 0, 2}, Quat{0.1, 0, 0, 1}, Quat{0, 0, not_a_number, 1}})
      refuse(world.set_pose(id, {{0, 30, 30}, q}));
    (void)world.destroy(id);
  });
  trial.report("of " + std::to_string(asked) + " NaN, infinities, 1e30 and no rotations, accepted", accepted, 0.0);
  trial.report("neighbours that changed", noticed ? 1 : 0, 0.0);
}

/// Accepted, since each number by itself is in range; what comes of it stays with the body.
const std::function<Status(World&, BodyId)> extremes[] = {
    [](World& w, BodyId b) {
      return w.set_velocity(b, {1e-310, 1e-40, 0});
    },
    [](World& w, BodyId b) {
      return w.set_velocity(b, {0, 0, 1e15});
    },
    [](World& w, BodyId b) {
      return w.set_angular_velocity(b, {0, 1e15, 1e15});
    },
    [](World& w, BodyId b) {
      return w.set_pose(b, {{1e15, 1e15, 1e15}, {}});
    },
    [](World& w, BodyId b) {
      return w.set_mass_properties(b, {1e-30, {1e-30, 1e-30, 1e-30}});
    },
    [](World& w, BodyId b) { return w.set_drag(b, 1e15, 1e15); },
};

/// Numbers that are too much together: the body is frozen, and the step names it.
void frozen_bodies(Trial& trial) {
  int noticed = 0, bad = 0, missed = 0;
  for (const auto& extreme : extremes)
    for (bool pushed : {false, true})
      noticed += neighbours_noticed(trial, [&](World& world) {
        const BodyId id = *world.create_body(plain());
        (void)extreme(world, id);
        if (pushed) (void)world.add_force(id, Wrench{{0, 1e15, 0}, {1e15, 0, 0}});
      });
  {
    World world({trial.is_double() ? Precision::f64 : Precision::f32, down});
    BodyDef def = plain();
    def.mass = 1e-30;
    def.moments = Vec3{1e-30, 1e-30, 1e-30};
    const BodyId light = *world.create_body(def);
    (void)world.create_body(plain());
    (void)world.add_force(light, Wrench{{1e15, 0, 0}, {}});
    Stepper stepper;
    const StepReport& report = stepper.step(world, trial.dt());
    missed += !report || report.frozen != std::vector<BodyId>{light};
    for (BodyId id : world.bodies()) bad += !finite(world.pose(id)->position) || !finite(*world.velocity(id));
  }
  trial.report("neighbours that changed", noticed, 0.0);
  trial.report("offenders not frozen and named", missed, 0.0);
  trial.report("not finite", bad, 0.0);
}

void bad_steps(Trial& trial) {
  World world({trial.is_double() ? Precision::f64 : Precision::f32, down});
  scenes::Scene scene;
  const scenes::SceneOptions options;
  scenes::Builder builder(world, scene, options);
  add_neighbours(builder);
  Stepper stepper;
  for (int i = 0; i < 10; ++i) (void)stepper.step(world, trial.dt());
  const std::vector<std::byte> before = world.snapshot();
  int made = 0, changed = 0;
  for (double dt : {0.0, -0.0, -1.0 / 60, not_a_number, infinite, 1e-310, 1e30}) {
    made += bool(stepper.step(world, dt));
    changed += world.snapshot() != before;
  }
  trial.report("steps of dt = 0, < 0, NaN or out of range that were made", made, 0.0);
  trial.report("states that changed by a bit", changed, 0.0);
}

}  // namespace

void add_bad_input(std::vector<Case>& cases) {
  const std::vector<double> frame{1.0 / 60};
  cases.push_back({"C11",
                   "degenerate shapes and masses",
                   {{.name = "shapes and masses", .run = shapes_and_masses, .steps = frame, .substeps = {4}},
                    {.name = "hulls", .run = hulls, .steps = frame, .substeps = {4}}}});
  cases.push_back({"C12",
                   "numbers that no physics can use",
                   {{.name = "refused", .run = refused_input, .steps = frame, .substeps = {4}},
                    {.name = "frozen", .run = frozen_bodies, .steps = frame, .substeps = {4}},
                    {.name = "steps", .run = bad_steps, .steps = frame, .substeps = {4}}}});
}

}  // namespace pcphys::cases
