// Pins what a GPU may do and llvmpipe does not: its memory holds whatever was in it (a NaN times the zero that should
// have hidden it made one run in thousands differ), rows of the solver hold it at the start of every step, and all that
// no barrier parts runs in any order. On a device that does its worst hashes are those of the CPU.
#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "step/backend.h"
#include "support_world.h"
#include "world/tables.h"

using namespace worldtest;

namespace {

std::uint32_t garbage = 0;      // of each 32 bits that nothing has been written to
std::uint32_t lanes_there = 1;  // of that device; 0: the widest
bool labels_fall_forever = false;

void spoil(AlignedBytes& bytes) {
  for (std::size_t i = 0; i + 4 <= bytes.size(); i += 4) std::memcpy(bytes.data() + i, &garbage, 4);
}

/// The CPU with memory of its own and a queue: blocks of slots run in an order drawn by lot, up to the next barrier.
class WorstDevice final : public Backend {
 public:
  WorstDevice(std::unique_ptr<Backend> inner, std::size_t real_bytes)
      : inner_(std::move(inner)), real_bytes_(real_bytes) {}

  std::string device() const override { return "the worst"; }
  std::uint32_t width() const override { return inner_->width(); }
  Status attach(Buffer buffer, void* host, std::size_t bytes) override {
    Memory& memory = memory_[buffer];
    memory.host = host;
    if (memory.device.size() == bytes && bytes > 0) return {};
    return resize(buffer, bytes);
  }
  Status reserve(Buffer buffer, std::size_t slots) override {
    return resize(buffer, slots * schema(buffer).reals * real_bytes_);
  }
  Status upload(Buffer buffer) override {
    if (Status ok = flush(); !ok) return ok;
    Memory& memory = memory_.at(buffer);
    if (memory.device.size() > 0) std::memcpy(memory.device.data(), memory.host, memory.device.size());
    return {};
  }
  Status download(Buffer buffer) override {
    if (Status ok = flush(); !ok) return ok;
    const Memory& memory = memory_.at(buffer);
    if (memory.device.size() > 0) std::memcpy(memory.host, memory.device.data(), memory.device.size());
    return {};
  }
  Status keep(Buffer buffer) override {
    if (Status ok = flush(); !ok) return ok;
    Memory& memory = memory_.at(buffer);
    memory.kept.resize(memory.device.size());
    if (memory.kept.size() > 0) std::memcpy(memory.kept.data(), memory.device.data(), memory.kept.size());
    return {};
  }
  Status put_back(Buffer buffer) override {
    if (Status ok = flush(); !ok) return ok;
    Memory& memory = memory_.at(buffer);
    if (memory.kept.size() > 0) std::memcpy(memory.device.data(), memory.kept.data(), memory.kept.size());
    return {};
  }
  /// Once a step, before it runs.
  Status set_infos(const void* infos, std::size_t count) override {
    for (auto& [buffer, memory] : memory_)
      if (memory.host == nullptr) spoil(memory.device);
    return inner_->set_infos(infos, count);
  }
  Status prepare(const OwnKernel& kernel) override { return inner_->prepare(kernel); }
  Status run(std::span<const KernelRun> runs) override {
    for (const KernelRun& run : runs) {
      bool waits = run.barrier;
      for (const Range& range : run.ranges) {
        if (waits)
          if (Status ok = flush(); !ok) return ok;
        const std::uint32_t together = !run.own && schema(run.kernel).domain == Domain::body ? width() : 1;
        for (std::uint32_t i = range.begin; i < range.end; i += together)
          queue_.push_back({run, {i, std::min(i + together, range.end)}});
        waits = true;
      }
      if (run.ranges.empty() && waits)
        if (Status ok = flush(); !ok) return ok;
    }
    return {};
  }
  Result<bool> take_flag(Buffer buffer, std::uint32_t quad) override {
    if (Status ok = flush(); !ok) return ok.error();
    if (labels_fall_forever && buffer == Buffer::island_labels) return true;
    return inner_->take_flag(buffer, quad);
  }
  Status finish() override { return flush(); }

 private:
  struct Memory {
    void* host = nullptr;  // of rows of the solver there is none
    AlignedBytes device, kept;
  };
  struct Queued {
    KernelRun run;
    Range range;
  };
  Status resize(Buffer buffer, std::size_t bytes) {
    if (Status ok = flush(); !ok) return ok;
    AlignedBytes& device = memory_[buffer].device;
    device.resize(bytes);
    spoil(device);
    return inner_->attach(buffer, device.data(), device.size());
  }
  Status flush() {
    std::ranges::shuffle(queue_, lots_);
    for (Queued& queued : queue_) {
      queued.run.ranges = {&queued.range, 1};
      if (Status ok = inner_->run({&queued.run, 1}); !ok) return ok;
    }
    queue_.clear();
    return {};
  }

