#ifdef PCPHYS_HAVE_BULLET
#include "bullet_world.h"

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <map>

namespace pcphys::bench {
namespace {

btVector3 to_bullet(Vec3 v) { return {btScalar(v.x), btScalar(v.y), btScalar(v.z)}; }
btQuaternion to_bullet(Quat q) { return {btScalar(q.x), btScalar(q.y), btScalar(q.z), btScalar(q.w)}; }
btTransform to_bullet(const Pose& pose) { return btTransform(to_bullet(pose.orientation), to_bullet(pose.position)); }

btScalar mean_restitution(const btCollisionObject* a, const btCollisionObject* b) {
  return btScalar(0.5) * (a->getRestitution() + b->getRestitution());
}
btScalar geometric_friction(const btCollisionObject* a, const btCollisionObject* b) {
  return btSqrt(a->getFriction() * b->getFriction());
}

std::unique_ptr<btCollisionShape> make_shape(const ShapeDef& shape) {
  switch (shape.kind) {
    case ShapeKind::sphere: return std::make_unique<btSphereShape>(btScalar(shape.size.x));
    case ShapeKind::capsule: return std::make_unique<btCapsuleShape>(btScalar(shape.size.x), btScalar(2 * shape.size.y));
    case ShapeKind::cylinder: return std::make_unique<btCylinderShape>(to_bullet(Vec3{shape.size.x, shape.size.y, shape.size.x}));
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

}  // namespace

struct BulletWorld::Inside {
  explicit Inside(std::size_t bodies)
      : configuration(pools(bodies)), dispatcher(&configuration), world(&dispatcher, &broad_phase, &solver, &configuration) {}
  ~Inside() {
    for (const auto& joint : joints) world.removeConstraint(joint.get());
    for (const auto& body : bodies) world.removeRigidBody(body.get());
  }

  void add_body(const scenes::SceneBody& description, const World& source) {
    const MassProperties mass = *source.mass_properties(description.id);
    const bool dynamic = description.kind == BodyKind::dynamic;
    shapes.push_back(make_shape(description.shape));
    btRigidBody::btRigidBodyConstructionInfo info(dynamic ? btScalar(mass.mass) : 0, nullptr, shapes.back().get(),
                                                  to_bullet(dynamic ? mass.moments : Vec3{}));
    info.m_startWorldTransform = to_bullet(description.start);
    const Material material = *source.material(description.id);
    info.m_friction = btScalar(material.static_friction);
    info.m_restitution = btScalar(material.restitution);
    info.m_linearDamping = info.m_angularDamping = 0;
    bodies.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& body = *bodies.back();
    body.setLinearVelocity(to_bullet(*source.velocity(description.id)));
    body.setAngularVelocity(to_bullet(*source.angular_velocity(description.id)));
    body.setActivationState(DISABLE_DEACTIVATION);
    if (description.shape.filter.mask == 0)
      world.addRigidBody(&body, 1, 0);
    else
      world.addRigidBody(&body);
    by_id[description.id] = &body;
  }

  void add_joint(const JointDef& joint, BodyId ground) {
    btRigidBody& b = *by_id.at(joint.b);
    if (joint.a == ground) {
      joints.push_back(std::make_unique<btPoint2PointConstraint>(b, to_bullet(joint.frame_b.position)));
    } else if (joint.freedom.kind == AngleFreedom::Kind::cone_twist) {
      auto cone =
          std::make_unique<btConeTwistConstraint>(*by_id.at(joint.a), b, to_bullet(joint.frame_a), to_bullet(joint.frame_b));
      cone->setLimit(btScalar(joint.freedom.cone), btScalar(joint.freedom.cone), btScalar(joint.freedom.twist));
      joints.push_back(std::move(cone));
    } else {
      joints.push_back(std::make_unique<btPoint2PointConstraint>(*by_id.at(joint.a), b, to_bullet(joint.frame_a.position),
                                                                 to_bullet(joint.frame_b.position)));
    }
    world.addConstraint(joints.back().get(), true);  // true: the two do not collide
  }

  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  btDbvtBroadphase broad_phase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world;
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<std::unique_ptr<btTypedConstraint>> joints;
  std::map<BodyId, btRigidBody*> by_id;
};

BulletWorld::BulletWorld(const scenes::Scene& scene, const World& world)
    : inside_(std::make_unique<Inside>(scene.bodies.size())) {
  gCalculateCombinedRestitutionCallback = mean_restitution;
  gCalculateCombinedFrictionCallback = geometric_friction;
  inside_->world.setGravity(to_bullet(world.gravity()));
  for (const scenes::SceneBody& body : scene.bodies) inside_->add_body(body, world);
  for (JointId joint : scene.joints) inside_->add_joint(*world.joint(joint), world.ground());
}

BulletWorld::~BulletWorld() = default;

void BulletWorld::step(double dt) { inside_->world.stepSimulation(btScalar(dt), 0); }

std::vector<Pose> BulletWorld::poses() const {
  std::vector<Pose> result;
  for (const auto& body : inside_->bodies) {
    const btVector3 p = body->getWorldTransform().getOrigin();
    const btQuaternion q = body->getWorldTransform().getRotation();
    result.push_back({{p.x(), p.y(), p.z()}, {q.x(), q.y(), q.z(), q.w()}});
  }
  return result;
}

}  // namespace pcphys::bench
#endif
