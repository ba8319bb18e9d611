// Pins C11 and C12: degenerate shapes and masses, and numbers that no physics can use, are refused by a named
// error that leaves the world as it was; extreme ones that are accepted stay with the body that has them.
#include <cstring>
#include <functional>

#include "support_physics.h"

using namespace physics;

namespace {

constexpr double dt = 1.0 / 60;

/// A floor, a stack of two boxes, a rolling ball and two pinned bodies: neighbours that must not notice.
struct Neighbours {
  Run run;
  std::vector<BodyId> bodies;
  JointId joint;
  std::size_t count = 0;

  explicit Neighbours(const Mode& mode) : run(mode, {0, -gravity, 0}, 4) {
    BodyDef floor;
    floor.kind = BodyKind::fixed;
    floor.shapes = {ShapeDef::plane()};
    add(floor);
    BodyDef def;
    def.shapes = {ShapeDef::box({0.5, 0.25, 0.5})};
    for (double y : {0.25, 0.75}) {
      def.pose.position = {0, y, 0};
      add(def);
    }
    def.shapes = {ShapeDef::sphere(0.3)};
    def.pose.position = {3, 0.3, 0};
    def.velocity = {1, 0, 0};
    add(def);
    def.velocity = {};
    def.shapes = {ShapeDef::capsule(0.1, 0.3)};
    def.pose.position = {-3, 3, 0};
    add(def);
    def.pose.position = {-3, 2, 0};
    add(def);
    JointDef pin;
    pin.a = bodies[4];
    pin.b = bodies[5];
    pin.frame_a.position = {0, -0.5, 0};
    pin.frame_b.position = {0, 0.5, 0};
    joint = *run.world.create_joint(pin);
    run.step(dt, 5);
    count = bodies.size();
  }
  void add(const BodyDef& def) { bodies.push_back(run.add(def)); }
  World& world() { return run.world; }

