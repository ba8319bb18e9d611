// ODE: QuickStep (successive over-relaxation) or the world step (Dantzig's direct solver), double precision.
#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "engines.h"

namespace pcphys::peers {
namespace {

constexpr int points_a_pair = 8;
constexpr std::size_t most_direct_rows = 2000;  // of the direct step: about a second a step
constexpr double largest_middle_angle = 1.45;   // of three Euler angles [rad]: at pi / 2 they are singular

/// ODE's ways to end the process are thrown instead, and caught by `step`.
[[noreturn]] void give_up(int, const char* message, va_list arguments) {
  char text[300];
  std::vsnprintf(text, sizeof text, message, arguments);
  throw std::runtime_error(text);
}

/// ODE is set up once a process; the data of this thread too.
void set_up_ode() {
  dSetErrorHandler(give_up);
  dSetDebugHandler(give_up);
  dSetMessageHandler([](int, const char*, va_list) {});
  static const bool once = dInitODE2(0) != 0 && dAllocateODEDataForThread(dAllocateMaskAll) != 0;
  (void)once;
}

struct Contact {  // what a callback of ODE needs
  const Body* body = nullptr;
  const ShapeDef* shape = nullptr;
};

class Ode : public Peer {
 public:
  Ode(const Description& description, const Options& options, OdeStep how)
      : description_(description), how_(how), substeps_(std::max(1, options.substeps)) {
    set_up_ode();
    dRandSetSeed(0);  // QuickStep visits rows in a random order: the same in every run
    untranslated_ = description.untranslated;
    if (description.has_damping()) untranslated_.push_back(no_damping);
    world_ = dWorldCreate();
    moving_ = dHashSpaceCreate(nullptr);
    standing_ = dSimpleSpaceCreate(nullptr);
    contacts_ = dJointGroupCreate(0);
    dHashSpaceSetLevels(moving_, -3, 3);
    const Vec3 g = description.gravity;
    dWorldSetGravity(world_, g.x, g.y, g.z);
    dWorldSetAutoDisableFlag(world_, 0);
    if (options.iterations > 0) dWorldSetQuickStepNumIterations(world_, options.iterations);
    if (options.restitution_threshold) bounce_speed_ = *options.restitution_threshold;
    for (Body& body : description_.bodies) add_body(body);
    for (const Joint& joint : description_.joints) add_joint(joint);
  }

  ~Ode() override {
    // What gave up midway is left as it is: its spaces are locked, and to destroy one would give up in a destructor.
    if (gave_up_) return;
    dJointGroupDestroy(contacts_);
    dSpaceDestroy(moving_);
    dSpaceDestroy(standing_);
    dWorldDestroy(world_);
  }

  Status step(double dt) override {
    const double h = dt / substeps_;
    if (h != damped_for_) set_damping(h);
    try {
      for (int k = 0; k < substeps_; ++k)
        if (!substep(h)) return Error{ErrorCode::unavailable, "ODE had no memory for a step."};
    } catch (const std::runtime_error& error) {
      gave_up_ = true;
      return Error{ErrorCode::unavailable, std::string("ODE gave up: ") + error.what() + "."};
    }
    return {};
  }
  int substeps(double) const override { return substeps_; }
  int iterations() const override { return how_ == OdeStep::quick ? dWorldGetQuickStepNumIterations(world_) : 0; }

  Pose pose(std::size_t body) const override {
    if (!ids_[body]) return description_.bodies[body].pose;
    const dReal *p = dBodyGetPosition(ids_[body]), *q = dBodyGetQuaternion(ids_[body]);
    return {{p[0], p[1], p[2]}, {q[1], q[2], q[3], q[0]}};
  }
  Vec3 velocity(std::size_t body) const override {
    return vector(ids_[body] ? dBodyGetLinearVel(ids_[body]) : nullptr);
  }
  Vec3 angular_velocity(std::size_t body) const override {
    return vector(ids_[body] ? dBodyGetAngularVel(ids_[body]) : nullptr);
  }
  MassProperties mass_properties(std::size_t body) const override {
    if (!ids_[body]) return {};
    dMass mass;
    dBodyGetMass(ids_[body], &mass);
    return {mass.mass, {mass.I[0], mass.I[5], mass.I[10]}};
  }

