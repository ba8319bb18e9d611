// What a step does not pay for: kinds of scene with all on and with something left out, taking turns;
// and what planning costs.
//   leaving_out/KIND                 median step of both [ms], its contacts, kernel runs of a step,
//                                    memory of its buffers; docs/leaving-out.md
//   planning/unchanged/SCENE         the timer `plan` where nothing has changed
//   planning/joint/SCENE             lists, pairs and plan of a step after a joint was added, beyond an ordinary one's
//   planning/nothing                 a step of a world in which nothing moves
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "pcphys/step.h"
#include "pcphys/write_kernel.h"
#include "scenes/scene.h"

namespace {

using namespace pcphys;

constexpr double dt = 1.0 / 60;

PCPHYS_KERNEL(count_steps, (PC_INOUT(uint) steps), { steps = steps + 1u; })

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// A scene with something changed in it.
struct Run {
  World world{{Precision::f32}};
  Stepper stepper;
  scenes::Scene scene;
  Error error;
  std::vector<double> ms, contacts;  // of each step

  void make(const char* name, int count) {
    scenes::SceneOptions options;
    options.count = count;
    auto made = scenes::make(name, options, world);
    made ? void(scene = std::move(*made)) : void(error = made.error());
  }
  void check(const Status& status) {
    if (!status && error.code == ErrorCode::none) error = status.error();
  }
  void step() {
    if (error.code != ErrorCode::none) return;
    const auto begin = std::chrono::steady_clock::now();
    const StepReport& report = stepper.step(world, dt);
    ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    contacts.push_back(report.contacts);
    error = report.error;
  }
  template <class Do> void each_dynamic(Do&& change) {
    for (const scenes::SceneBody& body : scene.bodies)
      if (body.kind == BodyKind::dynamic) check(change(body.id));
  }
  void materials(const Material& material) {
    for (const scenes::SceneBody& body : scene.bodies) check(world.set_material(body.id, material));
  }
  void drag() {
    each_dynamic([&](BodyId id) { return world.set_drag(id, 0.1, 0.1); });
  }
  void filters(Filter filter) {
    each_dynamic([&](BodyId id) { return world.set_filter(id, filter); });
  }
  void unequal_moments() {
    each_dynamic([&](BodyId id) {
      MassProperties mass = *world.mass_properties(id);
      mass.moments.x *= 0.99;
      return world.set_mass_properties(id, mass);
    });
  }
  /// All joints anew.
  template <class Change> void joints(Change&& change) {
    for (JointId& id : scene.joints) {
      JointDef def = *world.joint(id);
      check(world.destroy(id));
      change(def);
      const auto made = world.create_joint(def);
      made ? void(id = *made) : check(made.error());
    }
  }
  /// All bodies anew, spheres and boxes of one shape.
  template <class Change> void bodies(Change&& change) {
    for (scenes::SceneBody& body : scene.bodies) {
      BodyDef def;
      def.kind = *world.kind(body.id);
      def.shapes = *world.shapes(body.id);
      def.pose = *world.pose(body.id);
      if (def.kind == BodyKind::dynamic) def.mass = world.mass_properties(body.id)->mass;
      if (def.kind == BodyKind::dynamic) def.velocity = *world.velocity(body.id);
      def.material = *world.material(body.id);
      check(world.destroy(body.id));
      change(def);
      const auto made = world.create_body(def);
      made ? void(body.id = *made) : check(made.error());
    }
  }
  void fix() {
    bodies([](BodyDef& def) {
      def.kind = BodyKind::fixed;
      def.velocity = {};
    });
  }
  void still() {
    bodies([](BodyDef& def) { def.rotates = false; });
  }
  void pendulum() {
    BodyDef def;
    def.shapes = {ShapeDef::sphere(0.1)};
    def.shapes[0].filter.mask = 0;
    def.pose.position = {-10, 0, 0};
    const auto bob = world.create_body(def);
    if (!bob) return check(bob.error());
    JointDef pin;
    pin.a = world.ground();
    pin.b = *bob;
    pin.frame_a.position = {-10, 1, 0};
    pin.frame_b.position = {0, 1, 0};
    const auto made = world.create_joint(pin);
    if (!made) check(made.error());
  }
  /// Far away one ball lies on a floor with friction: rows of all contacts are whole,
  /// and the heap moves by the same bits.
  void rough_ball() {
    for (const bool floor : {true, false}) {
      BodyDef def;
      if (floor) def.kind = BodyKind::fixed;
      def.shapes = {floor ? ShapeDef::box({1, 0.5, 1}) : ShapeDef::sphere(0.15)};
      def.pose.position = {1000, floor ? -0.5 : 0.15, 0};
      def.material = {0.5, 0.5, 0};
      if (const auto made = world.create_body(def); !made) check(made.error());
    }
  }
  void own_kernel(bool once) {
    const auto added = world.add_property<std::uint32_t>("steps", 0, "1");
    if (!added) return check(added.error());
    check(stepper.add_kernel(world, {.text = count_steps::text(), .once_a_step = once}));
  }
  std::size_t kernels() const {
    return std::size_t(std::ranges::count(stepper.plan().entries, PlanEntry::Kind::kernel, &PlanEntry::kind));
  }
  double memory() const {
    double sum = 0;
    for (const BufferUse& use : stepper.memory(world)) sum += double(use.bytes);
    return sum;
  }
};

struct Kind {
  const char* name;
  std::function<void(Run&)> all_on, left_out;
};

const std::vector<Kind>& kinds() {
  constexpr int many = 10'000, some = 1'000;
  static const std::vector<Kind> list = {
      {"balls, all on; frictionless, e = 0, no drag",
       [](Run& r) {
         r.make("balls", some), r.materials({0.5, 0.5, 0.5, 0.01, 0.01}), r.drag();
       },
       [](Run& r) {
         r.make("balls", some), r.materials({0, 0, 0});
       }},
      {"balls, friction; none",
       [](Run& r) {
         r.make("balls", some), r.materials({0.5, 0.5, 0});
       },
       [](Run& r) {
         r.make("balls", some), r.materials({0, 0, 0});
       }},
      {"balls without friction, and a rough one far away; alone",
       [](Run& r) {
         r.make("balls", some), r.materials({0, 0, 0}), r.rough_ball();
       },
       [](Run& r) {
         r.make("balls", some), r.materials({0, 0, 0});
       }},
      {"balls without friction, rotating; not",
       [](Run& r) {
         r.make("balls", some), r.materials({0, 0, 0});
       },
       [](Run& r) {
         r.make("balls", some), r.materials({0, 0, 0}), r.still();
       }},
      {"balls, e = 0.5; e = 0",
       [](Run& r) {
         r.make("balls", some), r.materials({0.5, 0.5, 0.5});
       },
       [](Run& r) {
         r.make("balls", some), r.materials({0.5, 0.5, 0});
       }},
      {"balls, rolling friction; none",
       [](Run& r) {
         r.make("balls", some), r.materials({0.5, 0.5, 0, 0.01, 0.01});
       },
       [](Run& r) {
         r.make("balls", some), r.materials({0.5, 0.5, 0});
       }},
      {"balls, unequal moments; equal",
       [](Run& r) {
         r.make("balls", some), r.materials({0.5, 0.5, 0}), r.unequal_moments();
       },
       [](Run& r) {
         r.make("balls", some), r.materials({0.5, 0.5, 0});
       }},
      {"ragdolls, limits; pins alone", [](Run& r) { r.make("ragdolls", 40); },
       [](Run& r) { r.make("ragdolls", 40), r.joints([](JointDef& def) { def.freedom = {}; }); }},
      {"ragdolls, springs in the joints; none",
       [](Run& r) { r.make("ragdolls", 40), r.joints([](JointDef& def) {
                      def.spring = {5, 0.5, {}};
                    }); },
       [](Run& r) { r.make("ragdolls", 40); }},
      {"chain, springs in the joints; none",
       [](Run& r) { r.make("chain", 200), r.joints([](JointDef& def) {
                      def.spring = {5, 0.5, {}};
                    }); },
       [](Run& r) { r.make("chain", 200); }},
      {"ballistic, drag; none", [](Run& r) { r.make("ballistic", many), r.drag(); },
       [](Run& r) { r.make("ballistic", many); }},
      {"ballistic, unequal moments; equal", [](Run& r) { r.make("ballistic", many), r.unequal_moments(); },
       [](Run& r) { r.make("ballistic", many); }},
      {"ballistic, rotating; not", [](Run& r) { r.make("ballistic", many); },
       [](Run& r) {
         r.make("ballistic", many);
         r.still();
       }},
      {"ballistic, meets others; filtered", [](Run& r) { r.make("ballistic", many), r.filters({}); },
       [](Run& r) { r.make("ballistic", many); }},
      {"ballistic, a pendulum beside; alone", [](Run& r) { r.make("ballistic", many), r.pendulum(); },
       [](Run& r) { r.make("ballistic", many); }},
      {"ballistic, own kernel each sub-step; once a step",
       [](Run& r) { r.make("ballistic", many), r.own_kernel(false); },
       [](Run& r) { r.make("ballistic", many), r.own_kernel(true); }},
      {"pyramid, dynamic; static", [](Run& r) { r.make("pyramid", 30); },
       [](Run& r) {
         r.make("pyramid", 30);
         r.fix();
       }}};
  return list;
}

void leave_out(benchmark::State& state, const Kind& kind) {
  constexpr int before = 60, timed = 120;
  Run on, out;
  kind.all_on(on);
  kind.left_out(out);
  for (auto _ : state) {
    for (int i = 0; i < before + timed; i++) {
      if (i == before)
        for (Run* run : {&on, &out}) run->ms.clear(), run->contacts.clear();
      on.step();
      out.step();
    }
    state.SetIterationTime(median(out.ms) / 1000);
  }
  for (const Run* run : {&on, &out})
    if (run->error.code != ErrorCode::none) return state.SkipWithError(run->error.message.c_str());
  state.counters["on_ms"] = median(on.ms);
  state.counters["out_ms"] = median(out.ms);
  state.counters["on_contacts"] = median(on.contacts);
  state.counters["out_contacts"] = median(out.contacts);
  state.counters["on_kernels"] = double(on.kernels());
  state.counters["out_kernels"] = double(out.kernels());
  state.counters["on_bytes"] = on.memory();
  state.counters["out_bytes"] = out.memory();
  state.counters["bodies"] = double(out.world.body_count());
}

void unchanged(benchmark::State& state, const char* scene, int count) {
  Run run;
  run.make(scene, count);
  std::vector<double> plan;
  for (auto _ : state) {
    for (int i = 0; i < 200 && run.error.code == ErrorCode::none; i++) {
      const StepReport& report = run.stepper.step(run.world, dt);
      run.error = report.error;
      if (i >= 20) plan.push_back(report.ms[std::size_t(Timer::plan)]);
    }
    state.SetIterationTime(median(plan) / 1000);
  }
  state.counters["plan_us"] = 1000 * median(plan);
}

/// Of a step: what follows a change of objects or contacts, boxes and pairs included.
double planned(const StepReport& report) {
  return report.ms[std::size_t(Timer::forces)] + report.ms[std::size_t(Timer::broad)] +
         report.ms[std::size_t(Timer::plan)];
}

void add_joint(benchmark::State& state, const char* scene, int count) {
  Run run;
  run.make(scene, count);
  for (int i = 0; i < 10; i++) run.step();
  std::vector<double> added, ordinary;
  for (auto _ : state) {
    for (std::size_t k = 0; k < 15 && run.error.code == ErrorCode::none; k++) {
      JointDef def;
      def.a = run.world.ground();
      def.b = run.scene.bodies[run.scene.bodies.size() - 1 - k].id;
      def.frame_a.position = run.world.pose(def.b)->position;
      if (const auto made = run.world.create_joint(def); !made) run.check(made.error());
      for (int i = 0; i < 4; i++) {
        const StepReport& report = run.stepper.step(run.world, dt);
        run.error = report.error;
        (i == 0 ? added : ordinary).push_back(planned(report));
      }
    }
    state.SetIterationTime(std::max(0.0, median(added) - median(ordinary)) / 1000);
    state.counters["step_ms"] = median(ordinary);
    state.counters["replan_ms"] = median(added) - median(ordinary);
    state.counters["least_ms"] = *std::ranges::min_element(added) - *std::ranges::min_element(ordinary);
  }
  if (run.error.code != ErrorCode::none) state.SkipWithError(run.error.message.c_str());
}

void nothing(benchmark::State& state) {
  World world({Precision::f32});
  BodyDef def;
  def.kind = BodyKind::fixed;
  def.shapes = {ShapeDef::sphere(1)};
  (void)world.create_body(def);
  StepSettings settings;
  settings.timings = false;
  Stepper stepper(settings);
  for (auto _ : state) (void)stepper.step(world, dt);
}

const bool registered = [] {
  for (const Kind& kind : kinds())
    benchmark::RegisterBenchmark((std::string("leaving_out/") + kind.name).c_str(),
                                 [&kind](benchmark::State& s) { leave_out(s, kind); })
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  struct Case {
    const char* scene;
    int count;
  };
  for (const Case& c :
       {Case{"ballistic", 10'000}, {"balls", 10'000}, {"ragdolls", 833}, {"pyramid", 40}, {"chain", 1'000}})
    benchmark::RegisterBenchmark((std::string("planning/unchanged/") + c.scene).c_str(), unchanged, c.scene, c.count)
        ->UseManualTime()
        ->Iterations(1);
  for (const Case& c : {Case{"ballistic", 10'000}, {"balls", 10'000}, {"ragdolls", 833}})
    benchmark::RegisterBenchmark((std::string("planning/joint/") + c.scene).c_str(), add_joint, c.scene, c.count)
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("planning/nothing", nothing);
  return true;
}();

}  // namespace