  /// All stored state of the neighbours, bit for bit.
  std::vector<double> state() const {
    std::vector<double> out;
    for (const char* name : {"displacement_rate", "angular_momentum", "phase", "position", "orientation", "position_low",
                             "orientation_low", "velocity_half_change", "momentum_half_change", "velocity_low", "momentum_low"}) {
      const PropertyView view = *run.world.view(name);
      for (std::size_t i = 0; i < count; i++)
        for (std::uint32_t c = 0; c < view.components; c++) out.push_back(view.at(*run.world.row_of(bodies[i]), c));
    }
    return out;
  }
};

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// What a world was told that never heard of the bad input.
std::vector<double> untouched(const Mode& mode, long steps) {
  Neighbours n(mode);
  n.run.step(dt, steps);
  return n.state();
}

template <class R> ErrorCode code(const R& result) { return result ? ErrorCode::none : result.error().code; }
template <class R> bool has_sentence(const R& result) {
  return !result && result.error().message.size() > 20 && result.error().message.back() == '.';
}

struct BadBody {
  const char* what;
  ErrorCode expected;
  std::function<void(BodyDef&)> spoil;
};

const BadBody bad_bodies[] = {
    {"sphere of radius 0", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(0)}; }},
    {"sphere of negative radius", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(-1)}; }},
    {"sphere of radius NaN", ErrorCode::not_finite, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(not_a_number)}; }},
    {"sphere of infinite radius", ErrorCode::not_finite, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(infinite)}; }},
    {"sphere too small for single precision", ErrorCode::degenerate_shape,
     [](BodyDef& d) { d.shapes = {ShapeDef::sphere(1e-30)}; }},
    {"sphere too large", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::sphere(1e30)}; }},
    {"box of zero edge", ErrorCode::degenerate_shape,
     [](BodyDef& d) {
       d.shapes = {ShapeDef::box({0.5, 0, 0.5})};
     }},
    {"flat box", ErrorCode::degenerate_shape,
     [](BodyDef& d) {
       d.shapes = {ShapeDef::box({0.5, 0.5, 1e-9})};
     }},
    {"box of negative edge", ErrorCode::degenerate_shape,
     [](BodyDef& d) {
       d.shapes = {ShapeDef::box({-0.5, 0.5, 0.5})};
     }},
    {"capsule of length 0", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::capsule(0.1, 0)}; }},
    {"capsule of radius 0", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::capsule(0, 0.1)}; }},
    {"cylinder of height 0", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::cylinder(0.1, 0)}; }},
    {"cylinder of radius 0", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::cylinder(0, 0.1)}; }},
    {"plane that moves", ErrorCode::degenerate_shape, [](BodyDef& d) { d.shapes = {ShapeDef::plane()}; }},
    {"shape at NaN in its body", ErrorCode::not_finite,
     [](BodyDef& d) {
       d.shapes[0].local.position.x = not_a_number;
       d.mass = 1;
       d.moments = Vec3{1, 1, 1};
     }},
    {"shape turned by no rotation", ErrorCode::not_unit_quaternion,
     [](BodyDef& d) {
       d.shapes[0].local.orientation = {0, 0, 0, 0};
       d.mass = 1;
       d.moments = Vec3{1, 1, 1};
     }},
    {"mass 0", ErrorCode::bad_mass, [](BodyDef& d) { d.mass = 0; }},
    {"negative mass", ErrorCode::bad_mass, [](BodyDef& d) { d.mass = -1; }},
    {"mass NaN", ErrorCode::not_finite, [](BodyDef& d) { d.mass = not_a_number; }},
    {"infinite mass", ErrorCode::not_finite, [](BodyDef& d) { d.mass = infinite; }},
    {"density 0", ErrorCode::bad_mass, [](BodyDef& d) { d.density = 0; }},
    {"negative density", ErrorCode::bad_mass, [](BodyDef& d) { d.density = -1; }},
    {"density NaN", ErrorCode::bad_mass, [](BodyDef& d) { d.density = not_a_number; }},
    {"zero inertia", ErrorCode::bad_mass,
     [](BodyDef& d) {
       d.mass = 1;
       d.moments = Vec3{0, 0, 0};
     }},
    {"one moment zero", ErrorCode::bad_mass,
     [](BodyDef& d) {
       d.mass = 1;
       d.moments = Vec3{1, 1, 0};
     }},
    {"negative moment", ErrorCode::bad_mass,
     [](BodyDef& d) {
       d.mass = 1;
       d.moments = Vec3{1, -1, 1};
     }},
    {"moments of no body", ErrorCode::bad_mass,
     [](BodyDef& d) {
       d.mass = 1;
       d.moments = Vec3{1, 1, 3};
     }},
    {"moment NaN", ErrorCode::not_finite,
     [](BodyDef& d) {
       d.mass = 1;
       d.moments = Vec3{1, not_a_number, 1};
     }},
    {"position NaN", ErrorCode::not_finite, [](BodyDef& d) { d.pose.position.y = not_a_number; }},
    {"position infinite", ErrorCode::not_finite, [](BodyDef& d) { d.pose.position.y = -infinite; }},
    {"position 1e30", ErrorCode::not_finite, [](BodyDef& d) { d.pose.position.y = 1e30; }},
    {"velocity NaN", ErrorCode::not_finite, [](BodyDef& d) { d.velocity.x = not_a_number; }},
    {"velocity 1e30", ErrorCode::not_finite, [](BodyDef& d) { d.velocity.x = 1e30; }},
    {"spin infinite", ErrorCode::not_finite, [](BodyDef& d) { d.angular_velocity.z = infinite; }},
    {"orientation NaN", ErrorCode::not_finite, [](BodyDef& d) { d.pose.orientation.w = not_a_number; }},
    {"orientation zero", ErrorCode::not_unit_quaternion,
     [](BodyDef& d) {
       d.pose.orientation = {0, 0, 0, 0};
     }},
    {"orientation of length 2", ErrorCode::not_unit_quaternion,
     [](BodyDef& d) {
       d.pose.orientation = {0, 0, 0, 2};
     }},
    {"restitution above 1", ErrorCode::bad_argument, [](BodyDef& d) { d.material.restitution = 1.1; }},
    {"restitution NaN", ErrorCode::not_finite, [](BodyDef& d) { d.material.restitution = not_a_number; }},
    {"negative friction", ErrorCode::bad_argument, [](BodyDef& d) { d.material.static_friction = -0.1; }},
    {"negative drag", ErrorCode::bad_argument, [](BodyDef& d) { d.linear_drag = -1; }},
    {"drag NaN", ErrorCode::not_finite, [](BodyDef& d) { d.angular_drag = not_a_number; }},
};

