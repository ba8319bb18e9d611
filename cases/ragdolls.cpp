// B10: a ragdoll that is pulled, dragged and spun harder than any game would.
#include <algorithm>
#include <numbers>

#include "parts.h"
#include "scenes/metrics.h"

namespace pcphys::cases {
namespace {

constexpr double weight = 70;  // [kg]

/// A hand or a foot, beyond a limb's end: a capsule along `along`.
BoneDef end_bone(int limb, Vec3 joint, Vec3 centre, Vec3 along) {
  BoneDef bone;
  bone.parent = limb;
  bone.shape = ShapeDef::capsule(0.035, 0.05);
  const Vec3 y{0, 1, 0}, axis = cross(y, along);
  bone.pose = {centre, length(axis) > 0 ? axis_angle(axis, 0.5 * std::numbers::pi) : Quat{}};
  bone.joint = joint;
  const Vec3 x{1, 0, 0}, turn = cross(x, along);
  bone.joint_axes = length(turn) > 0    ? axis_angle(turn, 0.5 * std::numbers::pi)
                    : dot(x, along) < 0 ? axis_angle(y, std::numbers::pi)
                                        : Quat{};
  bone.freedom = AngleFreedom::cone_and_twist(0.8, 0.3);
  return bone;
}

/// The human of the library with hands and feet, 16 bones, scaled to 70 kg; it stands along y.
RagdollDef human() {
  RagdollDef def = free_human();
  constexpr int forearm = 6, shin = 10;  // the left ones; the right ones follow
  for (int side : {0, 1}) {
    const double sign = side == 0 ? 1 : -1;
    def.bones.push_back(end_bone(forearm + side, {sign * 0.84, 1.48, 0}, {sign * 0.925, 1.48, 0}, {sign, 0, 0}));
    def.bones.push_back(end_bone(shin + side, {sign * 0.11, 0, 0.02}, {sign * 0.11, -0.035, 0.085}, {0, 0, 1}));
  }
  double mass = 0;
  for (const BoneDef& bone : def.bones) mass += mass_properties(bone.shape, def.density)->mass;
  def.density *= weight / mass;
  return def;
}

/// The bone that reaches furthest along x: a hand.
int hand(const Simulated& run) {
  int furthest = 0;
  for (int i = 0; i < run.bodies(); ++i)
    if (run.moves(i) && run.pose(i).position.x > run.pose(furthest).position.x) furthest = i;
  return furthest;
}

/// Lengths of the shortest bone: what gaps are judged by.
double shortest_bone(const Simulated& run) {
  double shortest = 1e9;
  for (const scenes::SceneBody& body : run.problem().scene.bodies)
    if (body.kind == BodyKind::dynamic) shortest = std::min(shortest, 2 * (body.shape.size.x + body.shape.size.y));
  return shortest;
}

double beyond_limits(const Simulated& run) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < run.problem().scene.bodies.size(); i++) poses.push_back(run.pose(int(i)));
  return scenes::limit_excess(run.problem().scene, run.problem().world, poses).any * 180 / std::numbers::pi;
}

struct Watch {
  Worst gap, limit;
  void look(const Simulated& run) {
    gap.add(joint_gap(run));
    limit.add(beyond_limits(run));
  }
};

/// Of all bodies, but for what they have as one at their centre of mass [J].
double inner_energy(const Simulated& run) {
  double mass = 0;
  Vec3 momentum;
  for (int i = 0; i < run.bodies(); ++i)
    mass += run.mass(i).mass, momentum = momentum + run.mass(i).mass * run.velocity(i);
  return energy(run) - 0.5 * dot(momentum, momentum) / mass;
}

void pull(Trial& trial, double force, std::optional<double> gap_must, std::optional<double> limit_must) {
  Simulated& run = trial.start([](scenes::Builder& builder) { builder.add_ragdoll(human(), {}, {}, 1); });
  const double bone = shortest_bone(run);
  const int pulled = hand(run);
  Watch during;
  run.set_wrench(pulled, {{force, 0, 0}, {}});
  for (long k = 0; k < trial.steps(1); ++k) {
    run.step(trial.dt());
    during.look(run);
  }
  run.set_wrench(pulled, {});
  const double released = energy(run), inner = inner_energy(run);
  Worst gain, gain_within;
  for (long k = 0; k < trial.steps(1); ++k) {
    run.step(trial.dt());
    gain.add(energy(run) / released - 1);
    gain_within.add(inner_energy(run) / inner - 1);
  }
  trial.report("joint gap / shortest bone", during.gap / bone, gap_must);
  trial.report("beyond limits [deg]", during.limit, limit_must);
  trial.report("joint gap / shortest bone, 1 s after", joint_gap(run) / bone, 1e-3);
  trial.report("beyond limits [deg], 1 s after", beyond_limits(run), 5);
  trial.report("energy gained after the release, relative", gain, 1e-3);
  trial.report("... without that of the centre of mass", gain_within);
  trial.report("not finite", nonfinite(run), 0.0);
}

