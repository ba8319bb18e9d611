// Convex polyhedra as shapes.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "pcphys/math.h"
#include "pcphys/result.h"

namespace pcphys {

struct HullData;

/// A convex polyhedron, made once by `make_hull` and never changed. Copies share it: any number of shapes, bodies
/// and worlds, of either precision, use one, and it is freed with the last of them.
///
/// Its own frame, which is the shape's, has its origin at the centre of mass and its axes along the principal axes,
/// those nearest to the axes of the points given; `frame` leads back to these.
class Hull {
 public:
  Hull() = default;  // none
  explicit operator bool() const { return data_ != nullptr; }

  /// Corners in the own frame [m]. Of the points given, those inside, on a face or on an edge are left out.
  std::span<const Vec3> vertices() const;
  std::size_t face_count() const;
  /// Vertices of a face, counter-clockwise seen from outside. Triangles in one plane are one face.
  std::span<const std::uint32_t> face(std::size_t i) const;
  /// [m^3]
  double volume() const;
  /// Moments of inertia about the own axes at a density of 1 [m^5].
  Vec3 moments() const;
  /// Of the sphere about the centre of mass that holds the hull, and of the one that the hull holds [m].
  double radius() const;
  double inner_radius() const;
  /// Where the own frame stands in that of the points given. A body whose pose is P * frame() shows the points where
  /// P puts them; so does a shape whose `local` is frame(), after `make_compound`.
  Pose frame() const;

  /// Whether both are the same hull; two hulls made of equal points are not.
  friend bool operator==(const Hull&, const Hull&) = default;
  /// The inside, for the library's own stages.
  const HullData* data() const { return data_.get(); }

 private:
  explicit Hull(std::shared_ptr<const HullData> data) : data_(std::move(data)) {}
  friend Result<Hull> make_hull(std::span<const Vec3> points);
  std::shared_ptr<const HullData> data_;
};

/// The convex hull of points in any order [m], by qhull (C. Barber et al., The Quickhull Algorithm, 1996).
/// Errors: not_finite; degenerate_shape for fewer than four points apart, points on one line or in one plane, or nearly
/// so (`constants::hull_flatness`, however they are turned), and sizes outside the range of shapes; buffer_full for
/// more vertices than `constants::largest_hull_vertices`.
Result<Hull> make_hull(std::span<const Vec3> points);

}  // namespace pcphys