BodyDef good_body() {
  BodyDef def;
  def.shapes = {ShapeDef::box({0.2, 0.2, 0.2})};
  def.pose.position = {0, 5, 4};
  return def;
}

}  // namespace

TEST_CASE("C11: degenerate shapes and impossible masses are refused, and nobody notices") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Neighbours n(mode);
    const std::uint64_t hash = n.world().hash();
    const std::vector<std::byte> snapshot = n.world().snapshot();
    for (const BadBody& bad : bad_bodies) {
      CAPTURE(std::string(bad.what));
      BodyDef def = good_body();
      bad.spoil(def);
      const auto made = n.world().create_body(def);
      CHECK(code(made) == bad.expected);
      CHECK(has_sentence(made));
      CHECK(n.world().hash() == hash);
    }
    CHECK(n.world().snapshot() == snapshot);
    CHECK(n.world().body_count() == n.count);
    // mass properties that are set later are held to the same
    for (const MassProperties& m : {MassProperties{0, {1, 1, 1}}, MassProperties{-1, {1, 1, 1}}, MassProperties{1, {0, 1, 1}},
                                    MassProperties{1, {1, 1, 2.1}}})
      CHECK(code(n.world().set_mass_properties(n.bodies[1], m)) == ErrorCode::bad_mass);
    CHECK(code(n.world().set_mass_properties(n.bodies[1], {not_a_number, {1, 1, 1}})) == ErrorCode::not_finite);
    CHECK(n.world().hash() == hash);
    n.run.step(dt, 30);
    CHECK(same_bits(n.state(), untouched(mode, 30)));
  }
}

TEST_CASE("C12: NaN, infinity, 1e30 and quaternions that are no rotation are refused by every setter") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Neighbours n(mode);
    World& w = n.world();
    const BodyId id = n.bodies[1];
    const std::uint64_t hash = w.hash();
    const std::vector<std::byte> snapshot = w.snapshot();
    const Pose pose = *w.pose(id);
    for (double bad : {not_a_number, infinite, -infinite, 1e30, -1e30}) {
      CAPTURE(bad);
      for (const Vec3& v : {Vec3{bad, 0, 0}, Vec3{0, bad, 0}, Vec3{0, 0, bad}}) {
        CHECK(code(w.set_pose(id, {v, {}})) == ErrorCode::not_finite);
        CHECK(code(w.set_velocity(id, v)) == ErrorCode::not_finite);
        CHECK(code(w.set_angular_velocity(id, v)) == ErrorCode::not_finite);
        CHECK(code(w.set_position_last(id, v)) == ErrorCode::not_finite);
        CHECK(code(w.set_gravity(v)) == ErrorCode::not_finite);
        CHECK(code(w.add_force(id, Wrench{v, {}})) == ErrorCode::not_finite);
        CHECK(code(w.add_force(id, Wrench{{}, v})) == ErrorCode::not_finite);
        JointDef joint;
        joint.a = n.bodies[1];
        joint.b = n.bodies[3];
        joint.frame_a.position = v;
        CHECK(code(w.create_joint(joint)) == ErrorCode::not_finite);
      }
      CHECK(code(w.set_drag(id, bad, 0)) != ErrorCode::none);
      CHECK(code(w.set_drag(id, 0, bad)) != ErrorCode::none);
    }
    for (double bad : {not_a_number, infinite}) {
      CHECK(code(w.set_pose(id, {pose.position, {0, 0, bad, 1}})) == ErrorCode::not_finite);
      CHECK(code(w.set_orientation_last(id, {bad, 0, 0, 1})) == ErrorCode::not_finite);
      CHECK(code(w.set_material(id, {bad, 0.5, 0})) == ErrorCode::not_finite);
    }
    for (const Quat& q : {Quat{0, 0, 0, 0}, Quat{0, 0, 0, 2}, Quat{0.1, 0, 0, 1}, Quat{0, 1e-310, 0, 0}}) {
      CHECK(code(w.set_pose(id, {pose.position, q})) == ErrorCode::not_unit_quaternion);
      CHECK(code(w.set_orientation_last(id, q)) == ErrorCode::not_unit_quaternion);
    }
    AngleFreedom crossed = AngleFreedom::hinge(1, -1), nan = AngleFreedom::cone_and_twist(not_a_number, 1);
    JointDef joint;
    joint.a = n.bodies[1];
    joint.b = n.bodies[3];
    for (const AngleFreedom& freedom : {crossed, nan}) {
      joint.freedom = freedom;
      CHECK(code(w.create_joint(joint)) == ErrorCode::bad_joint);
    }
    CHECK(w.hash() == hash);
    CHECK(w.snapshot() == snapshot);
    n.run.step(dt, 30);
    CHECK(same_bits(n.state(), untouched(mode, 30)));
  }
}

