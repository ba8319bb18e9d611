#include "wild/simplify.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace pcphys::wild {
namespace {

struct Made {
  const OnObject& tell;

  void operator()(const MakeBody& c) const { tell(Object::body, c.body); }
  void operator()(const MakeJoint& c) const { tell(Object::joint, c.joint); }
  void operator()(const MakeSpring& c) const { tell(Object::spring, c.spring); }
  void operator()(const MakeRagdoll& c) const {
    for (std::size_t i = 0; i < c.def.bones.size(); i++) tell(Object::body, c.first_body + int(i));
    for (std::size_t i = 0; i + 1 < c.def.bones.size(); i++) tell(Object::joint, c.first_joint + int(i));
  }
  void operator()(const AddForce& c) const { tell(Object::force, c.force); }
  template <class Other> void operator()(const Other&) const {}
};

template <class C>
concept OfBody = requires(const C c) {
  c.body;
};
template <class C>
concept OfTwo = requires(const C c) {
  c.a;
  c.b;
};
template <class C>
concept OfJoint = requires(const C c) {
  c.joint;
};
template <class C>
concept OfSpring = requires(const C c) {
  c.spring;
};

struct Named {
  const OnObject& tell;

  void operator()(const MakeBody&) const {}
  void operator()(const Destroy& c) const { tell(c.object, c.number); }
  template <class C> void operator()(const C& c) const {
    if constexpr (OfTwo<C>) {
      if (c.a != ground) tell(Object::body, c.a);
      if (c.b != ground) tell(Object::body, c.b);
    } else if constexpr (OfBody<C>) {
      if (c.body != ground) tell(Object::body, c.body);
    } else if constexpr (OfJoint<C>) {
      tell(Object::joint, c.joint);
    } else if constexpr (OfSpring<C>) {
      tell(Object::spring, c.spring);
    }
  }
};

using Objects = std::set<std::pair<Object, int>>;

/// Steps that follow each other at one dt are one call.
bool join(const Call& call, std::vector<Call>& calls) {
  const Steps* steps = std::get_if<Steps>(&call);
  Steps* last = calls.empty() ? nullptr : std::get_if<Steps>(&calls.back());
  if (!steps || !last || steps->dt != last->dt) return false;
  last->count += steps->count;
  return true;
}

void keep_rules_of(const Objects& there, Rules& rules) {
  const auto gone = [&](int body) { return !there.contains({Object::body, body}); };
  std::erase_if(rules.untouched, gone);
  std::erase_if(rules.gliding, gone);
}

}  // namespace

void each_made(const Call& call, const OnObject& tell) { std::visit(Made{tell}, call); }
void each_named(const Call& call, const OnObject& tell) { std::visit(Named{tell}, call); }

Scene without(const Scene& scene, const std::vector<bool>& out) {
  Scene left = scene;
  left.calls.clear();
  Objects there;
  for (std::size_t i = 0; i < scene.calls.size(); i++) {
    const Call& call = scene.calls[i];
    bool stays = !out[i];
    each_named(call, [&](Object object, int number) { stays = stays && there.contains({object, number}); });
    if (!stays) continue;
    each_made(call, [&](Object object, int number) { there.emplace(object, number); });
    if (!join(call, left.calls)) left.calls.push_back(call);
  }
  keep_rules_of(there, left.rules);
  return left;
}

std::uint64_t count_steps(const Scene& scene) {
  std::uint64_t sum = 0;
  for (const Call& call : scene.calls)
    if (const Steps* steps = std::get_if<Steps>(&call)) sum += std::uint64_t(steps->count);
  return sum;
}

Scene cut(const Scene& scene, std::uint64_t steps) {
  Scene left = scene;
  left.calls.clear();
  for (const Call& call : scene.calls) {
    if (steps == 0) break;
    left.calls.push_back(call);
    Steps* last = std::get_if<Steps>(&left.calls.back());
    if (!last) continue;
    last->count = int(std::min(std::uint64_t(last->count), steps));
    steps -= std::uint64_t(last->count);
  }
  return left;
}

// ---- a later start -------------------------------------------------------------------------------------------

