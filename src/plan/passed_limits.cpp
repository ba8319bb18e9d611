#include "plan/passed_limits.h"

#include <algorithm>
#include <cmath>

#include "pcphys/constants.h"
#include "plan/forest.h"

#define PC_SCALAR double
#define PC_DOUBLE
#define PC_LANES 1
#define PC_NAMESPACE limits_d
#include "cpu/prelude.h"
namespace pcphys::limits_d {
#include "kernels/joint_angles.inl"
}

namespace pcphys {

namespace {

limits_d::Quaternion of_kernels(Quat q) { return limits_d::pc_quaternion({q.x, q.y, q.z}, q.w); }

/// Of an angle within limits; one that is locked has none.
double outside(double is, double low, double high) { return low < high ? std::max(low - is, is - high) : -1; }

/// How far a joint is beyond its limits [rad]; below zero within them.
double excess(const JointDef& joint, Quat a, Quat b) {
  const AngleFreedom& freedom = joint.freedom;
  const bool cone = freedom.kind == AngleFreedom::Kind::cone_twist;
  const limits_d::Vec3 is = limits_d::pc_joint_angles(of_kernels(a * joint.frame_a.orientation),
                                                      of_kernels(b * joint.frame_b.orientation), cone)
                                .value;
  if (cone) return std::max(is.y - freedom.cone, outside(is.x, -freedom.twist, freedom.twist));
  const Vec3 low = freedom.lower, high = freedom.upper;
  return std::max({outside(is.x, low.x, high.x), outside(is.y, low.y, high.y), outside(is.z, low.z, high.z)});
}

template <class Scalar> Quat orientation(const Scalar* poses, std::uint32_t row) {
  const Scalar* q = poses + row * reals_of(Buffer::pose) + 4;
  return {double(q[0]), double(q[1]), double(q[2]), double(q[3])};
}

template <class Scalar>
void want(const WorldState& state, const Forest& forest, const Scalar* before, std::uint8_t highest,
          std::vector<Wanted>& wanted) {
  constexpr double most = constants::largest_give;
  const Scalar* now = state.tables.data<Scalar>(Buffer::pose);
  for (std::size_t i = 0; i < forest.trees(); i++)
    for (const TreeNode& node : forest.tree(i)) {
      if (node.joint == 0) continue;
      const JointRecord& joint = state.joints[node.joint];
      if (joint.def.freedom.kind == AngleFreedom::Kind::free) continue;
      const std::uint32_t a = state.body_ids.row(joint.body_a), b = state.body_ids.row(joint.body_b);
      const Quat a0 = orientation(before, a), b0 = orientation(before, b), a1 = orientation(now, a),
                 b1 = orientation(now, b);
      // what turned by less has passed none by more: the cosine of half of the turn, as 1 - (most / 2)^2 / 2
      const Quat x = conjugate(a0) * b0, y = conjugate(a1) * b1;
      const double cosine = x.x * y.x + x.y * y.y + x.z * y.z + x.w * y.w;
      if (std::abs(cosine) > 1 - most * most / 8) continue;
      const double passed = excess(joint.def, a1, b1);
      if (!(passed > most) || excess(joint.def, a0, b0) > most) continue;
      if (const std::uint8_t octaves = octave_for(passed, most, highest); octaves > 0)
        wanted.push_back({state.responds(b) ? b : a, octaves});
    }
}

}  // namespace

void want_for_passed_limits(const WorldState& state, const Forest& forest, const AlignedBytes& poses,
                            std::uint8_t highest, std::vector<Wanted>& wanted) {
  if (highest == 0) return;
  if (state.tables.precision() == Precision::f32)
    want(state, forest, reinterpret_cast<const float*>(poses.data()), highest, wanted);
  else
    want(state, forest, reinterpret_cast<const double*>(poses.data()), highest, wanted);
}

}  // namespace pcphys