TEST_CASE("C12: a time step of zero, below zero, NaN or infinity leaves the state bit for bit") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    Neighbours n(mode);
    const std::vector<std::byte> snapshot = n.world().snapshot();
    for (double bad : {0.0, -0.0, -1.0 / 60, not_a_number, infinite, -infinite}) {
      CAPTURE(bad);
      const StepReport& report = n.run.stepper.step(n.world(), bad);
      CHECK(report.error.code == ErrorCode::bad_time_step);
      CHECK(n.world().snapshot() == snapshot);
    }
    n.run.step(dt, 3);
    CHECK(same_bits(n.state(), untouched(mode, 3)));
  }
}

TEST_CASE("C12: a time step that is far too short or too long is refused, or leaves a world that goes on") {
  for (const Mode& mode : precisions())
    for (double extreme : {1e-310, 1e-40, 1e-30, 1e-20, 1e20, 1e30, 1e300}) {
      CAPTURE(mode.name());
      CAPTURE(extreme);
      Neighbours n(mode);
      const std::vector<std::byte> snapshot = n.world().snapshot();
      const bool made = bool(n.run.stepper.step(n.world(), extreme));
      if (!made) CHECK(n.world().snapshot() == snapshot);
      bool finite_state = true;
      for (double x : n.state()) finite_state &= std::isfinite(x);
      CHECK(finite_state);
    }
}

TEST_CASE("C12: a callback's NaN refuses the step, which leaves the state") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Neighbours n(mode);
    bool bad = true;
    const auto force = n.world().add_force(n.bodies[1], [&bad](const World&, BodyId) {
      return Wrench{{bad ? not_a_number : 0.0, 0, 0}, {}};
    });
    REQUIRE(force);
    const std::vector<std::byte> snapshot = n.world().snapshot();
    CHECK(n.run.stepper.step(n.world(), dt).error.code == ErrorCode::not_finite);
    CHECK(n.world().snapshot() == snapshot);
    bad = false;
    n.run.step(dt, 3);
    Neighbours never(mode);
    REQUIRE(never.world().add_force(never.bodies[1], [](const World&, BodyId) { return Wrench{}; }));
    never.run.step(dt, 3);
    CHECK(same_bits(n.state(), never.state()));
  }
}

namespace {

struct Extreme {
  const char* what;
  std::function<Status(World&, BodyId)> apply;
};

Status status(const Result<ForceId>& r) { return r ? Status() : Status(r.error()); }

/// Inputs that are accepted, however strange, since they are finite.
const Extreme extremes[] = {
    {"denormal velocity",
     [](World& w, BodyId b) {
       return w.set_velocity(b, {1e-310, -1e-310, 1e-40});
     }},
    {"denormal spin",
     [](World& w, BodyId b) {
       return w.set_angular_velocity(b, {1e-310, 0, 1e-40});
     }},
    {"denormal position",
     [](World& w, BodyId b) {
       return w.set_pose(b, {{1e-310, 50, 1e-40}, {}});
     }},
    {"denormal in a quaternion",
     [](World& w, BodyId b) {
       return w.set_pose(b, {{0, 50, 0}, {1e-310, 1e-40, 0, 1}});
     }},
    {"denormal force",
     [](World& w, BodyId b) {
       return status(w.add_force(b, Wrench{{1e-310, 0, 1e-40}, {0, 1e-310, 0}}));
     }},
    {"velocity 1e15 upwards",
     [](World& w, BodyId b) {
       return w.set_velocity(b, {0, 1e15, 0});
     }},
    {"spin 1e15",
     [](World& w, BodyId b) {
       return w.set_angular_velocity(b, {0, 1e15, 1e15});
     }},
    {"position 1e15",
     [](World& w, BodyId b) {
       return w.set_pose(b, {{1e15, 1e15, -1e15}, {}});
     }},
    {"force 1e15",
     [](World& w, BodyId b) {
       return status(w.add_force(b, Wrench{{0, 1e15, 0}, {}}));
     }},
    {"torque 1e15",
     [](World& w, BodyId b) {
       return status(w.add_force(b, Wrench{{}, {0, 1e15, 1e15}}));
     }},
    {"drag 1e15", [](World& w, BodyId b) { return w.set_drag(b, 1e15, 1e15); }},
    {"mass 1e-30",
     [](World& w, BodyId b) {
       return w.set_mass_properties(b, {1e-30, {1e-30, 1e-30, 1e-30}});
     }},
    {"mass 1e30",
     [](World& w, BodyId b) {
       return w.set_mass_properties(b, {1e30, {1e30, 1e30, 1e30}});
     }},
    {"mass 1e-300",
     [](World& w, BodyId b) {
       return w.set_mass_properties(b, {1e-300, {1e-300, 1e-300, 1e-300}});
     }},
    {"mass 1e300",
     [](World& w, BodyId b) {
       return w.set_mass_properties(b, {1e300, {1e300, 1e300, 1e300}});
     }},
};

}  // namespace

