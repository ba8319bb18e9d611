#include "design.h"

#include <algorithm>
#include <initializer_list>

#include "world/state.h"

namespace pcphys::architectures {
namespace {

void put(float* to, std::initializer_list<double> values) {
  for (double v : values) *to++ = float(v);
}
void put(float* to, Vec3 v, double fourth) { put(to, {v.x, v.y, v.z, fourth}); }
double inverse(double x) { return x > 0 ? 1 / x : 0; }

}  // namespace

void write(const BodyInit& b, const BodyRows& rows) {
  constexpr double just_set = -1;  // the phase: the velocity is that of this instant
  put(rows.motion, b.velocity, inverse(b.mass));
  put(rows.motion + 4, b.momentum, just_set);
  std::fill_n(rows.pose, length_of(Buffer::pose), 0.0f);
  put(rows.pose, b.position, 0);
  put(rows.pose + 4, {0, 0, 0, 1});
  put(rows.mass, b.moments, b.mass);
  put(rows.mass + 4,
      {inverse(b.moments.x), inverse(b.moments.y), inverse(b.moments.z), double(middle_axis(b.moments))});
  put(rows.force, b.force, b.drag);
  put(rows.force + 4, {}, b.drag);
  put(rows.material, {0.5, 0.5, 0, 1, 0, 0, 0, 0});
}

void write(const JointInit& j, float* joint_solved) {
  constexpr double cone_and_twist = 1;
  put(joint_solved, j.anchor_a, cone_and_twist);
  put(joint_solved + 4, {0, 0, 0, 1});
  put(joint_solved + 8, j.anchor_b, 0);
  put(joint_solved + 12, {0, 0, 0, 1});
  put(joint_solved + 16, {-j.twist, -j.cone, 0, 0});
  put(joint_solved + 20, {j.twist, j.cone, 0, 0});
}

void write(const ContactInit& c, float* contact) {
  std::fill_n(contact, length_of(Buffer::contact), 0.0f);
  put(contact, c.normal, 1);
  put(contact + 4, c.arm, c.separation);
  put(contact + 28, {c.friction, c.friction, 0, 0});
}

std::span<const NamedDesign> designs() {
  static constexpr NamedDesign all[] = {{"hierarchy", make_hierarchy},
                                        {"hybrid", make_hybrid},
                                        {"entities, views", make_entity_views},
                                        {"entities, groups", make_entity_groups},
                                        {"properties", [] { return make_properties(1); }},
                                        {"properties, 8 lanes", [] { return make_properties(8); }}};
  return all;
}

}  // namespace pcphys::architectures
