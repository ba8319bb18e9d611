// A7, A8: what turns about pins, solved directly. Bounds are twice the errors of converged SHAKE.
#include <numbers>

#include "case.h"
#include "measures.h"

namespace pcphys::cases {
namespace {

/// A rod of 1 m and 1 kg whose axis, body z, leans by `angle` from straight down towards x; its centre at `centre`.
BodyDef rod(double angle, Vec3 centre) {
  BodyDef def;
  def.shapes = {ShapeDef::box({0.05, 0.05, 0.5})};
  def.mass = 1;
  def.pose = {centre, exponential({0, -angle, 0})};
  return without_contacts(def);
}

void pin(scenes::Builder& builder, BodyId a, Vec3 at_a, int b, Vec3 at_b) {
  JointDef def;
  def.a = a;
  def.b = builder.id(b);
  def.frame_a.position = at_a;
  def.frame_b.position = at_b;
  builder.add_joint(def);
}

// ---- A7 ------------------------------------------------------------------------------------------------

void pendulum(Trial& trial, double angle, const Csv& reference, const Bounds& shake) {
  Simulated& run = trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    const int body = builder.add(rod(angle, 0.5 * Vec3{std::sin(angle), 0, -std::cos(angle)}));
    pin(builder, builder.world().ground(), {}, body, {0, 0, 0.5});
  });
  Worst position, gap;
  walk(run, trial.dt(), reference, 10, [&](std::size_t row, double) {
    position.add(length(run.pose(0).position - Vec3{reference.at(row, "px"), 0, reference.at(row, "pz")}));
    gap.add(joint_gap(run));
  });
  trial.report("position [m]", position, trial.at({2 * shake[0], 2 * shake[1], 2 * shake[2], 2 * shake[3]}), trial.at(shake));
  trial.report("joint gap [m]", gap, trial.either(1e-12, 2e-6));
}

// ---- A8 ------------------------------------------------------------------------------------------------

void double_pendulum(Trial& trial) {
  static const Csv reference = read_csv("A08_double_pendulum.csv");
  Simulated& run = trial.start([](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    const double level = 0.5 * std::numbers::pi;
    const int first = builder.add(rod(level, {0.5, 0, 0})), second = builder.add(rod(level, {1.5, 0, 0}));
    pin(builder, builder.world().ground(), {}, first, {0, 0, 0.5});
    pin(builder, builder.id(first), {0, 0, -0.5}, second, {0, 0, 0.5});
  });
  Worst early, all;
  walk(run, trial.dt(), reference, 4, [&](std::size_t row, double t) {
    for (int i = 0; i < 2; ++i) {
      const char* const x[] = {"x1", "x2"};
      const char* const z[] = {"z1", "z2"};
      const double error = length(run.pose(i).position - Vec3{reference.at(row, x[i]), 0, reference.at(row, z[i])});
      if (t <= 2 + 1e-9) early.add(error);
      all.add(error);
    }
  });
  trial.report("position until 2 s [m]", early, trial.at({1.5e-2, 9.1e-4, 3.6e-5, 5.2e-7}));
  trial.report("position until 4 s [m]", all, trial.at({1e-1, 6e-3, 2.4e-4, 3.5e-6}));
}

}  // namespace

void add_pendulums(std::vector<Case>& cases) {
  Case& compound = cases.emplace_back(Case{"A7", "compound pendulum", {}});
  struct Amplitude {
    const char *name, *file;
    double degrees;
    Bounds shake;
  };
  for (const Amplitude& a : {Amplitude{"10 deg", "A07_pendulum_10.csv", 10, {5.5e-4, 3.5e-5, 1.4e-6, 2.0e-8}},
                             Amplitude{"90 deg", "A07_pendulum_90.csv", 90, {1.2e-2, 7.3e-4, 2.9e-5, 4.2e-7}},
                             Amplitude{"170 deg", "A07_pendulum_170.csv", 170, {1.2e-2, 7.7e-4, 3.1e-5, 4.6e-7}}})
    compound.variants.push_back({.name = a.name,
                                 .run = [a, reference = read_csv(a.file)](
                                            Trial& t) { pendulum(t, a.degrees * std::numbers::pi / 180, reference, a.shake); },
                                 .second_order = true});
  cases.push_back({"A8", "double compound pendulum", {{.name = "from level", .run = double_pendulum, .second_order = true}}});
}

}  // namespace pcphys::cases