  Status set_wrench(std::size_t body, const Wrench& wrench) override {
    change_wrench(description_.bodies, pushed_, body, wrench);
    return {};
  }
  Status set_gravity(Vec3 g) override {
    dWorldSetGravity(world_, g.x, g.y, g.z);
    return {};
  }
  Status set_velocity(std::size_t body, Vec3 v, Vec3 w) override {
    if (!ids_[body]) return {};
    dBodySetLinearVel(ids_[body], v.x, v.y, v.z);
    dBodySetAngularVel(ids_[body], w.x, w.y, w.z);
    return {};
  }

  std::size_t contacts() const override { return points_; }
  std::optional<double> deepest() const override { return deepest_; }

 private:
  static Vec3 vector(const dReal* v) { return v ? Vec3{v[0], v[1], v[2]} : Vec3{}; }

  bool substep(double h) {
    points_ = 0;
    deepest_ = 0;
    dJointGroupEmpty(contacts_);  // those of the last sub-step
    dSpaceCollide(moving_, this, near);
    dSpaceCollide2(reinterpret_cast<dGeomID>(moving_), reinterpret_cast<dGeomID>(standing_), this, near);
    for (std::size_t i : pushed_) {
      const Body& body = description_.bodies[i];
      dBodyAddForce(ids_[i], body.wrench.force.x, body.wrench.force.y, body.wrench.force.z);
      dBodyAddTorque(ids_[i], body.wrench.torque.x, body.wrench.torque.y, body.wrench.torque.z);
    }
    return (how_ == OdeStep::quick ? dWorldQuickStep(world_, h) : dWorldStep(world_, h)) != 0;
  }

  static void near(void* self, dGeomID a, dGeomID b) { static_cast<Ode*>(self)->touch(a, b); }

  void touch(dGeomID a, dGeomID b) {
    const dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
    if (body_a == body_b) return;
    const auto &first = *static_cast<const Contact*>(dGeomGetData(a)),
               &second = *static_cast<const Contact*>(dGeomGetData(b));
    if (!may_touch(first.shape->filter, second.shape->filter)) return;
    if (body_a && body_b && held_apart(body_a, body_b)) return;
    std::array<dContact, points_a_pair> points;
    const int count = dCollide(a, b, points_a_pair, &points[0].geom, sizeof(dContact));
    const Material &ma = first.body->material, &mb = second.body->material;
    const double restitution = 0.5 * (ma.restitution + mb.restitution);
    for (int i = 0; i < count; ++i) {
      dContact& point = points[std::size_t(i)];
      point.surface.mode = dContactApprox1 | (restitution > 0 ? dContactBounce : 0);
      point.surface.mu = std::sqrt(ma.kinetic_friction * mb.kinetic_friction);
      point.surface.bounce = restitution;
      point.surface.bounce_vel = bounce_speed_;
      dJointAttach(dJointCreateContact(world_, contacts_, &point), body_a, body_b);
      deepest_ = std::max(deepest_, double(point.geom.depth));
    }
    points_ += std::size_t(count);
  }

  /// By a joint whose bodies do not collide; such joints carry a mark.
  static bool held_apart(dBodyID a, dBodyID b) {
    for (int i = 0; i < dBodyGetNumJoints(a); ++i) {
      const dJointID joint = dBodyGetJoint(a, i);
      if (dJointGetType(joint) == dJointTypeContact || !dJointGetData(joint)) continue;
      if (dJointGetBody(joint, 0) == b || dJointGetBody(joint, 1) == b) return true;
    }
    return false;
  }

  dGeomID make_geom(const ShapeDef& shape, const Pose& pose, dSpaceID space) {
    switch (shape.kind) {
      case ShapeKind::sphere: return dCreateSphere(space, shape.size.x);
      case ShapeKind::capsule: return dCreateCapsule(space, shape.size.x, 2 * shape.size.y);
      case ShapeKind::cylinder: return dCreateCylinder(space, shape.size.x, 2 * shape.size.y);
      case ShapeKind::box: return dCreateBox(space, 2 * shape.size.x, 2 * shape.size.y, 2 * shape.size.z);
      case ShapeKind::hull:  // refused by make_ode
      case ShapeKind::plane: break;
    }
    const Vec3 up = rotate(pose.orientation, {0, 1, 0});
    return dCreatePlane(space, up.x, up.y, up.z, dot(up, pose.position));
  }

