// Bullet: sequential impulses, in the single precision that Debian's headers default to.
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engines.h"

namespace pcphys::peers {
namespace {

btVector3 to_bullet(Vec3 v) { return {btScalar(v.x), btScalar(v.y), btScalar(v.z)}; }
btQuaternion to_bullet(Quat q) { return {btScalar(q.x), btScalar(q.y), btScalar(q.z), btScalar(q.w)}; }
btTransform to_bullet(const Pose& pose) { return btTransform(to_bullet(pose.orientation), to_bullet(pose.position)); }
Vec3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btScalar mean_restitution(const btCollisionObject* a, const btCollisionObject* b) {
  return btScalar(0.5) * (a->getRestitution() + b->getRestitution());
}
btScalar geometric_friction(const btCollisionObject* a, const btCollisionObject* b) {
  return btSqrt(a->getFriction() * b->getFriction());
}

std::unique_ptr<btCollisionShape> make_shape(const ShapeDef& shape) {
  switch (shape.kind) {
    case ShapeKind::sphere: return std::make_unique<btSphereShape>(btScalar(shape.size.x));
    case ShapeKind::capsule:
      return std::make_unique<btCapsuleShape>(btScalar(shape.size.x), btScalar(2 * shape.size.y));
    case ShapeKind::cylinder:
      return std::make_unique<btCylinderShape>(to_bullet(Vec3{shape.size.x, shape.size.y, shape.size.x}));
    case ShapeKind::box: return std::make_unique<btBoxShape>(to_bullet(shape.size));
    case ShapeKind::hull: {
      auto hull = std::make_unique<btConvexHullShape>();
      for (const Vec3& v : shape.convex.vertices()) hull->addPoint(to_bullet(v), false);
      hull->recalcLocalAabb();
      return hull;
    }
    case ShapeKind::plane: break;
  }
  return std::make_unique<btStaticPlaneShape>(btVector3(0, 1, 0), btScalar(0));
}

btDefaultCollisionConstructionInfo pools(std::size_t bodies) {
  btDefaultCollisionConstructionInfo info;  // large enough that nothing falls back to the heap
  info.m_defaultMaxPersistentManifoldPoolSize = std::max(4096, int(bodies) * 16);
  info.m_defaultMaxCollisionAlgorithmPoolSize = info.m_defaultMaxPersistentManifoldPoolSize;
  return info;
}

/// Filters as pcphys has them (a body's filter is that of its first shape); what cannot move does not touch its like.
struct Filters : btOverlapFilterCallback {
  const std::vector<Body>* bodies = nullptr;

  const Body& body(const btBroadphaseProxy* proxy) const {
    return (*bodies)[std::size_t(static_cast<const btCollisionObject*>(proxy->m_clientObject)->getUserIndex())];
  }
  bool needBroadphaseCollision(btBroadphaseProxy* proxy_a, btBroadphaseProxy* proxy_b) const override {
    const Body &a = body(proxy_a), &b = body(proxy_b);
    return (a.dynamic || b.dynamic) && !a.shapes.empty() && !b.shapes.empty() &&
           may_touch(a.shapes.front().filter, b.shapes.front().filter);
  }
};

class Bullet : public Peer {
 public:
  Bullet(const Description& description, const Options& options)
      : bodies_(description.bodies),
        substeps_(std::max(1, options.substeps)),
        sleeps_(options.sleep),
        configuration_(pools(description.bodies.size())),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broad_phase_, &solver_, &configuration_) {
    gCalculateCombinedRestitutionCallback = mean_restitution;
    gCalculateCombinedFrictionCallback = geometric_friction;
    untranslated_ = description.untranslated;
    if (description.has_damping()) untranslated_.push_back(no_damping);
    world_.setGravity(to_bullet(description.gravity));
    if (options.iterations > 0) world_.getSolverInfo().m_numIterations = options.iterations;
    if (options.restitution_threshold)
      world_.getSolverInfo().m_restitutionVelocityThreshold = btScalar(*options.restitution_threshold);
    filters_.bodies = &bodies_;
    broad_phase_.getOverlappingPairCache()->setOverlapFilterCallback(&filters_);
    for (std::size_t i = 0; i < bodies_.size(); ++i) add_body(i);
    for (const Joint& joint : description.joints) add_joint(joint);
  }