namespace {

/// Joints that are further apart at a later start would make energy as they close [m].
constexpr double closed_joint = 1e-5;

bool only_makes(const Call& call) {
  return std::holds_alternative<MakeBody>(call) || std::holds_alternative<MakeJoint>(call) ||
         std::holds_alternative<MakeSpring>(call) || std::holds_alternative<AddForce>(call) ||
         std::holds_alternative<Configure>(call) || std::holds_alternative<SetFilter>(call) ||
         std::holds_alternative<SetCollide>(call);
}

auto first_steps(Scene& scene) {
  return std::find_if(scene.calls.begin(), scene.calls.end(),
                      [](const Call& call) { return std::holds_alternative<Steps>(call); });
}

/// Stops after so many steps.
class Stop : public Watcher {
 public:
  explicit Stop(int steps) : left_(steps) {}
  void after_call(const Player&, const Call&, const Status& status) override { refused_ = refused_ || !status; }
  bool after_step(const Player&, double, const StepReport&) override { return --left_ > 0; }
  bool refused() const { return refused_; }

 private:
  int left_;
  bool refused_ = false;
};

}  // namespace

std::optional<Scene> later_start(const Scene& scene, const PlayOptions& options, int steps) {
  Scene later = scene;
  const auto first = first_steps(later);
  if (first == later.calls.end() || !std::all_of(later.calls.begin(), first, only_makes)) return std::nullopt;
  if (steps < 1 || std::get<Steps>(*first).count <= steps) return std::nullopt;
  Player player(scene, options);
  Stop stop(steps);
  if (!player.play(&stop) || stop.refused()) return std::nullopt;
  for (const JointId joint : player.world().joints())
    if (*player.world().joint_separation(joint) > closed_joint) return std::nullopt;
  for (auto call = later.calls.begin(); call != first; ++call) {
    MakeBody* make = std::get_if<MakeBody>(&*call);
    if (!make) continue;
    const BodyId id = player.body(make->body);
    const auto pose = player.world().pose(id);
    if (!pose || !finite(pose->position) || *player.world().frozen(id)) return std::nullopt;
    make->def.pose = *pose;
    make->def.velocity = *player.world().velocity(id);
    make->def.angular_velocity = *player.world().angular_velocity(id);
  }
  std::get<Steps>(*first).count -= steps;
  return later;
}

double deepest_overlap(const Scene& scene) {
  Scene still = scene;
  still.world.gravity = {};
  still.settings = {};
  still.calls.erase(first_steps(still), still.calls.end());
  for (Call& call : still.calls)
    if (MakeBody* make = std::get_if<MakeBody>(&call)) make->def.velocity = make->def.angular_velocity = {};
  // So short a step moves nothing, and finds what touches.
  still.calls.push_back(Steps{1, 1e-9});
  Player player(still, PlayOptions{.precision = Precision::f64});
  (void)player.play();
  double deepest = 0;
  for (const Contact& contact : player.world().contacts())
    for (const Contact::Point& point : contact.points) deepest = std::max(deepest, -point.separation);
  return deepest;
}

// ---- simpler calls -------------------------------------------------------------------------------------------

