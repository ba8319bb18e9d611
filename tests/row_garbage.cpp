// Pins that a step reads nothing of the solver's rows that it did not write: with NaN, infinity or huge numbers in all of them
// at the start of every step, hashes are those of a run without. (A GPU hands out memory with whatever was in it: a NaN times
// the zero that should have hidden it made one run in thousands differ.)
#include <bit>
#include <map>
#include <utility>
#include <vector>

#include "step/backend.h"
#include "support_world.h"
#include "world/tables.h"

using namespace worldtest;

namespace {

std::uint32_t garbage = 0;  // of each 32 bits of the rows

/// A backend whose rows are the test's memory, filled anew before each step.
class SpoilingBackend final : public Backend {
 public:
  explicit SpoilingBackend(std::unique_ptr<Backend> inner, std::size_t real_bytes)
      : inner_(std::move(inner)), real_bytes_(real_bytes) {}

  std::string device() const override { return inner_->device(); }
  std::uint32_t width() const override { return inner_->width(); }
  std::uint32_t width_for(Domain domain, std::uint32_t count) const override { return inner_->width_for(domain, count); }
  Status attach(Buffer buffer, void* host, std::size_t bytes) override { return inner_->attach(buffer, host, bytes); }
  Status reserve(Buffer buffer, std::size_t slots) override {
    AlignedBytes& rows = rows_[buffer];
    rows.resize(slots * schema(buffer).reals * real_bytes_);
    return inner_->attach(buffer, rows.data(), rows.size());
  }
  Status upload(Buffer buffer) override { return inner_->upload(buffer); }
  Status download(Buffer buffer) override { return inner_->download(buffer); }
  /// Once a step, before it runs.
  Status set_infos(const void* infos, std::size_t count) override {
    for (auto& [buffer, rows] : rows_)
      for (std::size_t i = 0; i + 4 <= rows.size(); i += 4) std::memcpy(rows.data() + i, &garbage, 4);
    return inner_->set_infos(infos, count);
  }
  Status run(std::span<const KernelRun> runs) override { return inner_->run(runs); }
  Result<bool> take_flag(Buffer buffer, std::uint32_t quad) override { return inner_->take_flag(buffer, quad); }
  Status finish() override { return inner_->finish(); }

 private:
  std::unique_ptr<Backend> inner_;
  std::size_t real_bytes_;
  std::map<Buffer, AlignedBytes> rows_;
};

/// Steppers made inside this scope run their "gl" stages on the CPU, in such rows.
struct SpoilingScope {
  GlBackendMaker before =
      std::exchange(gl_backend_maker(), [](Precision precision, int, bool) -> Result<std::unique_ptr<Backend>> {
        auto cpu = make_cpu_backend(precision, 0);
        if (!cpu) return cpu.error();
        return std::unique_ptr<Backend>(std::make_unique<SpoilingBackend>(std::move(*cpu), precision == Precision::f64 ? 8 : 4));
      });
  ~SpoilingScope() { gl_backend_maker() = before; }
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

void check_same(const std::string& name, SceneWorld clean, SceneWorld spoilt, int steps) {
  CAPTURE(name);
  CAPTURE(garbage);
  Stepper stepper(lanes(0));
  run(clean.world, stepper, steps);
  SpoilingScope scope;
  StepSettings settings = lanes(0);
  settings.set_all(Place::gl);
  Stepper other(settings);
  run(spoilt.world, other, steps);
  CHECK(clean.world.hash() == spoilt.world.hash());
}

}  // namespace

TEST_CASE("rows: what was in them before a step does not matter") {
  const std::pair<const char*, int> scenes[] = {{"balls", 40},    {"ragdolls", 6},   {"pyramid", 8}, {"stack", 5},
                                                {"chain", 12},    {"chainswing", 8}, {"heavy", 2},   {"door", 1},
                                                {"dominoes", 20}, {"hulls", 10}};
  for (const std::uint32_t bits : {0xffffffffu, 0x7f800000u, 0x7f7fffffu}) {  // NaN, and of a float infinity and its largest
    garbage = bits;
    for (const Precision precision : {Precision::f32, Precision::f64}) {
      for (const auto& [name, count] : scenes)
        check_same(name, scene_world(name, count, precision), scene_world(name, count, precision), 70);
      check_same("busy", busy_world(precision), busy_world(precision), 70);
    }
  }
}
