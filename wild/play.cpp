#include "wild/play.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <utility>

namespace pcphys::wild {
namespace {

/// Unrelated islands stand this far away [m]: further than anything of a scene goes, and near enough for float.
constexpr double far_away = 2e4;

WorldDef with_precision(WorldDef def, Precision precision) {
  def.precision = precision;
  return def;
}

template <class Id> void put(std::vector<Id>& list, int number, Id id) {
  if (list.size() <= std::size_t(number)) list.resize(std::size_t(number) + 1);
  list[std::size_t(number)] = id;
}

template <class T> Status to_status(const Result<T>& result) { return result ? Status{} : Status(result.error()); }

}  // namespace

/// One call on the library. What names an object that is not there is refused by the library itself.
struct Player::Apply {
  Player& p;

  Status operator()(const MakeBody& c) const {
    const auto made = p.world_.create_body(c.def);
    put(p.bodies_, c.body, made ? *made : BodyId{});
    return to_status(made);
  }
  Status operator()(const MakeJoint& c) const {
    JointDef def = c.def;
    def.a = p.body(c.a);
    def.b = p.body(c.b);
    const auto made = p.world_.create_joint(def);
    put(p.joints_, c.joint, made ? *made : JointId{});
    return to_status(made);
  }
  Status operator()(const MakeSpring& c) const {
    SpringDef def = c.def;
    def.a = p.body(c.a);
    def.b = p.body(c.b);
    const auto made = p.world_.create_spring(def);
    put(p.springs_, c.spring, made ? *made : SpringId{});
    return to_status(made);
  }
  Status operator()(const MakeRagdoll& c) const {
    const auto made = p.world_.create_ragdoll(c.def, c.pose, c.velocity);
    for (std::size_t i = 0; i < c.def.bones.size(); i++)
      put(p.bodies_, c.first_body + int(i), made ? made->bones[i] : BodyId{});
    for (std::size_t i = 0; i + 1 < c.def.bones.size(); i++)
      put(p.joints_, c.first_joint + int(i), made ? made->joints[i] : JointId{});
    return to_status(made);
  }
  Status operator()(const Destroy& c) const {
    switch (c.object) {
      case Object::body: return p.world_.destroy(p.body(c.number));
      case Object::joint: return p.world_.destroy(p.joint(c.number));
      case Object::spring: return p.world_.destroy(p.spring(c.number));
      case Object::force: break;
    }
    return p.world_.remove(at(p.forces_, c.number));
  }
  Status operator()(const SetPose& c) const { return p.world_.set_pose(p.body(c.body), c.pose); }
  Status operator()(const SetVelocity& c) const {
    if (Status ok = p.world_.set_velocity(p.body(c.body), c.velocity); !ok) return ok;
    return p.world_.set_angular_velocity(p.body(c.body), c.angular_velocity);
  }
  Status operator()(const SetMass& c) const { return p.world_.set_mass_properties(p.body(c.body), c.mass); }
  Status operator()(const SetMaterial& c) const { return p.world_.set_material(p.body(c.body), c.material); }
  Status operator()(const SetDrag& c) const { return p.world_.set_drag(p.body(c.body), c.linear, c.angular); }
  Status operator()(const SetFilter& c) const { return p.world_.set_filter(p.body(c.body), c.filter); }
  Status operator()(const SetCollide& c) const { return p.world_.set_collide(p.body(c.a), p.body(c.b), c.collide); }
  Status operator()(const SetMotor& c) const { return p.world_.set_motor(p.joint(c.joint), c.motor); }
  Status operator()(const SetJointSpring& c) const { return p.world_.set_spring(p.joint(c.joint), c.spring); }
  Status operator()(const SetSpring& c) const {
    return p.world_.set_spring(p.spring(c.spring), c.rest_length, c.stiffness, c.damping);
  }
  Status operator()(const SetGravity& c) const { return p.world_.set_gravity(c.gravity); }
  Status operator()(const AddForce& c) const {
    const auto made = p.world_.add_force(p.body(c.body), c.wrench);
    put(p.forces_, c.force, made ? *made : ForceId{});
    return to_status(made);
  }
  Status operator()(const SetCanSleep& c) const { return p.world_.set_can_sleep(p.body(c.body), c.can_sleep); }
  Status operator()(const Wake& c) const { return p.world_.wake(p.body(c.body)); }
  Status operator()(const Configure& c) const {
    const StepSettings before = std::exchange(p.settings_, c.settings);
    const Status ok = p.configure();
    if (!ok) p.settings_ = before;
    return ok;
  }
  Status operator()(const Save&) const {
    p.saved_ = p.world_.snapshot();
    return {};
  }
  Status operator()(const Restore&) const { return p.world_.restore(p.saved_); }
  Status operator()(const Steps&) const { return {}; }
};

Player::Player(const Scene& scene, const PlayOptions& options)
    : scene_(scene),
      options_(options),
      world_(with_precision(scene.world, options.precision)),
      settings_(scene.settings) {
  renew_steppers();
}

StepSettings Player::placed(StepSettings settings) const {
  settings.set_all(options_.place);
  settings.lanes = options_.lanes;
  settings.threads = options_.threads;
  settings.timings = false;
  if (!options_.mixed) return settings;
  (steps_ % 2 ? settings.integrate : settings.impulses) = Place::cpu;
  (steps_ % 3 ? settings.joints : settings.integrate) = Place::cpu;
  return settings;
}

void Player::renew_steppers() {
  steppers_.clear();
  for (std::uint32_t i = 0; i < options_.steppers; i++) {
    steppers_.emplace_back(placed(settings_));
    steppers_.back().set_trace(trace_);
  }
}

Status Player::configure() {
  Status ok;
  for (Stepper& stepper : steppers_) ok = stepper.configure(placed(settings_));
  return ok;
}

Status Player::change_steppers() {
  if (options_.fresh_every > 0 && steps_ > 0 && steps_ % options_.fresh_every == 0) {
    if (options_.restored)
      if (Status ok = world_.restore(world_.snapshot()); !ok) return ok;
    renew_steppers();
  }
  return options_.mixed ? configure() : Status{};
}

/// After the scene's own first objects, so that ids of these are the same with it and without. What is made later has
/// other ids, and colours follow ids: scenes that make bodies between steps are not compared in this way.
void Player::add_unrelated() {
  BodyDef plate, ball;
  plate.kind = BodyKind::fixed;
  plate.shapes = {ShapeDef::box({2, 0.5, 2})};
  plate.pose.position = {far_away, -0.5, far_away};
  ball.shapes = {ShapeDef::sphere(0.25)};
  (void)world_.create_body(plate);
  for (const double height : {0.3, 0.9}) {
    ball.pose.position = {far_away + 0.05 * height, height, far_away};
    (void)world_.create_body(ball);
  }
}

Status Player::step(double dt, Watcher* watcher, bool& go_on) {
  if (Status ok = change_steppers(); !ok) return ok;
  Stepper& stepper = steppers_[steps_++ % steppers_.size()];
  const auto start = std::chrono::steady_clock::now();
  const StepReport& report = stepper.step(world_, dt);
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (watcher) go_on = watcher->after_step(*this, dt, report);
  return report ? Status{} : Status(report.error);
}

Status Player::play(Watcher* watcher) {
  bool go_on = true, unrelated = !options_.unrelated;
  for (const Call& call : scene_.calls) {
    if (watcher) watcher->before_call(*this, call);
    const Status applied = std::visit(Apply{*this}, call);
    if (watcher) watcher->after_call(*this, call, applied);
    const Steps* steps = std::get_if<Steps>(&call);
    if (!steps) continue;
    if (!unrelated) add_unrelated();
    unrelated = true;
    for (int i = 0; i < steps->count && go_on; i++)
      if (Status ok = step(steps->dt, watcher, go_on); !ok) return ok;
    if (!go_on) break;
  }
  return {};
}

std::uint64_t Player::own_hash() const {
  std::uint64_t hash = 14695981039346656037ull;
  const auto add = [&](double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value == 0 ? 0.0 : value);
    for (int i = 0; i < 8; i++) hash = (hash ^ (bits >> (8 * i) & 0xff)) * 1099511628211ull;
  };
  for (const BodyId id : bodies_) {
    if (!world_.valid(id)) continue;
    const Pose pose = *world_.pose(id);
    const Vec3 v = *world_.velocity(id), l = *world_.angular_momentum(id);
    for (const double x : {pose.position.x, pose.position.y, pose.position.z, pose.orientation.x, pose.orientation.y,
                           pose.orientation.z, pose.orientation.w, v.x, v.y, v.z, l.x, l.y, l.z})
      add(x);
  }
  return hash;
}

}  // namespace pcphys::wild