  ~Bullet() override {
    for (const auto& joint : joints_) world_.removeConstraint(joint.get());
    for (const auto& body : rigid_) world_.removeRigidBody(body.get());
  }

  Status step(double dt) override {
    for (int k = 0; k < substeps_; ++k) {
      for (std::size_t i : pushed_) {
        rigid_[i]->applyCentralForce(to_bullet(bodies_[i].wrench.force));
        rigid_[i]->applyTorque(to_bullet(bodies_[i].wrench.torque));
      }
      world_.stepSimulation(btScalar(dt / substeps_), 0);
    }
    return {};
  }
  int substeps(double) const override { return substeps_; }
  int iterations() const override { return world_.getSolverInfo().m_numIterations; }

  Pose pose(std::size_t body) const override {
    const btQuaternion q = rigid_[body]->getWorldTransform().getRotation();
    return {from_bullet(rigid_[body]->getWorldTransform().getOrigin()), {q.x(), q.y(), q.z(), q.w()}};
  }
  Vec3 velocity(std::size_t body) const override { return from_bullet(rigid_[body]->getLinearVelocity()); }
  Vec3 angular_velocity(std::size_t body) const override { return from_bullet(rigid_[body]->getAngularVelocity()); }
  MassProperties mass_properties(std::size_t body) const override {
    return {rigid_[body]->getMass(), from_bullet(rigid_[body]->getLocalInertia())};
  }

  Status set_wrench(std::size_t body, const Wrench& wrench) override {
    change_wrench(bodies_, pushed_, body, wrench);
    return {};
  }
  Status set_gravity(Vec3 gravity) override {
    world_.setGravity(to_bullet(gravity));  // of the bodies too
    return {};
  }
  Status set_velocity(std::size_t body, Vec3 velocity, Vec3 angular_velocity) override {
    rigid_[body]->setLinearVelocity(to_bullet(velocity));
    rigid_[body]->setAngularVelocity(to_bullet(angular_velocity));
    return {};
  }

  std::size_t contacts() const override {
    std::size_t count = 0;
    for_each_point([&](const btManifoldPoint&) { ++count; });
    return count;
  }
  std::optional<double> deepest() const override {
    double depth = 0;
    for_each_point([&](const btManifoldPoint& point) { depth = std::max(depth, -double(point.getDistance())); });
    return depth;
  }

 private:
  template <class Action> void for_each_point(Action action) const {
    for (int m = 0; m < dispatcher_.getNumManifolds(); ++m) {
      const btPersistentManifold* manifold = dispatcher_.getManifoldByIndexInternal(m);
      for (int p = 0; p < manifold->getNumContacts(); ++p) action(manifold->getContactPoint(p));
    }
  }

  /// One shape at the body's origin as it is, others as a compound; none: a body that touches nothing.
  btCollisionShape* shape_of(const Body& body) {
    if (body.shapes.size() == 1 && body.shapes[0].local == Pose{}) {
      shapes_.push_back(make_shape(body.shapes[0]));
      return shapes_.back().get();
    }
    if (body.shapes.empty()) {
      shapes_.push_back(std::make_unique<btEmptyShape>());
      return shapes_.back().get();
    }
    auto compound = std::make_unique<btCompoundShape>();
    for (const ShapeDef& shape : body.shapes) {
      shapes_.push_back(make_shape(shape));
      compound->addChildShape(to_bullet(shape.local), shapes_.back().get());
    }
    shapes_.push_back(std::move(compound));
    return shapes_.back().get();
  }

