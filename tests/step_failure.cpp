// Pins what a step leaves behind when its GL device fails: whichever call of the backend it is, and whether it was
// carried out or not, the world is the same to the byte, and the next step gives the bits of a run without failures.
#include <epoxy/egl.h>

#include <algorithm>
#include <utility>

#include "step/backend.h"
#include "support_world.h"

using namespace worldtest;

namespace {

/// Counts the calls of all failing backends; the one whose number is `fail_at` fails.
struct Fault {
  int calls = 0, fail_at = -1;
  bool late = false;  // after it was carried out

  void arm(int call, bool after) { *this = {0, call, after}; }
  void disarm() { fail_at = -1; }
} fault;

/// The GL backend, but for the call that fails.
class FailingBackend final : public Backend {
 public:
  explicit FailingBackend(std::unique_ptr<Backend> gl) : gl_(std::move(gl)) {}
  static Result<std::unique_ptr<Backend>> make(Precision precision, int device, bool host_context) {
    auto gl = make_gl_backend(precision, device, host_context);
    if (!gl) return gl.error();
    return std::unique_ptr<Backend>(std::make_unique<FailingBackend>(std::move(*gl)));
  }

  std::string device() const override { return gl_->device(); }
  std::uint32_t width() const override { return gl_->width(); }
  Status attach(Buffer buffer, void* host, std::size_t bytes) override {
    return perhaps([&] { return gl_->attach(buffer, host, bytes); });
  }
  Status reserve(Buffer buffer, std::size_t slots) override {
    return perhaps([&] { return gl_->reserve(buffer, slots); });
  }
  Status upload(Buffer buffer) override {
    return perhaps([&] { return gl_->upload(buffer); });
  }
  Status download(Buffer buffer) override {
    return perhaps([&] { return gl_->download(buffer); });
  }
  Status keep(Buffer buffer) override {
    return perhaps([&] { return gl_->keep(buffer); });
  }
  Status put_back(Buffer buffer) override { return gl_->put_back(buffer); }
  Status set_infos(const void* infos, std::size_t count) override {
    return perhaps([&] { return gl_->set_infos(infos, count); });
  }
  Status run(std::span<const KernelRun> runs) override {
    for (const KernelRun& one : runs)
      if (Status ok = perhaps([&] { return gl_->run({&one, 1}); }); !ok) return ok;
    return {};
  }
  Result<bool> take_flag(Buffer buffer, std::uint32_t quad) override { return gl_->take_flag(buffer, quad); }
  Status finish() override {
    return perhaps([&] { return gl_->finish(); });
  }

 private:
  Status perhaps(auto&& call) {
    const bool fails = fault.calls++ == fault.fail_at;
    if (!fails) return call();
    if (fault.late) must(call());
    return Error{ErrorCode::device_error, "The device failed as this test asked for."};
  }

  std::unique_ptr<Backend> gl_;
};

/// Steppers that are made inside this scope get failing backends.
struct FailingScope {
  GlBackendMaker before = std::exchange(gl_backend_maker(), FailingBackend::make);
  ~FailingScope() { gl_backend_maker() = before; }
};

/// Joints, contacts that bounce, drag, a constant force and a callback's, in the middle of a run.
SceneWorld busy_world(Precision precision) {
  SceneWorld s = scene_world("ragdolls", 2, precision);
  for (const BodyId body : s.world.bodies()) must(s.world.set_material(body, {0.5, 0.4, 0.3}));
  const BodyId first = s.world.bodies()[2], second = s.world.bodies()[5];
  must(s.world.set_drag(first, 0.2, 0.1));
  (void)must(s.world.add_force(first, Wrench{{3, 0, 1}, {0, 1, 0}}));
  (void)must(s.world.add_force(second, [](const World& w, BodyId id) {
    return Wrench{-5.0 * w.pose(id)->position, {}};
  }));
  Stepper stepper(lanes(0));
  run(s.world, stepper, 70);
  REQUIRE(s.world.contact_count() > 5);
  return s;
}

/// Fails in every call of a step in turn, one step later each time; returns how many there were.
int fail_everywhere(const Mix& mix, Precision precision, bool late) {
  SceneWorld tried = busy_world(precision), wanted = busy_world(precision);
  REQUIRE(tried.world.hash() == wanted.world.hash());
  StepSettings settings = mix.settings();
  settings.timings = late;  // then every stage ends with a call of its own
  Stepper failing(settings), other(mixes().back().settings()), reference(lanes(0));
  int call = 0;
  for (;; call++) {
    INFO("call " << call);
    const Fingerprint before = fingerprint(tried.world);
    fault.arm(call, late);
    const Status status = step_status(failing, tried.world);
    fault.disarm();
    const bool went_through = bool(status);
    if (!went_through) {
      CHECK(status.error().code == ErrorCode::device_error);
      CHECK_MESSAGE((fingerprint(tried.world) == before), "the failed step changed the world");
      CHECK_MESSAGE(eglGetCurrentContext() == EGL_NO_CONTEXT, "the failed step did not let go of its context");
      Stepper& next = call % 2 == 0 ? failing : other;  // another one's device has copies of its own
      must(step_status(next, tried.world));
    }
    run(wanted.world, reference, 1);
    CHECK(tried.world.hash() == wanted.world.hash());
    if (went_through) return call;
  }
}

}  // namespace

TEST_CASE("a device that fails anywhere in a step leaves the world as it was") {
  require_gl();
  const FailingScope scope;
  for (const Mix& mix : mixes()) {
    if (std::ranges::find(mix.places, Place::gl) == mix.places.end()) continue;
    for (const bool late : {false, true}) {
      INFO(mix.text() << std::string(late ? ", after the call was carried out" : ", before"));
      CHECK(fail_everywhere(mix, Precision::f32, late) > 20);
    }
  }
}

TEST_CASE("the same in double, in one mix of places") {
  require_gl();
  const FailingScope scope;
  CHECK(fail_everywhere(mixes()[4], Precision::f64, true) > 20);
}

TEST_CASE("contacts that a filter ended come back with a failed step") {
  require_gl();
  const FailingScope scope;
  SceneWorld s = busy_world(Precision::f32);
  Stepper stepper(mixes().back().settings());
  run(s.world, stepper, 1);
  for (const BodyId body : s.world.bodies()) must(s.world.set_filter(body, {1, 0, 0}));
  fault.arm(0, false);
  CHECK_REFUSED(s.world, step_status(stepper, s.world), ErrorCode::device_error, "as this test asked for");
  fault.disarm();
  CHECK(s.world.contact_count() > 0);
  run(s.world, stepper, 1);
  CHECK(s.world.contact_count() == 0);
}

TEST_CASE("a device that has failed is not asked by a step on the cpu alone") {
  require_gl();
  const FailingScope scope;
  SceneWorld s = busy_world(Precision::f32);
  Stepper stepper(mixes().back().settings());
  run(s.world, stepper, 1);
  must(stepper.configure(lanes(0)));
  fault.arm(0, false);
  run(s.world, stepper, 1);
  CHECK(fault.calls == 0);
  fault.disarm();
}
