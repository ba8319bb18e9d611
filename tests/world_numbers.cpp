// Pins that whatever numbers a world accepts, all that it tells is finite after the call and after steps, in single and
// double precision, and that a refused call leaves it as it was. The impulses that contacts and joints remember are not
// asked for: in single precision those of light bodies at 1e16 m/s may be NaN (docs/limits.md).
#include <array>
#include <cfloat>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "support_world.h"
#include "wild/dice.h"

using namespace worldtest;

namespace {

using pcphys::finite;
bool finite(double x) { return std::isfinite(x); }
bool finite(const Pose& p) { return finite(p.position) && finite(p.orientation); }
bool finite(const MassProperties& m) { return finite(m.mass) && finite(m.moments); }
bool finite(const Material& m) {
  return finite(m.static_friction + m.kinetic_friction + m.restitution + m.rolling_friction + m.torsional_friction);
}
bool finite(const ShapeDef& s) { return finite(s.size) && finite(s.local); }
bool finite(const Motor& m) { return finite(m.speed) && finite(m.torque); }
bool finite(const AngularSpring& s) { return finite(s.stiffness) && finite(s.damping) && finite(s.rest); }
bool finite(const SpringDef& s) {
  return finite(s.anchor_a) && finite(s.anchor_b) && finite(s.rest_length + s.stiffness + s.damping);
}
/// Limits may be infinite, and the largest force: then there is none.
bool finite(const JointDef& j) {
  const AngleFreedom& f = j.freedom;
  for (double x : {f.cone, f.twist, f.lower.x, f.lower.y, f.lower.z, f.upper.x, f.upper.y, f.upper.z, j.largest_force})
    if (std::isnan(x)) return false;
  return finite(j.frame_a) && finite(j.frame_b) && finite(f.restitution) && finite(j.motor) && finite(j.spring);
}
bool finite(const Contact& c) {
  bool all = finite(c.normal);
  for (const Contact::Point& p : c.points) all &= finite(p.position) && finite(p.separation);
  return all;
}

/// The name of what a world tells that is not finite, or nothing.
std::string not_finite(const World& world, bool stepped) {
  if (!finite(world.gravity())) return "gravity";
  if (!finite(world.kinetic_energy())) return "kinetic energy";
  if (!finite(world.potential_energy())) return "potential energy";
  if (!finite(world.spring_energy())) return "spring energy";
  if (!finite(world.momentum())) return "momentum";
  if (!finite(world.angular_momentum())) return "angular momentum";
  for (const BodyId body : world.bodies()) {
    if (!finite(must(world.pose(body)))) return "pose";
    if (!finite(must(world.velocity(body)))) return "velocity";
    if (!finite(must(world.angular_velocity(body)))) return "angular velocity";
    if (!finite(must(world.angular_momentum(body)))) return "angular momentum of a body";
    if (!finite(must(world.mass_properties(body)))) return "mass";
    if (!finite(must(world.material(body)))) return "material";
    for (const ShapeDef& shape : must(world.shapes(body)))
      if (!finite(shape)) return "shape";
    if (stepped && !finite(must(world.position_last(body)))) return "last position";
    if (stepped && !finite(must(world.orientation_last(body)))) return "last orientation";
  }
  for (const JointId joint : world.joints()) {
    if (!finite(must(world.joint(joint)))) return "joint";
    if (!finite(must(world.joint_separation(joint)))) return "separation of a joint";
  }
  for (const SpringId spring : world.springs())
    if (!finite(must(world.spring(spring)))) return "spring";
  for (const Contact& contact : world.contacts())
    if (!finite(contact)) return "contact";
  for (const PropertyInfo& info : world.properties()) {
    if (info.role == Role::scratch || info.name.ends_with("_impulse")) continue;
    const PropertyView view = must(world.view(info.name));
    for (std::size_t row = 0; row < view.count; row++)
      for (std::uint32_t c = 0; c < view.components; c++)
        if (!finite(double(view.at(row, c)))) return "property " + std::string(info.name);
  }
  return {};
}

/// Calls a world at random.
class Caller {
 public:
  Caller(Precision precision, std::uint64_t seed) : world_({precision}), dice_("numbers", seed) {
    for (int i = 0; i < 3; i++) (void)world_.create_body(ball({3.0 * i, 1, 0}));
    (void)world_.create_body(fixed_box({0, -1, 0}, {20, 1, 20}));
  }

  void run(int calls) {
    for (int i = 0; i < calls; i++) {
      wildness_ = dice_.between(0, 0.6);
      one_call(dice_.one_of(28));
      const std::string odd = not_finite(world_, stepped_);
      CHECK_MESSAGE(odd.empty(), odd << " after " << said_ << ", call " << i);
      if (!odd.empty()) return;
    }
  }
  int accepted = 0, refused = 0;

