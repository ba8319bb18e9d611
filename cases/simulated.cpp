#include "simulated.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "clock.h"
#include "measures.h"

namespace pcphys::cases {
namespace {

/// One for all simulations: a GL context is slow to make.
struct SharedStepper {
  Stepper stepper;
  const void* last = nullptr;  // whose step it made last
};

class Own final : public Simulated {
 public:
  Own(Problem problem, SharedStepper& shared, const StepSettings& settings)
      : Simulated(std::move(problem)), shared_(shared), settings_(settings), wrenches_(std::size_t(bodies())) {}

  ~Own() override {
    if (shared_.last == this) shared_.last = nullptr;
  }

  Pose pose(int body) const override { return *world().pose(id(body)); }
  Vec3 velocity(int body) const override { return *world().velocity(id(body)); }
  Vec3 angular_velocity(int body) const override { return *world().angular_velocity(id(body)); }
  std::uint64_t hash() const override { return world().hash(); }
  Vec3 kept_angular_momentum() const override { return world().angular_momentum(); }

 protected:
  Status advance(double dt) override {
    if (std::exchange(shared_.last, this) != this)
      if (auto status = shared_.stepper.configure(settings_); !status) return status;
    const StepReport& report = shared_.stepper.step(problem_.world, dt);
    if (report.frozen.empty() || frozen_allowed_) return report.error;
    return Error{ErrorCode::not_finite,
                 std::to_string(report.frozen.size()) + " bodies left the range of numbers, and the step froze them."};
  }

  void apply_wrench(int body, const Wrench& wrench) override {
    ForceId& force = wrenches_[std::size_t(body)];
    if (force != ForceId{}) check(problem_.world.remove(force));
    auto added = problem_.world.add_force(id(body), wrench);
    if (!added) return refuse(added.error().message);
    force = *added;
  }
  void apply_gravity(Vec3 gravity) override { check(problem_.world.set_gravity(gravity)); }
  void apply_velocity(int body, Vec3 velocity, Vec3 angular_velocity) override {
    check(problem_.world.set_velocity(id(body), velocity));
    check(problem_.world.set_angular_velocity(id(body), angular_velocity));
  }

 private:
  const World& world() const { return problem_.world; }
  BodyId id(int body) const { return problem_.scene.bodies[std::size_t(body)].id; }
  void check(const Status& status) {
    if (!status) refuse(status.error().message);
  }

  SharedStepper& shared_;
  StepSettings settings_;
  std::vector<ForceId> wrenches_;
};

// Between two looks at the clock, of every engine alike: a step of a peer can take a second of its budget.
constexpr long steps_a_look = 10;

class OwnEngine final : public Engine {
 public:
  OwnEngine(Place place, std::uint32_t lanes, int device) : place_(place), lanes_(lanes), device_(device) {}

  Result<std::unique_ptr<Simulated>> start(Problem problem, const Conditions& conditions) override {
    StepSettings settings = conditions.settings;
    settings.set_all(place_);
    settings.lanes = lanes_;
    settings.device = device_;
    settings.timings = false;
    return std::unique_ptr<Simulated>(std::make_unique<Own>(std::move(problem), shared_, settings));
  }
  std::string backend() const override { return name(place_); }
  Status resolve(SphereContact& contact, Precision precision) override {
    return cases::resolve(contact, precision, place_, lanes_);
  }

 private:
  Place place_;
  std::uint32_t lanes_;
  int device_;
  SharedStepper shared_;
};

}  // namespace

Vec3 Simulated::kept_angular_momentum() const { return angular_momentum(*this); }

Simulated::Simulated(Problem problem) : problem_(std::move(problem)) {
  for (const scenes::SceneBody& body : problem_.scene.bodies) {
    const auto mass = problem_.world.mass_properties(body.id);
    masses_.push_back(mass ? *mass : MassProperties{});
    moving_ += body.kind == BodyKind::dynamic;
  }
}

void Simulated::step(double dt, long count) {
  if (meter_ == nullptr) return;
  Meter& meter = *meter_;
  while (count > 0 && meter.error.code == ErrorCode::none && meter.steps < meter.limit) {
    const long until_hash = meter.steps < hashed_steps ? hashed_steps - meter.steps : count;
    const long batch = std::min({count, until_hash, meter.limit - meter.steps, steps_a_look});
    const double cost = clock_cost(), begin = thread_clock();
    for (long i = 0; i < batch; ++i)
      if (auto status = advance(dt); !status) {
        meter.error = status.error();
        return;
      }
    meter.seconds += std::max(0.0, thread_clock() - begin - cost);
    meter.steps += batch;
    record(dt, batch);
    meter.body_steps += moving_ * double(batch);
    if (meter.steps == hashed_steps) meter.hash = hash();
    if (meter.seconds > meter.budget) refuse("It took longer than its budget.");
    count -= batch;
  }
}

Status Engine::resolve(SphereContact&, Precision) {
  return Error{ErrorCode::unavailable, "This engine cannot be given a single contact."};
}

void Simulated::refuse(const std::string& what) {
  if (meter_ && meter_->error.code == ErrorCode::none) meter_->error = {ErrorCode::unavailable, what};
}

void Simulated::apply_wrench(int, const Wrench&) { refuse("This engine takes no forces."); }
void Simulated::apply_gravity(Vec3) { refuse("This engine's gravity cannot change."); }
void Simulated::apply_velocity(int, Vec3, Vec3) { refuse("This engine's velocities cannot be set."); }

void Simulated::record(double dt, long count) {
  if (auto* steps = deeds_.empty() ? nullptr : std::get_if<Steps>(&deeds_.back()); steps && steps->dt == dt)
    steps->count += count;
  else
    deeds_.push_back(Steps{dt, count});
}

void Simulated::carry_out(const Deed& deed) {
  deeds_.push_back(deed);
  apply(deed);
}

void Simulated::apply(const Deed& deed) {
  if (const auto* push = std::get_if<Push>(&deed)) apply_wrench(push->body, push->wrench);
  if (const auto* pull = std::get_if<Pull>(&deed)) apply_gravity(pull->gravity);
  if (const auto* start = std::get_if<Start>(&deed))
    apply_velocity(start->body, start->velocity, start->angular_velocity);
}

double Simulated::repeat(const Simulated& other) {
  frozen_allowed_ = other.frozen_allowed_;
  long made = 0;
  double begin = 0;
  for (const Deed& deed : other.deeds_) {
    apply(deed);
    const auto* steps = std::get_if<Steps>(&deed);
    for (long i = 0; steps && i < steps->count; ++i) {
      if (!advance(steps->dt)) return -1;
      if (++made == 1) begin = thread_clock();
    }
  }
  if (made < 2) return -1;
  return (thread_clock() - begin - clock_cost()) * double(made) / double(made - 1);
}

std::unique_ptr<Engine> make_pcphys(Place place, std::uint32_t lanes, int device) {
  return std::make_unique<OwnEngine>(place, lanes, device);
}

}  // namespace pcphys::cases