/// A kinematic hand goes between two walls that stand 0.1 m apart, and stops behind them. What it holds by a plain pin
/// comes along whatever it takes; what it `grabs` (as World::grab does) it pulls by 100 times its weight at most.
void drag(Trial& trial, double speed, bool grabs) {
  int mover = 0;
  Simulated& run = trial.start([&](scenes::Builder& builder) {
    builder.add_ragdoll(human(), {}, {}, 1);
    double x = -1e9;
    int pulled = 0;
    for (int i = 0; i < int(builder.scene().bodies.size()); ++i) {
      const Vec3 p = builder.scene().bodies[std::size_t(i)].start.position;
      if (p.x > x) x = p.x, pulled = i;
    }
    const Vec3 at = builder.scene().bodies[std::size_t(pulled)].start.position;
    BodyDef def;
    def.kind = BodyKind::kinematic;
    def.shapes = {ShapeDef::sphere(0.02)};
    def.pose.position = at;
    def.velocity = {speed, 0, 0};
    mover = builder.add(without_contacts(def));
    add_pin(builder, builder.id(mover), {}, builder.id(pulled), {},
            grabs ? 100 * 9.81 * weight : JointDef().largest_force);
    for (double side : {-1.0, 1.0}) builder.add_fixed_box({at.x + 2, at.y, at.z + side * (0.05 + 1)}, {0.2, 3, 1});
  });
  const double bone = shortest_bone(run);
  Watch watch;
  for (long k = 0; k < trial.steps(5 / speed + 0.5); ++k) {
    run.step(trial.dt());
    watch.look(run);
  }
  run.set_velocity(mover, {}, {});
  const double stopped = energy(run);
  Worst gain;
  for (long k = 0; k < trial.steps(1); ++k) {
    run.step(trial.dt());
    gain.add(energy(run) / stopped - 1);
  }
  trial.report("not finite", nonfinite(run), 0.0);
  trial.report("joint gap / shortest bone", watch.gap / bone, grabs ? std::optional(0.1) : std::nullopt);
  trial.report("beyond limits [deg]", watch.limit);
  trial.report("joint gap / shortest bone, 1 s after", joint_gap(run) / bone, 1e-3);
  trial.report("beyond limits [deg], 1 s after", beyond_limits(run), 5);
  trial.report("energy gained after the hand stopped, relative", gain, 1e-3);
}

void spin(Trial& trial) {
  Simulated& run = trial.start([](scenes::Builder& builder) { builder.add_ragdoll(human(), {}, {}, 1); });
  run.set_velocity(0, {}, {0, 100, 0});
  const double bone = shortest_bone(run), start = energy(run);
  const Vec3 before = angular_momentum(run);
  Watch watch;
  Worst gain, turn;
  for (long k = 0; k < trial.steps(2); ++k) {
    run.step(trial.dt());
    watch.look(run);
    gain.add(energy(run) / start - 1);
    turn.add(length(angular_momentum(run) - before) / length(before));
  }
  trial.report("not finite", nonfinite(run), 0.0);
  trial.report("energy gained, relative", gain, 1e-2);
  trial.report("joint gap / shortest bone", watch.gap / bone);
  trial.report("beyond limits [deg]", watch.limit);
  trial.report("angular momentum, relative", turn);
}

}  // namespace

void add_ragdolls(std::vector<Case>& cases) {
  const auto variant = [](std::string name, std::function<void(Trial&)> run, std::optional<double> lost_at = {}) {
    return Variant{.name = std::move(name),
                   .run = std::move(run),
                   .steps = {1.0 / 60, 1.0 / 240},
                   .substeps = {4},
                   .more_steps = {1.0 / 30},
                   .more_substeps = {1, 2},
                   .lost_at = lost_at};
  };
  // other engines have no joint that gives way
  const auto grabbed = [&](std::string name, double speed) {
    Variant of_pcphys = variant(std::move(name), [speed](Trial& t) { drag(t, speed, true); });
    of_pcphys.own = true;
    return of_pcphys;
  };
  cases.push_back(
      {"B10",
       "a ragdoll of 16 bones and 70 kg is pulled by a hand, dragged and spun",
       {variant(
            "1e3 N", [](Trial& t) { pull(t, 1e3, 0.02, 5); }, 1),
        variant(
            "1e4 N", [](Trial& t) { pull(t, 1e4, 0.1, 5); }, 1),
        variant(
            "1e5 N", [](Trial& t) { pull(t, 1e5, {}, {}); }, 1),
        variant("dragged at 10 m/s", [](Trial& t) { drag(t, 10, false); }), grabbed("grabbed at 10 m/s", 10),
        variant("dragged at 50 m/s", [](Trial& t) { drag(t, 50, false); }), grabbed("grabbed at 50 m/s", 50),
        variant("root at 100 rad/s", spin)}});
}

}  // namespace pcphys::cases