 private:
  // ---- numbers -----------------------------------------------------------------------------------------
  double any() {
    constexpr double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    constexpr std::array odd{
        0.0,    -0.0, nan,    inf,   -inf, DBL_MAX, DBL_MIN, 5e-324, double(FLT_MAX), double(FLT_MIN), 1e15, -1e15,
        1.1e15, 1e30, -1e-30, 1e-30, 1e9,  1e6,     1e-5,    1e38};
    if (dice_.chance(0.2)) return dice_.one_of(std::span<const double>(odd));
    const double sign = dice_.chance(0.5) ? 1 : -1;
    if (dice_.chance(0.3)) return sign * std::exp(dice_.between(std::log(5e-324), std::log(DBL_MAX)));
    return sign * dice_.by_ratio(1e-31, 1e31);
  }
  double number() { return dice_.chance(wildness_) ? any() : dice_.between(-10, 10); }
  double size() { return dice_.chance(wildness_) ? std::fabs(any()) : dice_.between(0.1, 10); }
  double share() { return dice_.chance(0.1 * wildness_) ? any() : dice_.between(0, 1); }
  Vec3 vector() {
    const double scale = dice_.chance(0.5) ? number() : 1;
    Vec3 v;
    for (double* x : {&v.x, &v.y, &v.z}) *x = dice_.chance(0.2) ? number() : scale * dice_.between(-1, 1);
    return v;
  }
  Quat turn() {
    Quat q = dice_.orientation();
    if (dice_.chance(0.1 * wildness_)) q.y = any();
    return q;
  }
  Pose pose() { return {vector(), turn()}; }
  /// Of some body, more often than by chance.
  MassProperties mass() {
    const double one = size();
    const double moments = dice_.chance(0.5) ? one : size();
    return {one, {moments, moments * dice_.between(0.5, 1.2), moments * dice_.between(0.6, 1.1)}};
  }
  Material material() {
    Material m{size(), size(), share()};
    if (dice_.chance(0.3)) m.rolling_friction = size();
    if (dice_.chance(0.3)) m.torsional_friction = size();
    m.friction_rule = Combine(dice_.one_of(5));
    return m;
  }
  ShapeDef shape() {
    ShapeDef s{ShapeKind(dice_.one_of(4)), {size(), size(), size()}, {}, {}};
    if (dice_.chance(0.05)) s = ShapeDef::plane();
    if (dice_.chance(0.1)) s.size.z = any();
    return s;
  }
  BodyDef body() {
    BodyDef def;
    def.kind = BodyKind(std::array{0, 1, 2, 2, 2, 2}[std::size_t(dice_.one_of(6))]);
    def.pose = pose();
    def.shapes = {shape()};
    def.density = dice_.chance(0.3) ? size() : 1000;
    if (def.kind != BodyKind::fixed) def.velocity = vector();
    if (def.kind != BodyKind::fixed) def.angular_velocity = vector();
    if (dice_.chance(0.3)) def.mass = size();
    if (dice_.chance(0.3)) {
      const MassProperties m = mass();
      def.mass = m.mass;
      def.moments = m.moments;
    }
    if (dice_.chance(0.3)) def.material = material();
    if (dice_.chance(0.2)) def.linear_drag = size();
    if (dice_.chance(0.2)) def.angular_drag = size();
    if (dice_.chance(0.1)) def.rotates = false;
    return def;
  }
  AngleFreedom freedom() {
    AngleFreedom f{AngleFreedom::Kind(dice_.one_of(3)), size(), size(), vector(), vector(), share()};
    if (dice_.chance(0.5)) f = AngleFreedom::hinge();
    if (dice_.chance(0.3)) f = AngleFreedom::cone_and_twist(size(), size());
    return f;
  }
  Motor motor() { return {number(), size()}; }
  AngularSpring spring() { return {size(), size(), turn()}; }

  // ---- objects -----------------------------------------------------------------------------------------
  template <class Id> Id one(const std::vector<Id>& ids) {
    return ids.empty() ? Id{} : ids[std::size_t(dice_.one_of(int(ids.size())))];
  }
  BodyId a_body() { return one(world_.bodies()); }
  BodyId an_end() { return dice_.chance(0.2) ? world_.ground() : a_body(); }
  JointDef joint() {
    JointDef def;
    def.a = an_end();
    def.b = a_body();
    def.frame_a = pose();
    def.frame_b = pose();
    def.freedom = freedom();
    if (dice_.chance(0.3)) def.motor = motor();
    if (dice_.chance(0.3)) def.spring = spring();
    if (dice_.chance(0.2)) def.largest_force = size();
    return def;
  }

  // ---- calls -------------------------------------------------------------------------------------------
  template <class Call> void ask(const char* what, Call call) {
    said_ = what;
    const Fingerprint before = fingerprint(world_);
    const auto answer = call();
    accepted += bool(answer);
    refused += !answer;
    if (answer) return;
    CHECK_MESSAGE((fingerprint(world_) == before),
                  "a refused " << what << " changed the world: " << answer.error().message);
    CHECK(answer.error().message.back() == '.');
  }

