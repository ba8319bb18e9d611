// Vectors and quaternions at the border of the library: plain, trivially copyable, always double.
// Inside, a world stores float or double as chosen at run time; a position that is stored as a sum of
// two floats is more than a float can hold, so the border speaks double in both cases.
// Eigen types convert from and to these implicitly; Eigen itself is not included here, since a struct
// with Eigen members changes its size with the compiler's flags and cannot be an ABI.
#pragma once
#include <cmath>
#include <type_traits>

namespace pcphys {

/// Anything with x(), y(), z() members that is built from three numbers, such as Eigen::Vector3d.
template <class V>
concept ForeignVector3 = requires(const V v) {
  v.x();
  v.y();
  v.z();
  V(0.0, 0.0, 0.0);
};
/// Anything with w(), x(), y(), z() members that is built as (w, x, y, z), such as Eigen::Quaterniond.
template <class Q>
concept ForeignQuaternion = requires(const Q q) {
  q.x();
  q.y();
  q.z();
  q.w();
  q.toRotationMatrix();
  Q(1.0, 0.0, 0.0, 0.0);
};

struct Vec3 {
  double x = 0, y = 0, z = 0;

  constexpr Vec3() = default;
  constexpr Vec3(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {}
  template <ForeignVector3 V> Vec3(const V& v) : x(double(v.x())), y(double(v.y())), z(double(v.z())) {}
  template <ForeignVector3 V> operator V() const { return V(x, y, z); }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

/// Rotation from body to world axes; (0, 0, 0, 1) is none.
struct Quat {
  double x = 0, y = 0, z = 0, w = 1;

  constexpr Quat() = default;
  constexpr Quat(double x_, double y_, double z_, double w_) : x(x_), y(y_), z(z_), w(w_) {}
  template <ForeignQuaternion Q>
  Quat(const Q& q) : x(double(q.x())), y(double(q.y())), z(double(q.z())), w(double(q.w())) {}
  template <ForeignQuaternion Q> operator Q() const { return Q(w, x, y, z); }
  friend constexpr bool operator==(const Quat&, const Quat&) = default;
};

/// Four numbers without a meaning of their own.
struct Vec4 {
  double x = 0, y = 0, z = 0, w = 0;
  friend constexpr bool operator==(const Vec4&, const Vec4&) = default;
};

/// A 3 x 3 matrix, row by row.
struct Mat3 {
  double xx = 0, xy = 0, xz = 0, yx = 0, yy = 0, yz = 0, zx = 0, zy = 0, zz = 0;
  friend constexpr bool operator==(const Mat3&, const Mat3&) = default;
};

/// A symmetric one.
struct SymMat3 {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  friend constexpr bool operator==(const SymMat3&, const SymMat3&) = default;
};

/// A rigid pose: where a frame stands in its parent.
struct Pose {
  Vec3 position;
  Quat orientation;
  friend constexpr bool operator==(const Pose&, const Pose&) = default;
};

static_assert(std::is_trivially_copyable_v<Vec3> && sizeof(Vec3) == 24);
static_assert(std::is_trivially_copyable_v<Quat> && sizeof(Quat) == 32);

constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr Vec3 operator*(Vec3 a, double s) { return s * a; }
constexpr double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double length(Vec3 a) { return std::sqrt(dot(a, a)); }
inline bool finite(Vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

constexpr Quat operator*(Quat a, Quat b) {
  return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
constexpr Quat conjugate(Quat q) { return {-q.x, -q.y, -q.z, q.w}; }
inline double length(Quat q) { return std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w); }
inline bool finite(Quat q) {
  return std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z) && std::isfinite(q.w);
}

/// v turned by the unit quaternion q.
constexpr Vec3 rotate(Quat q, Vec3 v) {
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 t = 2.0 * cross(u, v);
  return v + q.w * t + cross(u, t);
}

/// The rotation by `angle` [rad] about the unit vector `axis`.
inline Quat axis_angle(Vec3 axis, double angle) {
  const double s = std::sin(0.5 * angle);
  return {s * axis.x, s * axis.y, s * axis.z, std::cos(0.5 * angle)};
}

constexpr Vec3 transform(const Pose& pose, Vec3 local) { return pose.position + rotate(pose.orientation, local); }

}  // namespace pcphys
