// Pins C12: extreme numbers that are accepted stay with the body that has them.
#include <functional>

#include "support_neighbours.h"

using namespace physics;

namespace {

constexpr double dt = frame;

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

// ---- frozen bodies --------------------------------------------------------------------------------------

namespace {

Status set_all_masses(World& w, BodyId b, double x) { return w.set_mass_properties(b, {x, {x, x, x}}); }

/// Inputs that are accepted one by one, and that no arithmetic survives together.
const Extreme impossible[] = {
    {"a force of 1e15 on 1e-30 kg",
     [](World& w, BodyId b) {
       const Status ok = set_all_masses(w, b, 1e-30);
       return ok ? status(w.add_force(b, Wrench{{1e15, 0, 0}, {}})) : ok;
     }},
    {"a torque of 1e15 on moments of 1e-30",
     [](World& w, BodyId b) {
       const Status ok = set_all_masses(w, b, 1e-30);
       return ok ? status(w.add_force(b, Wrench{{}, {0, 0, 1e15}})) : ok;
     }},
    {"a callback's force of 1e15 on 1e-30 kg",
     [](World& w, BodyId b) {
       const Status ok = set_all_masses(w, b, 1e-30);
       return ok ? status(w.add_force(b, [](const World&, BodyId) { return Wrench{{0, 1e15, 0}, {}}; })) : ok;
     }},
};

}  // namespace

TEST_CASE("C12: a body whose numbers leave the range is frozen and named, and nobody else notices") {
  for (const Mode& mode : everywhere())
    for (const Extreme& extreme : impossible) {
      CAPTURE(mode.name());
      CAPTURE(std::string(extreme.what));
      Neighbours n(mode), alone(mode);
      const BodyId odd = add_extreme(n, extreme);
      const Pose before = *n.world().pose(odd);
      for (int i = 0; i < 20; i++) {
        const StepReport& report = n.run.stepper.step(n.world(), dt);
        REQUIRE(report);
        CHECK(report.frozen == (i == 0 ? std::vector<BodyId>{odd} : std::vector<BodyId>{}));
        alone.run.step(dt);
        CHECK(same_bits(n.state(), alone.state()));
      }
      CHECK(*n.world().frozen(odd));
      CHECK_FALSE(*n.world().frozen(n.bodies[1]));
      CHECK(*n.world().pose(odd) == before);
      CHECK(*n.world().velocity(odd) == Vec3{});
    }
}

TEST_CASE("C12: a frozen body stands as a fixed one, and moves again when the host has mended it") {
  for (const Mode& mode : everywhere()) {
    CAPTURE(mode.name());
    Neighbours n(mode);
    BodyDef def = good_body();
    def.pose.position = {6, 1, 0};
    const BodyId odd = n.run.add(def);
    def.pose.position = {6, 1.5, 0};
    const BodyId on_top = n.run.add(def);
    const MassProperties mass = *n.world().mass_properties(odd);
    REQUIRE(n.world().set_mass_properties(odd, {1e-20, {1e-20, 1e-20, 1e-20}}));
    const ForceId force = *n.world().add_force(odd, Wrench{{1e15, 0, 0}, {}});
    n.run.step(dt, 60);
    CHECK(*n.world().frozen(odd));
    CHECK(std::fabs(n.run.position(on_top).y - 1.4) < 0.01);  // it has come to rest there
    // a snapshot knows it
    const std::vector<std::byte> snapshot = n.world().snapshot();
    const std::uint64_t hash = n.world().hash();
    REQUIRE(n.world().remove(force));
    REQUIRE(n.world().set_mass_properties(odd, mass));
    CHECK_FALSE(*n.world().frozen(odd));
    n.run.step(dt, 60);
    CHECK(std::fabs(n.run.position(odd).y - 0.2) < 0.01);
    REQUIRE(n.world().restore(snapshot));
    CHECK(*n.world().frozen(odd));
    CHECK(n.world().hash() == hash);
    n.run.step(dt);
    CHECK(n.run.position(odd).y == 1);
  }
}

// The joint tree may well hold what no free body would survive; if not, its bodies stand, and the rest goes on.
TEST_CASE("C12: a joint tree that cannot be computed leaves the others alone") {
  for (const Mode& mode : precisions()) {
    CAPTURE(mode.name());
    Neighbours n(mode), alone(mode);
    n.count = alone.count = 4;  // but for the chain
    REQUIRE(set_all_masses(n.world(), n.bodies[4], 1e-30));
    REQUIRE(n.world().add_force(n.bodies[4], Wrench{{1e15, 0, 0}, {}}));
    for (int i = 0; i < 60; i++) {
      REQUIRE(n.run.stepper.step(n.world(), dt));
      alone.run.step(dt);
      CHECK(same_bits(n.state(), alone.state()));
    }
    n.count = n.bodies.size();
    for (double x : n.state()) CHECK(std::isfinite(x));
  }
}
