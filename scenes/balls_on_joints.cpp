#include "balls_on_joints.h"

#include "pcphys/math.h"

namespace pcphys::scenes {
namespace {

constexpr double radius = 0.1, apart = 0.3;  // [m]

Vec3 direction(Random& random) {
  for (;;) {
    const Vec3 v{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    const double size = length(v);
    if (size > 0.1 && size < 1) return (1 / size) * v;
  }
}

}  // namespace

Parents drawn_tree(std::uint32_t bodies, Random& random) {
  Parents parents;
  for (std::uint32_t k = 1; k < bodies; k++) parents.push_back(std::uint32_t(random.between(k / 3, k)));
  return parents;
}
Parents chain_tree(std::uint32_t bodies) {
  Parents parents;
  for (std::uint32_t k = 1; k < bodies; k++) parents.push_back(k - 1);
  return parents;
}
Parents star_tree(std::uint32_t bodies) { return Parents(bodies - 1, 0); }

Status pin_balls(World& world, BodyId a, BodyId b) {
  const Vec3 way = world.pose(b)->position - world.pose(a)->position;  // they are not turned yet
  JointDef joint;
  joint.a = a, joint.b = b;
  joint.frame_a.position = 0.5 * way, joint.frame_b.position = -0.5 * way;
  const Result<JointId> made = world.create_joint(joint);
  return made ? Status{} : Status{made.error()};
}

Result<std::vector<BodyId>> add_balls(World& world, const Parents& parents, const TreeOfBalls& tree, Random& random) {
  std::vector<BodyId> balls;
  for (std::size_t k = 0; k <= parents.size(); k++) {
    BodyDef def;
    def.shapes = {ShapeDef::sphere(radius)};
    def.shapes[0].filter.group = -tree.group;
    if (!tree.touches) def.shapes[0].filter.mask = 0;
    def.mass = 1;
    def.pose.position = k == 0 ? tree.place : world.pose(balls[parents[k - 1]])->position + apart * direction(random);
    def.angular_velocity = (k % 2 == 0 ? 1.0 : -1.0) * tree.spin;
    const Result<BodyId> made = world.create_body(def);
    if (!made) return made.error();
    balls.push_back(*made);
    if (k > 0)
      if (Status status = pin_balls(world, balls[parents[k - 1]], *made); !status) return status.error();
  }
  if (!tree.hangs) return balls;
  JointDef joint;
  joint.a = world.ground(), joint.b = balls[0];
  joint.frame_a.position = tree.place;
  if (const Result<JointId> made = world.create_joint(joint); !made) return made.error();
  return balls;
}

}  // namespace pcphys::scenes
