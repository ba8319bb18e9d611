// A world as MuJoCo's model language has it: trees of bodies in coordinates of their joints, and points that are
// held together where joints close a loop.
#pragma once
#include <string>
#include <vector>

#include "description.h"

namespace pcphys::peers {

/// How a body hangs in its tree.
struct Link {
  int parent = -1;       // body; -1: the world
  int joint = -1;        // index in the description; -1: the body is free, or fixed
  bool flipped = false;  // the joint's b is the parent
};

/// A point of one body that is held on a point of another.
struct HeldPoint {
  int a = -1, b = -1;
  Vec3 at_a, at_b;  // in each body
};

struct MujocoModel {
  std::vector<Link> links;  // by body
  std::vector<HeldPoint> held;
  std::vector<std::string> untranslated;
  double gigabytes = 0;  // that MuJoCo's arrays of constraints will take, about
  std::string xml;
};

std::string body_name(int body);
/// Of one angle of a joint; axis 0 roll, 1 pitch, 2 yaw. A ball has the name of axis 0.
std::string joint_name(int joint, int axis);

/// `options_xml`: attributes of MuJoCo's <option>.
MujocoModel make_mujoco_model(const Description& description, const std::string& options_xml);

}  // namespace pcphys::peers
