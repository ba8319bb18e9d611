#include "host.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace fuzz {

using namespace pcphys;

Outcome of(const Status& status) {
  if (status) return {};
  return {status.error().code, {}, status.error().message};
}

bool same(const Outcome& a, const Outcome& b) {
  const auto alike = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y) || x == y ||
           (std::isnan(x) && std::isnan(y));
  };
  return a.code == b.code && std::ranges::equal(a.numbers, b.numbers, alike);
}

Host::Host(const Twin& twin, Precision precision) : world({.precision = precision}), twin_(twin) { renew(); }

StepSettings Host::placed() const {
  StepSettings s = settings_;
  s.lanes = twin_.lanes;
  s.threads = twin_.threads;
  s.timings = false;
  s.set_all(twin_.place);
  if (twin_.mixed) {
    (steps_ % 2 ? s.integrate : s.impulses) = Place::cpu;
    (steps_ % 3 ? s.joints : s.integrate) = Place::cpu;
  }
  s.islands = twin_.place;
  return s;
}

void Host::renew() {
  steppers_.clear();
  for (std::uint32_t i = 0; i < twin_.steppers; i++) {
    steppers_.emplace_back(placed());
    for (const KernelDef& def : kernels_) (void)steppers_.back().add_kernel(world, def);
  }
}

Outcome Host::configure(const StepSettings& settings) {
  const StepSettings before = settings_;
  settings_ = settings;
  Outcome outcome;
  for (Stepper& stepper : steppers_) outcome = of(stepper.configure(placed()));
  if (outcome.code != ErrorCode::none) settings_ = before;
  return outcome;
}

Outcome Host::step(double dt) {
  if (twin_.mixed)
    for (Stepper& stepper : steppers_) (void)stepper.configure(placed());
  if (twin_.fresh_every > 0 && steps_ % twin_.fresh_every == 0) {
    if (twin_.restored)
      if (const Status ok = world.restore(world.snapshot()); !ok) return of(ok);
    renew();
  }
  if (twin_.restored && steps_ % 3 == 0) {
    (void)world.shrink();
    for (Stepper& stepper : steppers_) (void)stepper.shrink();
  }
  const StepReport& report = steppers_[steps_++ % steppers_.size()].step(world, dt);
  if (!report) return {report.error.code, {}, report.error.message};
  Outcome made{ErrorCode::none,
               {double(report.substeps), double(report.refined), double(report.limited), double(report.repeats),
                double(report.given_up), double(report.fourth_order), double(report.bodies), double(report.joints),
                double(report.contacts), double(report.points), double(report.asleep), double(report.islands_asleep),
                double(report.fell_asleep), double(report.woke), double(report.frozen.size())},
               {}};
  for (const BodyId id : report.frozen) made.numbers.push_back(id.index);
  return made;
}

Outcome Host::add_kernel(const KernelDef& def) {
  Outcome outcome;
  for (Stepper& stepper : steppers_) outcome = of(stepper.add_kernel(world, def));
  if (outcome.code == ErrorCode::none) kernels_.push_back(def);
  return outcome;
}

Outcome Host::remove_kernel(const std::string& name) {
  Outcome outcome;
  for (Stepper& stepper : steppers_) outcome = of(stepper.remove_kernel(world, name));
  std::erase_if(kernels_, [&](const KernelDef& def) { return name == def.text.name; });
  return outcome;
}

namespace {
void put(Outcome& all, double x) { all.numbers.push_back(x); }
void put(Outcome& all, Vec3 v) { all.numbers.insert(all.numbers.end(), {v.x, v.y, v.z}); }
void put(Outcome& all, Quat q) { all.numbers.insert(all.numbers.end(), {q.x, q.y, q.z, q.w}); }
void put(Outcome& all, const Pose& pose) {
  put(all, pose.position);
  put(all, pose.orientation);
}
void put(Outcome& all, const MassProperties& m) {
  put(all, m.mass);
  put(all, m.moments);
}
void put(Outcome& all, BodyId id) {
  put(all, id.index);
  put(all, id.generation);
}
template <class T> void put(Outcome& all, const Result<T>& result) {
  if (result)
    put(all, *result);
  else
    put(all, -1.0 - double(result.error().code));
}
}  // namespace

Outcome Host::read_all() const {
  Outcome all;
  for (const double x : {double(world.body_count()), double(world.joint_count()), double(world.contact_count()),
                         world.kinetic_energy(), world.potential_energy(), world.spring_energy()})
    put(all, x);
  for (const Vec3 v : {world.momentum(), world.angular_momentum(), world.gravity()}) put(all, v);
  std::vector<BodyId> ids = world.bodies();
  for (const BodyId id : bodies)
    if (!world.valid(id)) ids.push_back(id);
  for (const BodyId id : ids) {
    put(all, world.pose(id));
    put(all, world.velocity(id));
    put(all, world.angular_velocity(id));
    put(all, world.angular_momentum(id));
    put(all, world.position_last(id));
    put(all, world.orientation_last(id));
    put(all, world.mass_properties(id));
    put(all, world.frozen(id));
    put(all, world.is_asleep(id));
    put(all, world.can_sleep(id));
    for (const auto& p : properties) put(all, world.get(p, id));
  }
  for (const JointId id : joints) put(all, world.joint_separation(id));
  for (const Contact& contact : world.contacts()) {
    put(all, contact.a);
    put(all, contact.b);
    put(all, contact.normal);
    for (const Contact::Point& point : contact.points) {
      put(all, point.position);
      put(all, point.separation);
      put(all, point.impulse);
    }
  }
  return all;
}

}  // namespace fuzz
