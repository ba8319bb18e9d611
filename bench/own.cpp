// Kernels of the host's own over pairs, over joints with their bodies, and totals:
//   own/all_pairs/PLACE/PRECISION/BODIES   magnets, each on each: interactions/s, and arithmetic operations/s (a
//                                          division and a root count as one). With PCPHYS_PEAK_GFLOPS, the device's
//                                          figure in that precision as its maker gives it (two operations a fused
//                                          multiply-add, of which pcphys makes none: half of it is the limit),
//                                          `of_limit` is the share that was reached.
//   own/near/PLACE/PRECISION/BODIES        the same within a cut-off at one density (about 30 neighbours), lists made
//                                          anew in each step: `ns_per_nlogn` is level where the time grows as
//                                          n log n; `lists_ms` is theirs alone.
//   own/joined/PLACE/PRECISION/BODIES      cords, one from each body to the next
//   own/total/PLACE/PRECISION/BODIES       the sum of a number of each body
// One sub-step a step; the time is that of the stage in which the kernel runs, until the device is done; of `near` that
// of the step.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>

#include "examples/magnet.h"
#include "pcphys/pcphys.h"
#include "pcphys/write_kernel.h"

namespace {

using namespace pcphys;

constexpr double dt = 1e-6;  // bodies stay where they are
constexpr double cutoff = 2;
constexpr int operations = 20;  // of a pair of magnets: 9 products, 9 sums and differences, a division and a root

PCPHYS_KERNEL(sum_mass, (PC_IN(Real) mass, PC_SUM(Real) total), { total = mass; })

struct Variant {
  const char* place_name;
  Place place;
  const char* precision_name;
  Precision precision;
};
PCPHYS_KERNEL(cord,
              (PC_A(Vec3) position_a, PC_B(Vec3) position_b, PC_IN(Real) rest_length, PC_ADD_A(Vec3) force_a,
               PC_ADD_B(Vec3) force_b, PC_PARAM(Real) stiffness),
              {
                Vec3 way = pc_sub(position_b, position_a);
                Real size = pc_length(way);
                Real pull = stiffness * pc_max(size - rest_length, PC_REAL(0.0));
                force_a = pc_scale(way, pull * pc_inverse_or_zero(size));
                force_b = pc_negate(force_a);
              })

enum class What { all_pairs, near, joined, total };

Result<World> magnets(Precision precision, int count) {
  World world(WorldDef{precision, {}});
  const auto pole = world.add_property<Real>("pole", 1, "A m", body_table, Role::input);
  const TableId one = *world.add_table("one", 1);
  (void)world.add_property<Real>("total", 0, "kg", one);
  BodyDef def;
  def.shapes = {ShapeDef::sphere(0.01)};
  def.shapes[0].filter.mask = 0;
  def.mass = 1;
  const int side = int(std::ceil(std::cbrt(count)));
  for (int i = 0; i < count; i++) {
    def.pose.position = {i % side + 0.3 * std::sin(i), i / side % side + 0.3 * std::sin(2.0 * i),
                         i / side / side + 0.3 * std::cos(i)};
    const auto body = world.create_body(def);
    if (!body) return body.error();
    if (Status ok = world.set(*pole, *body, Real(1 + i % 3)); !ok) return ok.error();
  }
  return world;
}

Status add(Stepper& stepper, World& world, What what) {
  if (what == What::joined) {
    SpringDef ends;  // without stiffness: it holds nothing
    const std::vector<BodyId> bodies = world.bodies();
    for (std::size_t i = 1; i < bodies.size(); i++) {
      ends.a = bodies[i - 1];
      ends.b = bodies[i];
      if (const auto made = world.create_spring(ends); !made) return made.error();
    }
    return stepper.add_kernel(world, {.text = cord::text(), .over = joint_table, .parameters = {{"stiffness", 1e-3}}});
  }
  if (what == What::total) return stepper.add_kernel(world, {.text = sum_mass::text()});
  KernelDef def{.text = magnet::text(), .parameters = {{"strength", 1e-3}, {"softening", 0.01}}};
  if (what == What::near) def.cutoff = cutoff;
  return stepper.add_kernel(world, def);
}

void tell(benchmark::State& state, What what, double pairs) {
  using benchmark::Counter;
  const double n = double(state.range(0));
  const auto rate = [](double of) { return Counter(of, Counter::kIsIterationInvariantRate); };
  if (what == What::total || what == What::joined) state.counters["rows/s"] = rate(n);
  if (what != What::all_pairs) return;
  state.counters["interactions/s"] = rate(pairs);
  state.counters["operations/s"] = rate(pairs * operations);
  const char* peak = std::getenv("PCPHYS_PEAK_GFLOPS");
  if (peak && std::atof(peak) > 0) state.counters["of_limit"] = rate(pairs * operations / (std::atof(peak) * 1e9 / 2));
}

void run(benchmark::State& state, What what, Variant variant) {
  const int count = int(state.range(0));
  auto world = magnets(variant.precision, count);
  if (!world) return state.SkipWithError(world.error().message.c_str());
  StepSettings settings;
  settings.set_all(variant.place);
  settings.substeps = 1;
  Stepper stepper(settings);
  if (Status ok = add(stepper, *world, what); !ok) return state.SkipWithError(ok.error().message.c_str());
  const std::string device = stepper.device(variant.place);
  if (what == What::all_pairs && count > 10'000 &&
      (variant.place == Place::cpu || device.find("llvmpipe") != device.npos))
    return state.SkipWithError("left out: minutes on a processor");
  // a GPU that was idle takes a while to reach its clock
  const auto start = std::chrono::steady_clock::now();
  do {
    if (const StepReport& made = stepper.step(*world, dt); !made)
      return state.SkipWithError(made.error.message.c_str());
  } while (variant.place == Place::gl && std::chrono::steady_clock::now() - start < std::chrono::milliseconds(300));
  double near_ms = 0, lists_ms = 0;
  const BodyId far = world->bodies().back();
  const Vec3 there = world->pose(far)->position;
  int steps = 0;
  for (auto _ : state) {
    // a body that was placed elsewhere has the lists made anew
    Pose pose;
    pose.position = there + Vec3{0, 0, steps++ % 2 ? 0.0 : cutoff};
    if (what == What::near) (void)world->set_pose(far, pose);
    const StepReport& made = stepper.step(*world, dt);
    if (!made) return state.SkipWithError(made.error.message.c_str());
    const double stage = made.ms[std::size_t(Timer::integrate)];
    state.SetIterationTime((what == What::near ? made.total_ms : stage) / 1000);
    near_ms += made.total_ms;
    lists_ms += made.ms[std::size_t(Timer::plan)];
  }
  state.SetLabel(device);
  tell(state, what, double(count) * (count - 1.0));
  if (what != What::near || steps == 0) return;
  state.counters["lists_ms"] = lists_ms / steps;
  state.counters["ns_per_nlogn"] = 1e6 * near_ms / steps / (count * std::log2(count));
}

const bool registered = [] {
  constexpr Variant variants[] = {{"cpu", Place::cpu, "float", Precision::f32},
                                  {"cpu", Place::cpu, "double", Precision::f64},
                                  {"gl", Place::gl, "float", Precision::f32},
                                  {"gl", Place::gl, "double", Precision::f64}};
  constexpr struct {
    const char* name;
    What what;
  } kinds[] = {{"all_pairs", What::all_pairs}, {"near", What::near}, {"joined", What::joined}, {"total", What::total}};
  for (const auto& kind : kinds)
    for (const Variant& v : variants) {
      const std::string name = std::string("own/") + kind.name + "/" + v.place_name + "/" + v.precision_name;
      auto* made = benchmark::RegisterBenchmark(name.c_str(), run, kind.what, v);
      for (const int count : {1000, 3000, 10'000, 30'000, 100'000}) made->Arg(count);
      made->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(kind.what == What::all_pairs ? 5 : 20);
    }
  return true;
}();

}  // namespace