  void make_body() {
    if (world_.body_count() > 12) return ask("destroy", [&] { return world_.destroy(a_body()); });
    BodyDef def = body();
    if (dice_.chance(0.3)) {
      for (int i = dice_.one_of(3); i > 0; i--) def.shapes.push_back(shape());
      for (ShapeDef& s : def.shapes) s.local = pose();
      if (make_compound(def)) {
        CHECK(finite(MassProperties{*def.mass, *def.moments}));
        CHECK(finite(def.pose));
        for (const ShapeDef& s : def.shapes) CHECK(finite(s));
      }
    }
    ask("create_body", [&] { return world_.create_body(def); });
  }
  void make_ragdoll() {
    RagdollDef def = RagdollDef::human();
    def.density = size();
    def.material = material();
    if (dice_.chance(0.5)) def.set_damping(size());
    if (dice_.chance(0.3)) def.bones[std::size_t(dice_.one_of(12))].joint = vector();
    const Pose at = pose();
    const Vec3 velocity = vector();
    if (world_.body_count() < 6) ask("create_ragdoll", [&] { return world_.create_ragdoll(def, at, velocity); });
  }
  void step() {
    const double dt = dice_.chance(0.7) ? frame : dice_.chance(0.5) ? dice_.by_ratio(1e-15, 1e3) : std::fabs(any());
    said_ = "step of " + std::to_string(dt) + " s";
    if (stepper_.step(world_, dt)) stepped_ = true;
  }
  template <class T> void own(const char* name, const T& value) {
    if (!world_.property<T>(name)) ask("add_property", [&] { return world_.add_property<T>(name, value); });
    if (const auto property = world_.property<T>(name))
      ask("set", [&] { return world_.set(*property, a_body(), value); });
  }
  void set_of_body(int which, BodyId b) {
    switch (which) {
      case 0: return ask("set_pose", [&, p = pose()] { return world_.set_pose(b, p); });
      case 1: return ask("set_velocity", [&, v = vector()] { return world_.set_velocity(b, v); });
      case 2: return ask("set_angular_velocity", [&, v = vector()] { return world_.set_angular_velocity(b, v); });
      case 3: return ask("set_position_last", [&, v = vector()] { return world_.set_position_last(b, v); });
      case 4: return ask("set_orientation_last", [&, q = turn()] { return world_.set_orientation_last(b, q); });
      case 5: return ask("set_mass_properties", [&, m = mass()] { return world_.set_mass_properties(b, m); });
      case 6: return ask("set_material", [&, m = material()] { return world_.set_material(b, m); });
      case 7: return ask("set_drag", [&, x = size(), y = size()] { return world_.set_drag(b, x, y); });
      case 8: return ask("add_force", [&, f = Wrench{vector(), vector()}] { return world_.add_force(b, f); });
      default:
        return ask("turn in place", [&, q = dice_.orientation()] {
          return world_.set_pose(b, {must(world_.pose(b)).position, q});
        });
    }
  }
  void set_of_joint(int which) {
    const JointId j = one(world_.joints());
    switch (which) {
      case 0: return ask("create_joint", [&, def = joint()] { return world_.create_joint(def); });
      case 1: return ask("set_motor", [&, m = motor()] { return world_.set_motor(j, m); });
      case 2: return ask("set_spring", [&, s = spring()] { return world_.set_spring(j, s); });
      case 3:
        return ask("create_spring", [&, s = SpringDef{an_end(), a_body(), vector(), vector(), size(), size(), size()}] {
          return world_.create_spring(s);
        });
      case 4:
        return ask("set_spring", [&, x = size(), y = size(), z = size()] {
          return world_.set_spring(one(world_.springs()), x, y, z);
        });
      case 5: return ask("grab", [&, v = vector()] { return world_.grab(a_body(), a_body(), v); });
      default: return ask("destroy", [&] { return world_.destroy(j); });
    }
  }
  void one_call(int which) {
    if (!world_.bodies().empty() && which < 10) return set_of_body(which, a_body());
    if (which >= 10 && which < 17) return set_of_joint(which - 10);
    switch (which) {
      case 17:
      case 18: return make_body();
      case 19: return make_ragdoll();
      case 20: return ask("set_gravity", [&, v = vector()] { return world_.set_gravity(v); });
      case 21: return own<Real>("one", number());
      case 22: return own<float>("single", float(number()));
      case 23: return own<Vec3>("three", vector());
      case 24: {
        const auto made = mass_properties(shape(), size());
        CHECK((!made || finite(*made)));
        return;
      }
      default: return step();
    }
  }

  World world_;
  Stepper stepper_;
  wild::Dice dice_;
  double wildness_ = 0;
  bool stepped_ = false;
  std::string said_;
};

}  // namespace

TEST_CASE("numbers: what a world accepts reads back finite, whatever the calls") {
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    int accepted = 0, refused = 0;
    for (std::uint64_t seed = 0; seed < 100; seed++) {
      CAPTURE(seed);
      CAPTURE(int(precision));
      Caller caller(precision, seed);
      caller.run(100);
      accepted += caller.accepted;
      refused += caller.refused;
    }
    CHECK(accepted > 4000);
    CHECK(refused > 1500);
    MESSAGE(accepted << " calls accepted, " << refused << " refused");
  }
}
