#include "mujoco_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>

namespace pcphys::peers {
namespace {

/// Disjoint sets of bodies, with path halving; 0 is the world.
class Sets {
 public:
  explicit Sets(std::size_t bodies) : parent_(bodies + 1) { std::iota(parent_.begin(), parent_.end(), 0); }
  bool join(int a, int b) {
    const std::size_t x = find(std::size_t(a + 1)), y = find(std::size_t(b + 1));
    parent_[std::max(x, y)] = std::min(x, y);
    return x != y;
  }

 private:
  std::size_t find(std::size_t x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }
  std::vector<std::size_t> parent_;
};

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.17g", value);
  return buffer;
}
std::string text(Vec3 v) { return text(v.x) + " " + text(v.y) + " " + text(v.z); }
std::string text(Quat q) { return text(q.w) + " " + text(q.x) + " " + text(q.y) + " " + text(q.z); }
std::string text(const Pose& pose) {
  return " pos='" + text(pose.position) + "' quat='" + text(pose.orientation) + "'";
}

class Writer {
 public:
  explicit Writer(const Description& description) : description_(description) {}

  MujocoModel write(const std::string& options_xml) {
    find_trees();
    for (std::size_t i = 0; i < model_.links.size(); ++i)
      if (model_.links[i].parent < 0) write_body(int(i));
    for (const Joint& joint : description_.joints) exclude(joint);
    const auto [contacts, rows] = sizes();
    model_.xml = "<mujoco><compiler angle='radian' balanceinertia='false'/><size nconmax='" + std::to_string(contacts) +
                 "' njmax='" + std::to_string(rows) + "'/><option " + options_xml + "/><worldbody>" + bodies_ +
                 "</worldbody><contact>" + excluded_ + "</contact><equality>" + equalities_ + "</equality></mujoco>";
    note_differences();
    return std::move(model_);
  }

 private:
  const Joint& joint(int index) const { return description_.joints[std::size_t(index)]; }

  /// A spanning forest of the joints, in their order; what is left over closes loops.
  void find_trees() {
    const std::size_t count = description_.bodies.size();
    model_.links.resize(count);
    children_.resize(count);
    Sets sets(count);
    for (std::size_t i = 0; i < count; ++i)
      if (!description_.bodies[i].dynamic) sets.join(-1, int(i));
    std::vector<std::vector<int>> joints(count + 1);  // of each body and of the world, which has all that is fixed
    const auto place = [&](int body) { return description_.moves(body) ? std::size_t(body) + 1 : 0; };
    for (int k = 0; k < int(description_.joints.size()); ++k) {
      if (!sets.join(joint(k).a, joint(k).b)) {
        close_loop(joint(k));
        continue;
      }
      joints[place(joint(k).a)].push_back(k);
      joints[place(joint(k).b)].push_back(k);
    }
    std::vector<bool> met(count + 1);
    hang(0, joints, met);
    for (std::size_t start = 1; start <= count; ++start)
      if (!met[start] && description_.moves(int(start) - 1)) hang(start, joints, met);
  }

  /// Everything that joints connect to `start`.
  void hang(std::size_t start, const std::vector<std::vector<int>>& joints, std::vector<bool>& met) {
    std::vector<std::size_t> waiting{start};
    met[start] = true;
    while (!waiting.empty()) {
      const std::size_t at = waiting.back();
      waiting.pop_back();
      for (int k : joints[at]) {
        const bool b_hangs = description_.moves(joint(k).b) && !met[std::size_t(joint(k).b) + 1];
        const int child = b_hangs ? joint(k).b : joint(k).a, parent = b_hangs ? joint(k).a : joint(k).b;
        if (!description_.moves(child) || met[std::size_t(child) + 1]) continue;
        met[std::size_t(child) + 1] = true;
        model_.links[std::size_t(child)] = {parent, k, !b_hangs};
        if (parent >= 0) children_[std::size_t(parent)].push_back(child);
        waiting.push_back(std::size_t(child) + 1);
      }
    }
  }