  void add_body(Body& body) {
    dBodyID id = nullptr;
    if (body.dynamic) {
      id = dBodyCreate(world_);
      dMass mass;
      dMassSetParameters(&mass, body.mass.mass, 0, 0, 0, body.mass.moments.x, body.mass.moments.y, body.mass.moments.z,
                         0, 0, 0);
      dBodySetMass(id, &mass);
      place(id, body.pose);
      dBodySetLinearVel(id, body.velocity.x, body.velocity.y, body.velocity.z);
      dBodySetAngularVel(id, body.angular_velocity.x, body.angular_velocity.y, body.angular_velocity.z);
    }
    if (body.pushed()) pushed_.push_back(ids_.size());
    ids_.push_back(id);
    for (const ShapeDef& shape : body.shapes) {
      if (shape.filter.mask == 0) continue;
      Pose local = shape.local;
      if (shape.kind == ShapeKind::capsule || shape.kind == ShapeKind::cylinder)  // ODE's axis is z
        local.orientation = local.orientation * axis_angle({1, 0, 0}, -0.5 * std::numbers::pi);
      const Pose stands = body.pose * local;
      const dGeomID geom = make_geom(shape, body.pose * shape.local, id ? moving_ : standing_);
      shapes_.push_back(std::make_unique<Contact>(Contact{&body, &shape}));
      dGeomSetData(geom, shapes_.back().get());
      const Quat q = id ? local.orientation : stands.orientation;
      const Vec3 p = id ? local.position : stands.position;
      const dQuaternion turn = {q.w, q.x, q.y, q.z};
      if (id) {
        dGeomSetBody(geom, id);
        dGeomSetOffsetPosition(geom, p.x, p.y, p.z);
        dGeomSetOffsetQuaternion(geom, turn);
      } else if (shape.kind != ShapeKind::plane) {
        dGeomSetPosition(geom, p.x, p.y, p.z);
        dGeomSetQuaternion(geom, turn);
      }
    }
  }

  static void place(dBodyID id, const Pose& pose) {
    const Quat q = pose.orientation;
    const dQuaternion turn = {q.w, q.x, q.y, q.z};
    dBodySetPosition(id, pose.position.x, pose.position.y, pose.position.z);
    dBodySetQuaternion(id, turn);
  }

  dBodyID id(int body) const { return body < 0 ? nullptr : ids_[std::size_t(body)]; }

  /// ODE takes anchors, axes and zero angles from where the bodies stand: one of them stands for a moment where the
  /// joint's frames coincide.
  void add_joint(const Joint& joint) {
    const int moved = b_moves(joint) ? joint.b : joint.a, other = b_moves(joint) ? joint.a : joint.b;
    const Pose& frame_moved = b_moves(joint) ? joint.frame_b : joint.frame_a;
    const Pose frame = description_.pose_of(other) * (b_moves(joint) ? joint.frame_a : joint.frame_b);
    place(id(moved), frame * inverse(frame_moved));
    make_joint(joint, frame);
    place(id(moved), description_.pose_of(moved));
  }

  bool b_moves(const Joint& joint) const { return description_.moves(joint.b); }

  void attach(dJointID id_of_joint, const Joint& joint) {
    dJointAttach(id_of_joint, id(joint.b), id(joint.a));
    dJointSetData(id_of_joint, joint.collide ? nullptr : this);  // the mark of `held_apart`
  }

  void make_joint(const Joint& joint, const Pose& frame) {
    const Vec3 at = frame.position, x = rotate(frame.orientation, {1, 0, 0});
    const auto angles = ranges(joint.freedom);
    switch (kind(joint.freedom)) {
      case JointKind::locked: {
        const dJointID fixed = dJointCreateFixed(world_, nullptr);
        attach(fixed, joint);
        dJointSetFixed(fixed);
        return;
      }
      case JointKind::hinge: {
        const dJointID hinge = dJointCreateHinge(world_, nullptr);
        attach(hinge, joint);
        dJointSetHingeAnchor(hinge, at.x, at.y, at.z);
        dJointSetHingeAxis(hinge, x.x, x.y, x.z);
        if (angles[0].free()) return;
        const AngleRange roll = b_moves(joint) ? angles[0] : -angles[0];
        dJointSetHingeParam(hinge, dParamLoStop, roll.lower);
        dJointSetHingeParam(hinge, dParamHiStop, roll.upper);
        return;
      }
      case JointKind::ball:
      case JointKind::cone_twist:
      case JointKind::angles: break;
    }
    const dJointID ball = dJointCreateBall(world_, nullptr);
    attach(ball, joint);
    dJointSetBallAnchor(ball, at.x, at.y, at.z);
    const double cone = joint.freedom.cone, twist = joint.freedom.twist;
    if (kind(joint.freedom) == JointKind::cone_twist)
      add_angles(joint, frame, {{{-twist, twist}, {-cone, cone}, {-cone, cone}}});
    else if (kind(joint.freedom) == JointKind::angles)
      add_angles(joint, frame, angles);
  }