namespace {

/// Steps on beside a world that never had the extreme body. A refused step is fine, if it leaves all as it was.
bool step_beside(Neighbours& n, const Mode& mode, const char* what) {
  Neighbours alone(mode);
  for (int i = 0; i < 30; i++) {
    if (!n.run.stepper.step(n.world(), dt)) {
      MESSAGE(std::string(what) << ", " << mode.name() << ", step " << i << ": "
                                << n.run.stepper.step(n.world(), dt).error.message);
      CHECK(same_bits(n.state(), alone.state()));
      return false;
    }
    alone.run.step(dt);
    if (!same_bits(n.state(), alone.state())) {
      CHECK_MESSAGE(false, "the neighbours changed in step " << i);
      return false;
    }
  }
  return true;
}

BodyId add_extreme(Neighbours& n, const Extreme& extreme) {
  BodyDef def = good_body();
  def.pose.position = {0, 50, 0};
  const BodyId odd = n.run.add(def);
  const std::vector<double> before = n.state();
  const Status applied = extreme.apply(n.world(), odd);
  if (!applied) CHECK(has_sentence(applied));
  CHECK(same_bits(n.state(), before));
  return odd;
}

}  // namespace

TEST_CASE("C12: an extreme body that touches nobody changes no bit of the others") {
  for (const Mode& mode : precisions())
    for (const Extreme& extreme : extremes) {
      CAPTURE(mode.name());
      CAPTURE(std::string(extreme.what));
      Neighbours n(mode);
      add_extreme(n, extreme);
      step_beside(n, mode, extreme.what);
    }
}

// Angles beyond 3e4 rad a sub-step are cut off before their sine is taken.
TEST_CASE("C12: an extreme body stays finite itself") {
  for (const Mode& mode : precisions())
    for (const Extreme& extreme : extremes) {
      CAPTURE(mode.name());
      CAPTURE(std::string(extreme.what));
      Neighbours n(mode);
      const BodyId odd = add_extreme(n, extreme);
      for (int i = 0; i < 30; i++)
        if (!n.run.stepper.step(n.world(), dt)) break;
      const Pose pose = *n.world().pose(odd);
      CHECK((finite(pose.position) && finite(pose.orientation) && finite(*n.world().velocity(odd)) &&
             finite(*n.world().angular_velocity(odd))));
    }
}

// A speculative contact is none where the bodies slide past each other's extent before the gap would close.
TEST_CASE("C12: a fast body that flies past touches nobody") {
  for (const Mode& mode : precisions())
    for (double speed : {60.0, 200.0, 1000.0, 1e4, 1e9, 1e15}) {
      CAPTURE(mode.name());
      CAPTURE(speed);
      Neighbours n(mode);
      BodyDef def = good_body();
      def.pose.position = {-2, 2.5, 0};
      def.velocity = {speed, 0, 0};
      n.run.add(def);
      step_beside(n, mode, "flying past");
    }
}