  /// One point, two along a hinge's axis, three where nothing may turn.
  void close_loop(const Joint& joint) {
    const JointKind is = kind(joint.freedom);
    const double arm = std::max({length(joint.frame_a.position), length(joint.frame_b.position), 1e-2});
    std::vector<Vec3> points{{}};
    if (is == JointKind::hinge || is == JointKind::locked) points = {{-arm, 0, 0}, {arm, 0, 0}};
    if (is == JointKind::locked) points.push_back({0, arm, 0});
    if (is == JointKind::cone_twist || is == JointKind::angles || !ranges(joint.freedom)[0].free())
      loop_limits_ = loop_limits_ || is != JointKind::locked;
    for (Vec3 point : points) {
      const HeldPoint held{joint.a, joint.b, transform(joint.frame_a, point), transform(joint.frame_b, point)};
      model_.held.push_back(held);
      // MuJoCo wants a body first; the world is the second one where it is left out
      const bool swapped = held.a < 0;
      const std::string second = held.a < 0 || held.b < 0 ? "" : " body2='" + body_name(held.b) + "'";
      equalities_ += "<connect body1='" + body_name(swapped ? held.b : held.a) + "'" + second + " anchor='" +
                     text(swapped ? held.at_b : held.at_a) + "'/>";
    }
  }

  void write_body(int index) {
    const Body& body = description_.bodies[std::size_t(index)];
    const Link& link = model_.links[std::size_t(index)];
    bodies_ += "<body name='" + body_name(index) + "'";
    if (link.joint >= 0) {
      const auto [parent_frame, own_frame] = frames(link);
      bodies_ += text(parent_frame * inverse(own_frame)) + ">";
      write_joint(link, own_frame);
    } else {
      bodies_ += text(body.pose) + ">";
      if (body.dynamic) bodies_ += "<freejoint/>";
    }
    if (body.dynamic)
      bodies_ +=
          "<inertial pos='0 0 0' mass='" + text(body.mass.mass) + "' diaginertia='" + text(body.mass.moments) + "'/>";
    for (const ShapeDef& shape : body.shapes) write_shape(shape, body.material);
    for (int child : children_[std::size_t(index)]) write_body(child);
    bodies_ += "</body>";
  }

  struct Frames {
    Pose parent, own;
  };
  Frames frames(const Link& link) const {
    const Joint& j = joint(link.joint);
    return link.flipped ? Frames{j.frame_b, j.frame_a} : Frames{j.frame_a, j.frame_b};
  }

  static std::string damping(const Joint& j) { return j.damping > 0 ? " damping='" + text(j.damping) + "'" : ""; }

  void write_joint(const Link& link, const Pose& own_frame) {
    const Joint& j = joint(link.joint);
    const std::string place = " pos='" + text(own_frame.position) + "'";
    const JointKind is = kind(j.freedom);
    if (is == JointKind::locked) return;
    if (is == JointKind::ball || is == JointKind::cone_twist) {
      bodies_ += "<joint type='ball' name='" + joint_name(link.joint, 0) + "'" + place;
      if (is == JointKind::cone_twist) bodies_ += " limited='true' range='0 " + text(j.freedom.cone) + "'";
      bodies_ += damping(j) + "/>";
      cones_ = cones_ || is == JointKind::cone_twist;
      return;
    }
    const auto angles = ranges(j.freedom);
    std::array<int, 3> axes{1, 2, 0};  // pitch, yaw, roll: from the parent outwards, as `hinge_angles` has them
    if (link.flipped) std::reverse(axes.begin(), axes.end());
    hinges_ = hinges_ || is == JointKind::angles;
    for (int axis : axes) {
      const AngleRange range = angles[std::size_t(axis)];
      if (range.locked() && range.lower == 0) continue;
      const double sign = link.flipped ? -1 : 1;
      const Vec3 along =
          rotate(own_frame.orientation, {axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0});
      bodies_ +=
          "<joint type='hinge' name='" + joint_name(link.joint, axis) + "'" + place + " axis='" + text(along) + "'";
      if (!range.free())
        bodies_ += " limited='true' range='" + text(std::max(range.lower, -largest)) + " " +
                   text(std::min(range.upper, largest)) + "'";
      bodies_ += damping(j) + "/>";
    }
  }

