// A chain of links of 1 kg with a heavy load at its end. Nothing of it collides: it shows joints alone.
#include <numbers>

#include "builder.h"

namespace pcphys::scenes {
namespace {

constexpr double top = 20, link = 0.5, load_radius = 0.5;  // [m]

/// `orientation` turns the hanging chain's links; `direction` is where local -y then points.
void build(Builder& builder, Vec3 direction, Quat orientation, Vec3 push) {
  const int links = builder.scene().count;
  builder.set_material(0.5, 0);
  BodyId above = builder.world().ground();
  Pose frame_above{{0, top, 0}, orientation};
  for (int i = 0; i <= links; ++i) {
    const bool load = i == links;
    BodyDef def;
    def.shapes = {load ? ShapeDef::sphere(load_radius) : ShapeDef::capsule(0.05, 0.2)};
    def.shapes[0].filter.mask = 0;
    def.mass = load ? builder.scene().ratio : 1.0;
    def.pose.position = Vec3{0, top, 0} + (link * i + (load ? load_radius : 0.5 * link)) * direction;
    def.pose.orientation = orientation;
    if (load) def.velocity = push;
    const int body = builder.add(def, 1, i);

    JointDef joint;
    joint.a = above;
    joint.b = builder.id(body);
    joint.frame_a = frame_above;
    joint.frame_b.position = {0, load ? load_radius : 0.5 * link, 0};
    builder.add_joint(joint);
    above = joint.b;
    frame_above = {{0, -0.5 * link, 0}, {}};
  }
}

}  // namespace

void build_chain(Builder& builder) { build(builder, {0, -1, 0}, {}, {1, 0, 0}); }

void build_chainswing(Builder& builder) {
  build(builder, {1, 0, 0}, axis_angle({0, 0, 1}, 0.5 * std::numbers::pi), {});
}

}  // namespace pcphys::scenes