  /// Three Euler angles: yaw about a's z axis, pitch about the axis between, roll about b's x axis. A cone becomes a
  /// pyramid, since they are limited one by one. ODE wants a body that moves first: b, or else a, for which all angles
  /// change their signs; pitch keeps it, since ODE's middle axis is the other two's product and turns around too.
  void add_angles(const Joint& joint, const Pose& frame, const std::array<AngleRange, 3>& angles) {
    const dJointID motor = dJointCreateAMotor(world_, nullptr);
    const Vec3 x = rotate(frame.orientation, {1, 0, 0}), z = rotate(frame.orientation, {0, 0, 1});
    const bool b_first = b_moves(joint);
    const Vec3 first = b_first ? x : z, last = b_first ? z : x;
    dJointAttach(motor, id(b_first ? joint.b : joint.a), id(b_first ? joint.a : joint.b));
    dJointSetAMotorMode(motor, dAMotorEuler);
    dJointSetAMotorAxis(motor, 0, 1, first.x, first.y, first.z);
    dJointSetAMotorAxis(motor, 2, 2, last.x, last.y, last.z);
    const auto limit = [&](int low, int high, AngleRange range, double most) {
      if (range.lower > -most)
        dJointSetAMotorParam(motor, low, range.lower);
      else if (most < std::numbers::pi)
        dJointSetAMotorParam(motor, low, -most);
      if (range.upper < most)
        dJointSetAMotorParam(motor, high, range.upper);
      else if (most < std::numbers::pi)
        dJointSetAMotorParam(motor, high, most);
    };
    limit(dParamLoStop, dParamHiStop, b_first ? angles[0] : -angles[2], std::numbers::pi);
    limit(dParamLoStop2, dParamHiStop2, angles[1], largest_middle_angle);
    limit(dParamLoStop3, dParamHiStop3, b_first ? angles[2] : -angles[0], std::numbers::pi);
  }

  /// ODE scales velocities by (1 - damping) a step.
  void set_damping(double h) {
    damped_for_ = h;
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      const Body& body = description_.bodies[i];
      if (!ids_[i] || (body.linear_drag == 0 && body.angular_drag == 0)) continue;
      dBodySetLinearDampingThreshold(ids_[i], 0);
      dBodySetAngularDampingThreshold(ids_[i], 0);
      dBodySetDamping(ids_[i], 1 - std::exp(-body.linear_drag * h), 1 - std::exp(-body.angular_drag * h));
    }
  }

  Description description_;
  OdeStep how_;
  int substeps_;
  double bounce_speed_ = 0.5;  // ODE has no default; pcphys's own [m/s]
  double damped_for_ = 0, deepest_ = 0;
  bool gave_up_ = false;  // in the middle of a step
  std::size_t points_ = 0;
  dWorldID world_;
  dSpaceID moving_, standing_;
  dJointGroupID contacts_;
  std::vector<dBodyID> ids_;         // by body; none of fixed ones
  std::vector<std::size_t> pushed_;  // by a constant force
  std::vector<std::unique_ptr<Contact>> shapes_;
};

/// Rows of contacts and joints, as piles of the scenes have them, if all of it stands together.
std::size_t expected_rows(const Description& description) {
  std::size_t rows = 0;
  for (std::size_t i = 0; i < description.bodies.size(); ++i) {
    if (!description.bodies[i].dynamic || !description.collides(i)) continue;
    for (const ShapeDef& shape : description.bodies[i].shapes)
      rows += shape.kind == ShapeKind::sphere || shape.kind == ShapeKind::capsule ? 6 : 24;
  }
  return rows + 3 * description.joints.size();
}

}  // namespace

std::string ode_version() { return dODE_VERSION; }

Result<std::unique_ptr<Peer>> make_ode(const Description& description, const Options& options, OdeStep step) {
  if (description.has_hulls()) return Error{ErrorCode::unavailable, "Hulls are not translated for ODE; leave it out."};
  const std::size_t rows = expected_rows(description);
  if (step == OdeStep::dantzig && rows > most_direct_rows)
    return Error{ErrorCode::unavailable,
                 "ODE's direct step takes time with the cube of its rows; this scene may have " + std::to_string(rows) +
                     ", and it runs up to " + std::to_string(most_direct_rows) + "."};
  return std::unique_ptr<Peer>(std::make_unique<Ode>(description, options, step));
}

}  // namespace pcphys::peers