  void write_shape(const ShapeDef& shape, const Material& material) {
    if (shape.filter.mask == 0) return;
    Pose pose = shape.local;
    const double turned = -0.5 * std::numbers::pi;  // MuJoCo's capsules, cylinders and planes have z for an axis
    if (shape.kind == ShapeKind::capsule || shape.kind == ShapeKind::cylinder || shape.kind == ShapeKind::plane)
      pose.orientation = pose.orientation * axis_angle({1, 0, 0}, turned);
    std::string is;
    switch (shape.kind) {
      case ShapeKind::sphere: is = "sphere' size='" + text(shape.size.x); break;
      case ShapeKind::capsule: is = "capsule' size='" + text(shape.size.x) + " " + text(shape.size.y); break;
      case ShapeKind::cylinder: is = "cylinder' size='" + text(shape.size.x) + " " + text(shape.size.y); break;
      case ShapeKind::box: is = "box' size='" + text(shape.size); break;
      case ShapeKind::hull: return;  // refused by Mujoco::build
      case ShapeKind::plane: is = "plane' size='0 0 1"; break;
    }
    const double friction = material.kinetic_friction;
    bodies_ += "<geom type='" + is + "'" + text(pose) + " contype='" + bits(shape.filter.category) + "' conaffinity='" +
               bits(shape.filter.mask) + "' condim='" + (friction > 0 ? "3" : "1") + "' friction='" + text(friction) +
               " 0.005 0.0001'/>";
  }
  static std::string bits(std::uint32_t mask) { return std::to_string(mask & 0x7fffffffu); }

  /// MuJoCo keeps a body and its parent apart by itself, unless the parent is fixed.
  void exclude(const Joint& j) {
    if (j.collide || j.a < 0 || j.b < 0) return;
    excluded_ += "<exclude body1='" + body_name(j.a) + "' body2='" + body_name(j.b) + "'/>";
  }

  struct Sizes {
    std::size_t contacts, rows;
  };
  /// MuJoCo's arrays are made once and are dense. What does not fit is dropped, and counted as a failure.
  Sizes sizes() {
    constexpr std::size_t of_round = 6, of_others = 12;  // points a body, as piles of the scenes have them and more
    std::size_t contacts = 64, freedoms = 0;
    for (std::size_t i = 0; i < description_.bodies.size(); ++i) {
      const Body& body = description_.bodies[i];
      if (body.dynamic) freedoms += model_.links[i].joint < 0 ? 6 : 3;
      if (!body.dynamic || !description_.collides(i)) continue;
      for (const ShapeDef& shape : body.shapes)
        contacts += shape.kind == ShapeKind::sphere || shape.kind == ShapeKind::capsule ? of_round : of_others;
    }
    const std::size_t rows = 4 * contacts + 3 * description_.joints.size() + 3 * model_.held.size();
    const double n = double(rows);  // the Jacobian, its transpose and the matrix between rows, with indices
    model_.gigabytes = (n * double(freedoms) * (8 + 8 + 4 + 4) + n * n * (8 + 4)) / double(1 << 30);
    return {contacts, rows};
  }

  void note_differences() {
    const auto any = [&](auto has) { return std::any_of(description_.bodies.begin(), description_.bodies.end(), has); };
    std::vector<std::string>& notes = model_.untranslated;
    if (any([](const Body& b) { return b.material.restitution > 0; }))
      notes.push_back("contacts do not bounce: MuJoCo's have a stiffness and a damping instead of a restitution");
    const double friction = description_.bodies.empty() ? 0 : description_.bodies.front().material.kinetic_friction;
    if (any([&](const Body& b) { return b.material.kinetic_friction != friction; }))
      notes.push_back("of two frictions the larger one holds, not their geometric mean");
    if (any([](const Body& b) {
          return std::any_of(b.shapes.begin(), b.shapes.end(), [](const ShapeDef& s) { return s.filter.group != 0; });
        }))
      notes.push_back("groups of filters have no effect");
    if (cones_)
      notes.push_back(
          "a cone limits the whole rotation of the joint, twist included; the twist has no limit of its own");
    if (hinges_)
      notes.push_back("pitch, yaw and roll are three hinges in a row, which agree with pcphys to first order");
    if (hinges_ && description_.has_damping()) notes.push_back("damping acts on pitch, yaw and roll one by one");
    if (loop_limits_) notes.push_back("joints that close a loop have no limits");
    if (std::any_of(description_.joints.begin(), description_.joints.end(), [](const Joint& j) { return j.collide; }))
      notes.push_back("bodies that a joint connects never collide");
  }

  static constexpr double largest = 1e3;  // an angle that no scene reaches [rad]
  const Description& description_;
  MujocoModel model_;
  std::vector<std::vector<int>> children_;
  std::string bodies_, excluded_, equalities_;
  bool cones_ = false, hinges_ = false, loop_limits_ = false;
};

}  // namespace

std::string body_name(int body) { return "b" + std::to_string(body); }
std::string joint_name(int joint, int axis) { return "j" + std::to_string(joint) + "_" + std::to_string(axis); }

MujocoModel make_mujoco_model(const Description& description, const std::string& options_xml) {
  return Writer(description).write(options_xml);
}

}  // namespace pcphys::peers
