// Each stage of a step alone, and each kernel alone, per place, lanes and precision, over 100 to 100,000 bodies:
//   stage/NAME/VARIANT/BODIES      broad, broad_moved, narrow, plan, integrate, joints, impulses, upload, download
//   kernel/NAME/VARIANT/BODIES     one pass of one kernel
// Balls after a second of falling; for joints, ragdolls. `per_element` is the time for a body, contact or joint.
// On GL the time ends when the device is done.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "collision/detector.h"
#include "pcphys/step.h"
#include "plan/infos.h"
#include "plan/plan.h"
#include "scenes/scene.h"
#include "step/processor_state.h"
#include "step/runner.h"
#include "step/schedule.h"

namespace {

using namespace pcphys;

constexpr double dt = 1.0 / 60;
constexpr int settling_steps = 60;
constexpr int bones = 12;

struct Variant {
  const char* name;
  Place place;
  std::uint32_t lanes;
  Precision precision;
};

/// A world in the middle of a run, with everything that a step makes laid out, so that any part of it can be
/// run again and again.
class Bench {
 public:
  Status prepare(const char* scene_name, int bodies, const Variant& variant) {
    world_ = World({variant.precision});
    scenes::SceneOptions options;
    options.count = std::string(scene_name) == "ragdolls" ? std::max(1, bodies / bones) : bodies;
    if (auto scene = scenes::make(scene_name, options, world_); !scene) return scene.error();
    if (auto status = settle(std::string(scene_name) + std::to_string(bodies) + std::to_string(int(variant.precision)));
        !status)
      return status;

    settings_.set_all(variant.place);
    settings_.lanes = variant.lanes;
    settings_.timings = false;
    options_ = {settings_.narrow, settings_.contact_margin, settings_.restitution_threshold, settings_.max_pairs};
    schedule_.update_structure(state());
    for (Status status : {broad(), narrow()})
      if (!status) return status;
    schedule_.update_contacts(state());
    PlanSignature wanted;
    wanted.substeps = settings_.substeps;
    wanted.places.fill(variant.place);
    wanted.bodies = true;
    wanted.drag = schedule_.drag;
    wanted.gyroscopic = schedule_.gyroscopic;
    wanted.trees = schedule_.trees.forest().trees() > 0;
    wanted.free_joints = schedule_.joints.any_without_trees();
    wanted.tree_joints = schedule_.joints.any_with_trees();
    wanted.shapes = detector_.possible();
    wanted.free_contacts = schedule_.contacts.any_without_trees();
    wanted.tree_contacts = schedule_.contacts.any_with_trees();
    wanted.friction = found_.friction || found_.rolling;
    wanted.restitution = found_.restitution;
    if (wanted.trees) state().tables.resize(Table::node, schedule_.trees.nodes().rows());
    plan_ = make_plan(wanted);
    const double h = substep_length(dt, settings_.substeps);
    const InfoInputs from(settings_, world_.gravity(), h, state().last_substep, h);
    fill_infos(from, infos_f_);
    fill_infos(from, infos_d_);
    if (auto status = runner_.prepare(settings_, variant.precision); !status) return status;
    if (auto status = bind(); !status) return status;
    return run(plan_);
  }

  Status broad() { return detector_.find_pairs(state(), dt, options_); }
  Status narrow() { return detector_.find_contacts(state(), options_, found_); }
  Status bind() { return runner_.bind(settings_, plan_, state(), schedule_); }
  /// Colours and layout of contacts, as after a step in which other pairs touch.
  Status lay_out() {
    schedule_.update_contacts(state());
    return bind();
  }
  Status run(const StepPlan& plan) {
    const bool f32 = world_.precision() == Precision::f32;
    if (auto status = runner_.bind(settings_, plan, state(), schedule_); !status) return status;
    return runner_.run(state(), schedule_, f32 ? static_cast<const void*>(infos_f_) : infos_d_, report_);
  }