  void add_body(std::size_t index) {
    const Body& body = bodies_[index];
    btRigidBody::btRigidBodyConstructionInfo info(body.dynamic ? btScalar(body.mass.mass) : 0, nullptr, shape_of(body),
                                                  to_bullet(body.dynamic ? body.mass.moments : Vec3{}));
    info.m_startWorldTransform = to_bullet(body.pose);
    info.m_friction = btScalar(body.material.kinetic_friction);
    info.m_restitution = btScalar(body.material.restitution);
    info.m_linearDamping = btScalar(1 - std::exp(-body.linear_drag));  // its velocities are scaled by (1 - damping)^dt
    info.m_angularDamping = btScalar(1 - std::exp(-body.angular_drag));
    rigid_.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& rigid = *rigid_.back();
    rigid.setUserIndex(int(index));
    rigid.setLinearVelocity(to_bullet(body.velocity));
    rigid.setAngularVelocity(to_bullet(body.angular_velocity));
    if (!sleeps_) rigid.setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(&rigid);
    if (body.pushed()) pushed_.push_back(index);
  }

  btRigidBody& rigid(int body) { return body < 0 ? btTypedConstraint::getFixedBody() : *rigid_[std::size_t(body)]; }

  void add_joint(const Joint& joint) {
    joints_.push_back(make_joint(joint));
    world_.addConstraint(joints_.back().get(), !joint.collide);
  }

  std::unique_ptr<btTypedConstraint> make_joint(const Joint& joint) {
    btRigidBody &a = rigid(joint.a), &b = rigid(joint.b);
    const btTransform frame_a = to_bullet(joint.frame_a), frame_b = to_bullet(joint.frame_b);
    switch (kind(joint.freedom)) {
      case JointKind::ball:
        return std::make_unique<btPoint2PointConstraint>(a, b, frame_a.getOrigin(), frame_b.getOrigin());
      case JointKind::cone_twist: {
        auto cone = std::make_unique<btConeTwistConstraint>(a, b, frame_a, frame_b);
        cone->setLimit(btScalar(joint.freedom.cone), btScalar(joint.freedom.cone), btScalar(joint.freedom.twist));
        return cone;
      }
      case JointKind::hinge: {
        // Bullet turns about z: its frames are ours with x put there.
        const btTransform x_to_z(to_bullet(axis_angle({0, 1, 0}, 0.5 * std::numbers::pi)));
        auto hinge = std::make_unique<btHingeConstraint>(a, b, frame_a * x_to_z, frame_b * x_to_z, true);
        const AngleRange roll = ranges(joint.freedom)[0];
        if (!roll.free()) hinge->setLimit(btScalar(roll.lower), btScalar(roll.upper));
        return hinge;
      }
      case JointKind::locked:
      case JointKind::angles: break;
    }
    auto six = std::make_unique<btGeneric6DofSpring2Constraint>(a, b, frame_a, frame_b, RO_XYZ);
    six->setLinearLowerLimit({0, 0, 0});
    six->setLinearUpperLimit({0, 0, 0});
    const auto angles = ranges(joint.freedom);
    for (int axis = 0; axis < 3; ++axis) {
      const AngleRange range = angles[std::size_t(axis)];  // Bullet's angles are those of a relative to b
      six->setLimit(3 + axis, range.free() ? 1 : btScalar(-range.upper), range.free() ? -1 : btScalar(-range.lower));
    }
    return six;
  }

  std::vector<Body> bodies_;
  int substeps_;
  bool sleeps_;
  Filters filters_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  mutable btDiscreteDynamicsWorld world_;  // its getters of settings are not const
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> rigid_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
  std::vector<std::size_t> pushed_;  // by a constant force
};

}  // namespace

std::string bullet_version() {
  const int version = btGetVersion();
  return std::to_string(version / 100) + "." + std::to_string(version % 100);
}

Result<std::unique_ptr<Peer>> make_bullet(const Description& description, const Options& options) {
  return std::unique_ptr<Peer>(std::make_unique<Bullet>(description, options));
}

}  // namespace pcphys::peers
