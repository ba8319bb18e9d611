// Bad calls that create, destroy and join objects, and of shapes alone.
#include <cmath>
#include <utility>

#include "support_bad_calls.h"

namespace worldtest {

Host::Host() {
  body = must(world.create_body(ball({0, 5, 0})));
  other = must(world.create_body(ball({3, 5, 0})));
  fixed = must(world.create_body(fixed_box({0, -20, 0}, {5, 1, 5})));
  BodyDef def = ball({6, 5, 0});
  def.rotates = false;
  point = must(world.create_body(def));
  def = ball({9, 5, 0});
  def.kind = BodyKind::kinematic;
  hand = must(world.create_body(def));
  gone_body = must(world.create_body(ball({50, 0, 0})));
  joint = must(world.create_joint(pin(body, {1.5, 0, 0}, other, {-1.5, 0, 0})));
  gone_joint = must(world.create_joint(pin(body, {0, 1, 0}, gone_body, {0, 1, 0})));
  SpringDef def_spring;
  def_spring.a = body, def_spring.b = other;
  spring = must(world.create_spring(def_spring));
  def_spring.b = gone_body;
  gone_spring = must(world.create_spring(def_spring));
  force = must(world.add_force(body, Wrench{{1, 0, 0}, {}}));
  gone_force = must(world.add_force(gone_body, Wrench{}));
  must(world.destroy(gone_body));
  fuel = must(world.add_property<Real>("fuel", 1, "kg"));
  gone_property = must(world.add_property<Real>("spent"));
  must(world.remove_property("spent"));
  cells = must(world.add_table("cells", 2));
  heat = must(world.add_property<Real>("heat", 0, "K", cells));
  gone_table = must(world.add_table("dropped"));
  must(world.remove(gone_table));
  run(world, stepper, 1);
  saved = world.snapshot();
  ready();
}

Error Host::within_step(const std::function<void()>& act) {
  int asked = 0;
  const ForceCallback callback = [&](const World&, BodyId) {
    if (asked++ == 0) act();
    return Wrench{};
  };
  const ForceId called = must(world.add_force(body, callback));
  const Error error = stepper.step(world, frame).error;
  must(world.remove(called));
  ready();
  return error;
}

namespace {

void add_body(BadCalls& calls, const char* wrong, ErrorCode code, const std::function<void(BodyDef&)>& spoil) {
  calls.push_back({"World::create_body", wrong, code, [=](Host& h) {
                     BodyDef def = ball({0, 50, 0});
                     spoil(def);
                     return error_of(h.world.create_body(def));
                   }});
}
void add_bodies(BadCalls& calls) {
  using enum ErrorCode;
  add_body(calls, "a position, velocity or drag that is NaN or beyond 1e15", not_finite,
           [](BodyDef& d) { d.pose.position.y = not_a_number; });
  add_body(calls, "an orientation that is NaN", not_finite, [](BodyDef& d) { d.pose.orientation.x = not_a_number; });
  add_body(calls, "an orientation that is not of unit length", not_unit_quaternion,
           [](BodyDef& d) { d.pose.orientation.w = 2; });
  add_body(calls, "a spin whose angular momentum is beyond 1e36", not_finite, [](BodyDef& d) {
    d.mass = 1e30;
    d.angular_velocity = {0, 1e10, 0};
  });
  add_body(calls, "a kind that is none", bad_argument, [](BodyDef& d) { d.kind = BodyKind(7); });
  add_body(calls, "a fixed body with a velocity", bad_argument, [](BodyDef& d) {
    d.kind = BodyKind::fixed;
    d.velocity.x = 1;
  });
  add_body(calls, "a fixed body with an angular velocity", bad_argument, [](BodyDef& d) {
    d.kind = BodyKind::fixed;
    d.angular_velocity.x = 1;
  });
  add_body(calls, "an angular velocity of a body that does not rotate", bad_argument, [](BodyDef& d) {
    d.rotates = false;
    d.angular_velocity.x = 1;
  });
  add_body(calls, "a drag below zero", bad_argument, [](BodyDef& d) { d.linear_drag = -1; });
  add_body(calls, "a coefficient of the material that is NaN", not_finite,
           [](BodyDef& d) { d.material.restitution = not_a_number; });
  add_body(calls, "friction below zero, restitution outside of 0 to 1, a rule that is none", bad_argument,
           [](BodyDef& d) { d.material.kinetic_friction = -1; });
  add_body(calls, "a mass, moment or length of a shape that is NaN", not_finite,
           [](BodyDef& d) { d.mass = not_a_number; });
  add_body(calls, "a dynamic body with a mass, moment or density of zero or below, or out of range", bad_mass,
           [](BodyDef& d) { d.mass = 0; });
  add_body(calls, "moments that no body has, or without a mass", bad_mass, [](BodyDef& d) {
    d.moments = Vec3{1, 1, 3};
  });
  add_body(calls, "a dynamic body without shapes or mass", bad_mass, [](BodyDef& d) { d.shapes.clear(); });
  add_body(calls, "several shapes, or a displaced one, without make_compound", bad_mass,
           [](BodyDef& d) { d.shapes[0].local.position.x = 1; });
  add_body(calls, "a shape smaller than 1e-5 m or larger than 1e6 m", degenerate_shape,
           [](BodyDef& d) { d.shapes[0].size.x = 0; });
  add_body(calls, "a plane on a body that is not fixed", degenerate_shape,
           [](BodyDef& d) { d.shapes[0] = ShapeDef::plane(); });
  add_body(calls, "a shape of kind hull without a hull", degenerate_shape,
           [](BodyDef& d) { d.shapes[0].kind = ShapeKind::hull; });
  add_body(calls, "a shape of no known kind", bad_argument, [](BodyDef& d) { d.shapes[0].kind = ShapeKind(9); });
}

void add_joint(BadCalls& calls, const char* wrong, ErrorCode code,
               const std::function<void(const Host&, JointDef&)>& spoil) {
  calls.push_back({"World::create_joint", wrong, code, [=](Host& h) {
                     JointDef def = pin(h.body, {1.5, 0, 0}, h.other, {-1.5, 0, 0});
                     spoil(h, def);
                     return error_of(h.world.create_joint(def));
                   }});
}
void add_joints(BadCalls& calls) {
  using enum ErrorCode;
  add_joint(calls, "a body that is not there", stale_id, [](const Host& h, JointDef& d) { d.b = h.gone_body; });
  add_joint(calls, "twice the same body", bad_joint, [](const Host&, JointDef& d) { d.b = d.a; });
  add_joint(calls, "two bodies of which none is dynamic", bad_joint, [](const Host& h, JointDef& d) {
    d.a = h.fixed;
    d.b = h.hand;
  });
  add_joint(calls, "a body that does not rotate", bad_joint, [](const Host& h, JointDef& d) { d.b = h.point; });
  add_joint(calls, "a pin that is NaN", not_finite,
            [](const Host&, JointDef& d) { d.frame_a.position.x = not_a_number; });
  add_joint(calls, "a frame that is not of unit length", not_unit_quaternion,
            [](const Host&, JointDef& d) { d.frame_b.orientation.w = 2; });
  add_joint(calls, "an angle that is NaN, or a lower one above the upper one", bad_joint,
            [](const Host&, JointDef& d) { d.freedom = AngleFreedom::hinge(1, -1); });
  add_joint(calls, "a freedom of no known kind", bad_joint,
            [](const Host&, JointDef& d) { d.freedom.kind = AngleFreedom::Kind(9); });
  add_joint(calls, "restitution of its limits outside of 0 to 1", bad_joint,
            [](const Host&, JointDef& d) { d.freedom.restitution = 2; });
  add_joint(calls, "a motor's torque, or a spring's stiffness or damping, below zero", bad_joint,
            [](const Host&, JointDef& d) { d.motor.torque = -1; });
  add_joint(calls, "a motor's speed, or a stiffness, that is NaN", not_finite,
            [](const Host&, JointDef& d) { d.motor.speed = not_a_number; });
  add_joint(calls, "a largest force that is NaN, zero or below", bad_joint,
            [](const Host&, JointDef& d) { d.largest_force = 0; });
}

void add_spring(BadCalls& calls, const char* wrong, ErrorCode code,
                const std::function<void(const Host&, SpringDef&)>& spoil) {
  calls.push_back({"World::create_spring", wrong, code, [=](Host& h) {
                     SpringDef def;
                     def.a = h.body, def.b = h.other;
                     spoil(h, def);
                     return error_of(h.world.create_spring(def));
                   }});
}
void add_springs(BadCalls& calls) {
  using enum ErrorCode;
  add_spring(calls, "a body that is not there", stale_id, [](const Host& h, SpringDef& d) { d.a = h.gone_body; });
  add_spring(calls, "twice the same body", bad_joint, [](const Host&, SpringDef& d) { d.b = d.a; });
  add_spring(calls, "two bodies of which none is dynamic", bad_joint, [](const Host& h, SpringDef& d) {
    d.a = h.fixed;
    d.b = h.hand;
  });
  add_spring(calls, "an anchor, length, stiffness or damping that is NaN", not_finite,
             [](const Host&, SpringDef& d) { d.stiffness = not_a_number; });
  add_spring(calls, "a rest length, stiffness or damping below zero", bad_joint,
             [](const Host&, SpringDef& d) { d.damping = -1; });
}

void add_grabs(BadCalls& calls) {
  using enum ErrorCode;
  const char* grab = "World::grab";
  calls.push_back({grab, "a point that is NaN", not_finite, [](Host& h) {
                     return error_of(h.world.grab(h.hand, h.body, {not_a_number, 0, 0}));
                   }});
  calls.push_back({grab, "a body that is not there", stale_id,
                   [](Host& h) { return error_of(h.world.grab(h.hand, h.gone_body, {})); }});
  calls.push_back({grab, "a hand that is not kinematic, or what it grabs not dynamic", bad_joint,
                   [](Host& h) { return error_of(h.world.grab(h.body, h.other, {})); }});
  calls.push_back({grab, "a body that does not rotate", bad_joint,
                   [](Host& h) { return error_of(h.world.grab(h.hand, h.point, {})); }});
}

void add_ragdoll(BadCalls& calls, const char* wrong, ErrorCode code,
                 const std::function<void(RagdollDef&, Pose&)>& spoil) {
  calls.push_back({"World::create_ragdoll", wrong, code, [=](Host& h) {
                     RagdollDef def = RagdollDef::human();
                     Pose pose{{0, 100, 0}, {}};
                     spoil(def, pose);
                     return error_of(h.world.create_ragdoll(def, pose));
                   }});
}
void add_ragdolls(BadCalls& calls) {
  using enum ErrorCode;
  add_ragdoll(calls, "a pose, or anything of a bone, that is NaN", not_finite,
              [](RagdollDef&, Pose& p) { p.position.x = not_a_number; });
  add_ragdoll(calls, "an orientation that is not of unit length", not_unit_quaternion,
              [](RagdollDef&, Pose& p) { p.orientation.w = 3; });
  add_ragdoll(calls, "a bone before its parent, or limits that no joint has", bad_joint,
              [](RagdollDef& d, Pose&) { d.bones[1].parent = 5; });
  add_ragdoll(calls, "a bone's shape that no body has", degenerate_shape,
              [](RagdollDef& d, Pose&) { d.bones[1].shape.size.x = 0; });
  add_ragdoll(calls, "a density of zero or below, or out of range", bad_mass,
              [](RagdollDef& d, Pose&) { d.density = 0; });
  add_ragdoll(calls, "a material that no body has", bad_argument,
              [](RagdollDef& d, Pose&) { d.material.restitution = 2; });
}

void add_destroyed(BadCalls& calls) {
  using enum ErrorCode;
  calls.push_back({"World::destroy", "a body that is not there", stale_id,
                   [](Host& h) { return error_of(h.world.destroy(h.gone_body)); }});
  calls.push_back({"World::destroy", "a joint that is not there", stale_id,
                   [](Host& h) { return error_of(h.world.destroy(h.gone_joint)); }});
  calls.push_back({"World::destroy", "a spring that is not there", stale_id,
                   [](Host& h) { return error_of(h.world.destroy(h.gone_spring)); }});
  calls.push_back({"World::destroy", "a list with a body that is not there, or twice the same", stale_id, [](Host& h) {
                     const BodyId list[] = {h.body, h.other, h.body};
                     return error_of(h.world.destroy(list));
                   }});
  calls.push_back({"World::destroy", "the ground", bad_argument,
                   [](Host& h) { return error_of(h.world.destroy(h.world.ground())); }});
  calls.push_back({"World::shrink", "while a step runs", busy, [](Host& h) {
                     Error error;
                     (void)h.within_step([&] { error = error_of(h.world.shrink()); });
                     return error;
                   }});
}

}  // namespace

void add_bad_objects(BadCalls& calls) {
  add_bodies(calls);
  add_joints(calls);
  add_springs(calls);
  add_grabs(calls);
  add_ragdolls(calls);
  add_destroyed(calls);
}

void add_bad_shapes(BadCalls& calls) {
  using enum ErrorCode;
  const auto add = [&](const char* function, const char* wrong, ErrorCode code, std::function<Error(Host&)> call) {
    calls.push_back({function, wrong, code, std::move(call), false});
  };
  const char *mass = "mass_properties", *compound = "make_compound", *hull = "make_hull";
  add(mass, "a length or place that is NaN", not_finite,
      [](Host&) { return error_of(mass_properties(ShapeDef::sphere(not_a_number), 1)); });
  add(mass, "a shape that is too small or large, or a hull without one", degenerate_shape,
      [](Host&) { return error_of(mass_properties(ShapeDef::sphere(1e7), 1)); });
  add(mass, "a shape of no known kind", bad_argument, [](Host&) {
    ShapeDef shape;
    shape.kind = ShapeKind(9);
    return error_of(mass_properties(shape, 1));
  });
  add(mass, "a density out of range, or a plane", bad_mass,
      [](Host&) { return error_of(mass_properties(ShapeDef::sphere(1), 0)); });
  const auto add_compound = [&](const char* wrong, ErrorCode code, const std::function<void(BodyDef&)>& spoil) {
    add(compound, wrong, code, [=](Host&) {
      BodyDef def = ball({});
      def.shapes.push_back(ShapeDef::sphere(1));
      spoil(def);
      return error_of(make_compound(def));
    });
  };
  add_compound("no shapes, or one that is too small or large", degenerate_shape, [](BodyDef& d) { d.shapes.clear(); });
  add_compound("a position, length or mass that is NaN", not_finite,
               [](BodyDef& d) { d.pose.position.x = not_a_number; });
  add_compound("an orientation that is not of unit length", not_unit_quaternion,
               [](BodyDef& d) { d.pose.orientation.w = 0; });
  add_compound("a mass or density out of range, or a plane", bad_mass, [](BodyDef& d) { d.density = -1; });
  add_compound("a shape of no known kind", bad_argument, [](BodyDef& d) { d.shapes[0].kind = ShapeKind(9); });
  const auto add_hull = [&](const char* wrong, ErrorCode code, std::vector<Vec3> points) {
    add(hull, wrong, code, [=](Host&) { return error_of(make_hull(points)); });
  };
  add_hull("a point that is NaN", not_finite, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, not_a_number}});
  add_hull("fewer than four points, points in a plane, or further apart than 2e6 m", degenerate_shape,
           {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  std::vector<Vec3> many;
  for (int i = 0; i < 100; i++) many.push_back({std::cos(0.0628 * i), std::sin(0.0628 * i), i % 2 - 0.5});
  add_hull("more vertices than 64", buffer_full, many);
}

}  // namespace worldtest