  /// Lifts every body by a hand's breadth, or puts it back.
  void move() {
    lift_ = -lift_;
    for (std::uint32_t row = 1; row < state().bodies.size(); ++row)
      if (state().bodies[row].kind == BodyKind::dynamic)
        state().set_position(row, state().pose(row).position + Vec3{0, lift_, 0});
  }
  /// Makes every copy on a device look old.
  void touch() {
    for (std::size_t b = 0; b < table_buffer_count; ++b) state().tables.touch(Buffer(b));
  }

  const StepPlan& plan() const { return plan_; }
  std::size_t elements(Domain domain) const {
    if (domain == Domain::joint) return world_.joint_count();
    return domain == Domain::contact ? found_.contacts : schedule_.moving;
  }
  std::uint64_t transfer_bytes() const { return report_.transfer_bytes; }
  std::string device(Place place) const { return runner_.device(place); }

 private:
  WorldState& state() { return world_.state(); }

  /// The steps before; made once for a world, and remembered for the benchmarks that need the same again.
  Status settle(const std::string& key) {
    static std::map<std::string, std::vector<std::byte>> settled;
    if (const auto found = settled.find(key); found != settled.end()) return world_.restore(found->second);
    Stepper stepper;
    for (int step = 0; step < settling_steps; ++step)
      if (const StepReport& report = stepper.step(world_, dt); !report) return report.error;
    settled[key] = world_.snapshot();
    return {};
  }

