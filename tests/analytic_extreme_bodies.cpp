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