namespace {

template <class T> bool change(T& value, const T& simpler) {
  if (value == simpler) return false;
  value = simpler;
  return true;
}
/// All of them were made, whichever was the first to change something.
template <class... Changed> bool any(Changed... changed) { return (changed || ...); }

template <class C> C* of(Call& call) { return std::get_if<C>(&call); }

/// To this many significant digits.
double rounded(double value, int digits) {
  if (value == 0 || !std::isfinite(value)) return value;
  const double scale = std::pow(10.0, digits - 1 - int(std::floor(std::log10(std::fabs(value)))));
  return std::isfinite(scale) ? std::round(value * scale) / scale : value;
}
Vec3 rounded(Vec3 v, int digits) { return {rounded(v.x, digits), rounded(v.y, digits), rounded(v.z, digits)}; }

bool rest(Call& call) {
  if (MakeRagdoll* make = of<MakeRagdoll>(call)) return change(make->velocity, Vec3{});
  MakeBody* make = of<MakeBody>(call);
  return make && change(make->def.velocity, Vec3{});
}
bool no_spin(Call& call) {
  MakeBody* make = of<MakeBody>(call);
  return make && change(make->def.angular_velocity, Vec3{});
}
bool upright(Call& call) {
  if (MakeRagdoll* make = of<MakeRagdoll>(call)) return change(make->pose.orientation, Quat{});
  MakeBody* make = of<MakeBody>(call);
  return make && change(make->def.pose.orientation, Quat{});
}
bool plain_material(Call& call) {
  MakeBody* make = of<MakeBody>(call);
  if (!make) return false;
  const Material usual;
  Material& m = make->def.material;
  const bool friction =
      any(change(m.static_friction, usual.static_friction), change(m.kinetic_friction, usual.kinetic_friction));
  const bool levers = any(change(m.rolling_friction, 0.0), change(m.torsional_friction, 0.0));
  const bool rules =
      any(change(m.friction_rule, usual.friction_rule), change(m.restitution_rule, usual.restitution_rule));
  return any(friction, levers, rules, change(m.restitution, usual.restitution));
}
bool plain_body(Call& call) {
  MakeBody* make = of<MakeBody>(call);
  if (!make) return false;
  BodyDef& def = make->def;
  const bool drag = any(change(def.linear_drag, 0.0), change(def.angular_drag, 0.0));
  return any(drag, change(def.density, 1000.0), change(def.can_sleep, true));
}
bool no_motor(Call& call) {
  MakeJoint* make = of<MakeJoint>(call);
  return make && any(change(make->def.motor.speed, 0.0), change(make->def.motor.torque, 0.0));
}
bool no_joint_spring(Call& call) {
  MakeJoint* make = of<MakeJoint>(call);
  return make && any(change(make->def.spring.stiffness, 0.0), change(make->def.spring.damping, 0.0));
}
bool pin_alone(Call& call) {
  MakeJoint* make = of<MakeJoint>(call);
  if (!make || make->def.freedom.kind == AngleFreedom::Kind::free) return false;
  make->def.freedom = {};
  return true;
}
bool undamped(Call& call) {
  MakeSpring* make = of<MakeSpring>(call);
  return make && change(make->def.damping, 0.0);
}
template <int digits> bool round_motion(Call& call) {
  MakeBody* make = of<MakeBody>(call);
  if (!make) return false;
  return any(change(make->def.velocity, rounded(make->def.velocity, digits)),
             change(make->def.angular_velocity, rounded(make->def.angular_velocity, digits)));
}
template <int digits> bool round_position(Call& call) {
  MakeBody* make = of<MakeBody>(call);
  return make && change(make->def.pose.position, rounded(make->def.pose.position, digits));
}
template <int digits> bool round_size(Call& call) {
  MakeBody* make = of<MakeBody>(call);
  if (!make || make->def.moments) return false;
  bool changed = false;
  for (ShapeDef& shape : make->def.shapes) changed = any(change(shape.size, rounded(shape.size, digits)), changed);
  return changed;
}
template <int digits> bool round_material(Call& call) {
  MakeBody* make = of<MakeBody>(call);
  if (!make) return false;
  Material& m = make->def.material;
  bool changed = change(make->def.density, rounded(make->def.density, digits));
  for (double* value :
       {&m.static_friction, &m.kinetic_friction, &m.restitution, &m.rolling_friction, &m.torsional_friction})
    changed = any(change(*value, rounded(*value, digits)), changed);
  return changed;
}

constexpr Simplification list[] = {{Changes::motion, rest},
                                   {Changes::motion, no_spin},
                                   {Changes::place, upright},
                                   {Changes::surface, plain_material},
                                   {Changes::motion, plain_body},
                                   {Changes::motion, no_motor},
                                   {Changes::motion, no_joint_spring},
                                   {Changes::motion, pin_alone},
                                   {Changes::motion, undamped},
                                   {Changes::motion, round_motion<2>},
                                   {Changes::motion, round_motion<4>},
                                   {Changes::place, round_size<2>},
                                   {Changes::place, round_size<4>},
                                   {Changes::place, round_position<2>},
                                   {Changes::place, round_position<4>},
                                   {Changes::surface, round_material<2>}};

}  // namespace

std::span<const Simplification> simplifications() { return list; }

std::optional<Scene> without_corner(const Scene& scene, std::size_t call, std::size_t corner) {
  Scene simpler = scene;
  MakeBody* make = of<MakeBody>(simpler.calls[call]);
  if (!make || make->def.shapes.size() != 1 || make->def.moments) return std::nullopt;
  ShapeDef& shape = make->def.shapes[0];
  const std::span<const Vec3> all = shape.convex.vertices();
  if (shape.kind != ShapeKind::hull || !(shape.local == Pose{}) || all.size() <= 4 || corner >= all.size())
    return std::nullopt;
  bool named = false;
  for (const Call& other : scene.calls)
    each_named(other,
               [&](Object object, int number) { named = named || (object == Object::body && number == make->body); });
  if (named) return std::nullopt;
  std::vector<Vec3> corners(all.begin(), all.end());
  corners.erase(corners.begin() + std::ptrdiff_t(corner));
  const auto hull = make_hull(corners);
  if (!hull) return std::nullopt;
  Pose& pose = make->def.pose;
  pose = {transform(pose, hull->frame().position), pose.orientation * hull->frame().orientation};
  shape.convex = *hull;
  return simpler;
}

}  // namespace pcphys::wild