  World world_;
  StepSettings settings_;
  Detector detector_;
  Detector::Options options_;
  Detector::Found found_;
  Schedule schedule_;
  Runner runner_;
  StepPlan plan_;
  StepReport report_;
  InfoOf<float> infos_f_[phase_count];
  InfoOf<double> infos_d_[phase_count];
  double lift_ = 0.1;
};

/// The entries of a plan that a benchmark is about.
template <class Wanted> StepPlan part_of(const StepPlan& plan, Wanted wanted) {
  StepPlan part = plan;
  std::erase_if(part.entries, [&](const PlanEntry& entry) { return !wanted(entry); });
  return part;
}

bool is_kernel(const PlanEntry& entry) { return entry.kind == PlanEntry::Kind::kernel; }

void finish(benchmark::State& state, const Bench& bench, const Status& status, std::size_t elements, Place place) {
  if (!status) return state.SkipWithError(status.error().message.c_str());
  state.counters["elements"] = double(elements);
  state.counters["per_element"] = benchmark::Counter(double(elements) * double(state.iterations()),
                                                     benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.SetLabel(bench.device(place));
}

/// A part of the step that the host does, whatever the place.
template <class Action> void host_stage(benchmark::State& state, Action action, bool moved) {
  Bench bench;
  Status status = bench.prepare("balls", int(state.range(0)), {"", Place::cpu, 0, Precision::f32});
  const FlushSubnormals flush;
  for (auto _ : state) {
    if (moved) {
      state.PauseTiming();
      bench.move();
      state.ResumeTiming();
    }
    if (status) status = action(bench);
  }
  finish(state, bench, status, bench.elements(Domain::body), Place::cpu);
}

void device_stage(benchmark::State& state, Stage stage, Variant variant) {
  Bench bench;
  Status status = bench.prepare(stage == Stage::joints ? "ragdolls" : "balls", int(state.range(0)), variant);
  const StepPlan part =
      part_of(bench.plan(), [&](const PlanEntry& e) { return is_kernel(e) && schema(e.kernel).stage == stage; });
  const FlushSubnormals flush;
  for (auto _ : state)
    if (status) status = bench.run(part);
  const Domain domain = stage == Stage::joints     ? Domain::joint
                        : stage == Stage::impulses ? Domain::contact
                                                   : Domain::body;
  finish(state, bench, status, bench.elements(domain), variant.place);
}

void transfer_stage(benchmark::State& state, PlanEntry::Kind kind, Variant variant) {
  Bench bench;
  Status status = bench.prepare("balls", int(state.range(0)), variant);
  const StepPlan part = part_of(bench.plan(), [&](const PlanEntry& e) { return e.kind == kind; });
  const std::uint64_t before = bench.transfer_bytes();
  for (auto _ : state) {
    bench.touch();
    if (status) status = bench.run(part);
  }
  state.SetBytesProcessed(std::int64_t(bench.transfer_bytes() - before));
  finish(state, bench, status, bench.elements(Domain::body), variant.place);
}

void one_kernel(benchmark::State& state, Kernel kernel, Variant variant) {
  Bench bench;
  Status status =
      bench.prepare(schema(kernel).domain == Domain::joint ? "ragdolls" : "balls", int(state.range(0)), variant);
  bool taken = false;
  const StepPlan part = part_of(bench.plan(), [&](const PlanEntry& e) {
    const bool first = is_kernel(e) && e.kernel == kernel && !taken;
    taken = taken || first;
    return first;
  });
  const FlushSubnormals flush;
  for (auto _ : state)
    if (status) status = bench.run(part);
  if (!taken && status) return state.SkipWithError("the scene's plan leaves this kernel out");
  finish(state, bench, status, bench.elements(schema(kernel).domain), variant.place);
}

/// 100 to 100,000 in decades. The CPU's stages are told in CPU time, which a busy machine does not change.
template <class Function, class... Arguments>
benchmark::internal::Benchmark* add(const std::string& name, Function function, Arguments... arguments) {
  return benchmark::RegisterBenchmark(name.c_str(), function, arguments...)
      ->RangeMultiplier(10)
      ->Range(100, 100'000)
      ->Unit(benchmark::kMicrosecond);
}

template <class Function, class What>
void add_variant(const std::string& name, Function function, What what, const Variant& variant) {
  auto* benchmark = add(name + "/" + variant.name, function, what, variant);
  if (variant.place == Place::gl) benchmark->UseRealTime();
}

const bool registered = [] {
  using Action = Status (*)(Bench&);
  const auto host = [](benchmark::State& state, Action action, bool moved) { host_stage(state, action, moved); };
  add("stage/broad/cpu", host, Action([](Bench& b) { return b.broad(); }), false);
  add("stage/broad_moved/cpu", host, Action([](Bench& b) { return b.broad(); }), true);
  add("stage/narrow/cpu", host, Action([](Bench& b) { return b.narrow(); }), false);
  add("stage/plan/cpu", host, Action([](Bench& b) { return b.lay_out(); }), false);

  constexpr Variant variants[] = {
      {"cpu_8", Place::cpu, 8, Precision::f32},        {"cpu_4", Place::cpu, 4, Precision::f32},
      {"cpu_1", Place::cpu, 1, Precision::f32},        {"cpu_double_4", Place::cpu, 4, Precision::f64},
      {"cpu_double_1", Place::cpu, 1, Precision::f64}, {"gl", Place::gl, 0, Precision::f32},
      {"gl_double", Place::gl, 0, Precision::f64}};
  constexpr Stage stages[] = {Stage::integrate, Stage::joints, Stage::impulses};
  for (const Variant& variant : variants) {
    for (Stage stage : stages) add_variant("stage/" + std::string(name(stage)), device_stage, stage, variant);
    if (variant.place == Place::gl) {
      add_variant("stage/upload", transfer_stage, PlanEntry::Kind::upload, variant);
      add_variant("stage/download", transfer_stage, PlanEntry::Kind::download, variant);
    }
    for (std::size_t k = 0; k < kernel_count; ++k)
      if (schema(Kernel(k)).stage != Stage::islands)  // those are in bench/islands.cpp
        add_variant("kernel/" + std::string(schema(Kernel(k)).name), one_kernel, Kernel(k), variant);
  }
  return true;
}();

}  // namespace