  std::unique_ptr<Backend> inner_;
  std::size_t real_bytes_;
  std::map<Buffer, Memory> memory_;
  std::vector<Queued> queue_;
  std::mt19937 lots_{1};
};

/// Steppers made inside this scope run their "gl" stages on it.
struct WorstDeviceScope {
  GlBackendMaker before =
      std::exchange(gl_backend_maker(), [](Precision precision, int, bool) -> Result<std::unique_ptr<Backend>> {
        auto cpu = make_cpu_backend(precision, lanes_there);
        if (!cpu) return cpu.error();
        return std::unique_ptr<Backend>(
            std::make_unique<WorstDevice>(std::move(*cpu), precision == Precision::f64 ? 8 : 4));
      });
  ~WorstDeviceScope() { gl_backend_maker() = before; }
};

/// Closed loops with angles, a motor, springs, a pendulum on one pin, and balls that fall among them.
SceneWorld busy_world(Precision precision) {
  SceneWorld s = scene_world("ragdolls", 3, precision);
  World& w = s.world;
  std::vector<BodyId> ring;
  for (int i = 0; i < 6; i++) ring.push_back(must(w.create_body(ball({std::cos(i * 1.0), std::sin(i * 1.0), 4}, 0.3))));
  for (std::size_t i = 0; i < ring.size(); i++) {
    JointDef joint;
    joint.a = ring[i], joint.b = ring[(i + 1) % ring.size()];
    joint.frame_a.position = {0.3, 0, 0}, joint.frame_b.position = {-0.3, 0, 0};
    if (i == 0) joint.motor = {5, 0.5};
    if (i < 3) joint.freedom = AngleFreedom::hinge(-1, 1);
    must(w.create_joint(joint));
  }
  SpringDef spring;
  spring.a = ring[0], spring.b = ring[3], spring.rest_length = 1, spring.stiffness = 100;
  must(w.create_spring(spring));
  JointDef pin;
  pin.a = w.ground(), pin.b = must(w.create_body(ball({3, 3, 3}, 0.2)));
  pin.frame_a.position = {3, 3, 3.5}, pin.frame_b.position = {0, 0, 0.5};
  must(w.create_joint(pin));
  return s;
}

using MakeWorld = std::function<World()>;

std::uint64_t hash_after(const MakeWorld& make, StepSettings settings, std::uint32_t order, int steps) {
  settings.order = order;
  World world = make();
  Stepper stepper(settings);
  run(world, stepper, steps);
  return world.hash();
}

void check_same(const std::string& name, const MakeWorld& make, int steps, std::uint32_t order = 2) {
  CAPTURE(name);
  CAPTURE(garbage);
  CAPTURE(lanes_there);
  const std::uint64_t wanted = hash_after(make, lanes(0), order, steps);
  WorstDeviceScope scope;
  StepSettings settings = lanes(0);
  settings.set_all(Place::gl);
  CHECK(hash_after(make, settings, order, steps) == wanted);
}

void check_mixes(const std::string& name, const MakeWorld& make, int steps, std::uint32_t order = 2) {
  CAPTURE(name);
  const std::uint64_t wanted = hash_after(make, lanes(0), order, steps);
  WorstDeviceScope scope;
  for (const Mix& mix : mixes()) {
    INFO(mix.text());
    CHECK(hash_after(make, mix.settings(), order, steps) == wanted);
  }
}

const std::pair<const char*, int> all_scenes[] = {{"balls", 40},    {"ragdolls", 6},   {"pyramid", 8}, {"stack", 5},
                                                  {"chain", 12},    {"chainswing", 8}, {"heavy", 2},   {"door", 1},
                                                  {"dominoes", 20}, {"hulls", 10}};

MakeWorld maker(const char* name, int count, Precision precision) {
  return [=] { return scene_world(name, count, precision).world; };
}

}  // namespace

TEST_CASE("worst device: what was in memory does not matter, nor the order of what no barrier parts") {
  // NaN, and of a float infinity and its largest
  for (const std::uint32_t bits : {0xffffffffu, 0x7f800000u, 0x7f7fffffu}) {
    garbage = bits;
    for (const Precision precision : {Precision::f32, Precision::f64})
      for (const std::uint32_t lanes : {0u, 1u}) {
        lanes_there = lanes;
        for (const auto& [name, count] : all_scenes) check_same(name, maker(name, count, precision), 70);
        check_same(
            "crowd", [=] { return crowd_world(precision); }, 3);
        check_same(
            "busy", [=] { return busy_world(precision).world; }, 70);
        check_same(
            "chains", [=] { return chains_world(precision); }, 70, 4);
      }
  }
}

TEST_CASE("worst device: in all mixes") {
  garbage = 0xffffffffu;
  lanes_there = 1;
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    for (const auto& [name, count] : all_scenes) check_mixes(name, maker(name, count, precision), 20);
    check_mixes(
        "busy", [=] { return busy_world(precision).world; }, 20);
    check_mixes(
        "chains", [=] { return chains_world(precision); }, 40, 4);
  }
}

TEST_CASE("worst device: islands are the same in whatever order it visits who touches whom") {
  garbage = 0xffffffffu;
  lanes_there = 0;
  StepSettings settings = lanes(0);
  settings.sleep = true;
  settings.sleep_time = 0.1;
  settings.sleep_speed = 0.3;
  settings.sleep_spin = 1;
  for (const auto& scene : all_scenes) {
    CAPTURE(scene.first);
    const MakeWorld make = maker(scene.first, scene.second, Precision::f32);
    const std::uint64_t wanted = hash_after(make, settings, 2, 70);
    const WorstDeviceScope scope;
    StepSettings there = settings;
    there.islands = Place::gl;
    CHECK(hash_after(make, there, 2, 70) == wanted);
    there.set_all(Place::gl);
    CHECK(hash_after(make, there, 2, 70) == wanted);
  }
}

TEST_CASE("worst device: one that finds no end of islands is an error, and the world is as it was") {
  garbage = 0;
  const WorstDeviceScope scope;
  World world = scene_world("pyramid", 3).world;
  StepSettings settings = lanes(0);
  settings.sleep = true;
  settings.islands = Place::gl;
  Stepper stepper(settings);
  labels_fall_forever = true;
  CHECK_REFUSED(world, step_status(stepper, world), ErrorCode::device_error, "The device found no end of the islands");
  labels_fall_forever = false;
  CHECK(bool(step_status(stepper, world)));
}
