// Between tables and collision shapes: where a shape stands, its box, its contact row.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "collision/aabb.h"
#include "collision/narrow.h"
#include "world/hull.h"
#include "world/tables.h"

namespace pcphys {

/// Reals of a contact's row that remember impulses: from place::normal_impulse on.
inline constexpr std::size_t impulse_count = place::contact_static_friction - place::normal_impulse;

/// What the narrow phase reads of a body, straight from the tables' rows.
template <class Scalar> class BodyReader {
 public:
  explicit BodyReader(const Tables& t) : pose_(t.data<Scalar>(Buffer::pose)) {}
  static constexpr std::size_t stride = reals_of(Buffer::pose);

  const Scalar* orientation(std::uint32_t row) const { return pose_ + row * stride + 4; }
  Vec3 position(std::uint32_t row) const {
    const Scalar* p = pose_ + row * stride;
    return {double(p[0]) + double(p[8]), double(p[1]) + double(p[9]), double(p[2]) + double(p[10])};
  }
  /// A shape's row (narrow_bounds.inl).
  void write_row(std::uint32_t body, const ShapeView<Scalar>& shape, Scalar* out) const {
    const Scalar* at = pose_ + body * stride;
    std::copy_n(shape.p, 3, out);
    out[3] = shape.size[0];
    std::copy_n(shape.q, 4, out + 4);
    std::copy_n(at, 4, out + 8);
    out[11] = shape.size[1];
    std::copy_n(at + 8, 4, out + 12);
    out[15] = shape.size[2];
  }
  /// Adds b's centre as seen from a's.
  void shift(std::uint32_t a, std::uint32_t b, Scalar* p) const {
    const Scalar *x = pose_ + a * stride, *y = pose_ + b * stride;
    for (int k = 0; k < 3; k++) p[k] += (y[k] - x[k]) + (y[8 + k] - x[8 + k]);
  }

 private:
  const Scalar* pose_;
};

/// A shape's row in float, what rounding drops of the position in its low part.
inline void round_row(const double* row, float* out) {
  for (int k = 0; k < 12; k++) out[k] = float(row[k]);
  for (int k = 0; k < 3; k++) out[12 + k] = float((row[8 + k] - double(out[8 + k])) + row[12 + k]);
  out[15] = 0;
}

template <class Scalar> void rotate_by(const Scalar* q, const Scalar* v, Scalar* out) {
  const Scalar tx = 2 * (q[1] * v[2] - q[2] * v[1]), ty = 2 * (q[2] * v[0] - q[0] * v[2]),
               tz = 2 * (q[0] * v[1] - q[1] * v[0]);
  out[0] = v[0] + q[3] * tx + (q[1] * tz - q[2] * ty);
  out[1] = v[1] + q[3] * ty + (q[2] * tx - q[0] * tz);
  out[2] = v[2] + q[3] * tz + (q[0] * ty - q[1] * tx);
}

/// `row`: of the shape table; q: the body's orientation. The view's p is relative to the body's centre.
template <class Scalar>
void place_shape(const Scalar* row, ShapeKind kind, const HullData* hull, bool centred, const Scalar* q,
                 ShapeView<Scalar>& view) {
  view.kind = kind;
  view.hull = hull;
  for (int k = 0; k < 3; k++) view.size[k] = row[k];
  for (int k = 0; k < 3; k++) view.p[k] = 0;
  for (int k = 0; k < 4; k++) view.q[k] = q[k];
  if (centred) return;
  rotate_by(q, row + 4, view.p);
  const Scalar* l = row + 8;
  view.q[0] = q[3] * l[0] + q[0] * l[3] + q[1] * l[2] - q[2] * l[1];
  view.q[1] = q[3] * l[1] - q[0] * l[2] + q[1] * l[3] + q[2] * l[0];
  view.q[2] = q[3] * l[2] + q[0] * l[1] - q[1] * l[0] + q[2] * l[3];
  view.q[3] = q[3] * l[3] - q[0] * l[0] - q[1] * l[1] - q[2] * l[2];
}

/// A hull's box about `centre` (of its body), by its vertices, grown by `more`.
/// Boxes of other shapes: narrow_bounds.inl.
template <class Scalar> Aabb box_of_hull(const ShapeView<Scalar>& view, Vec3 centre, float more) {
  const float x = float(view.q[0]), y = float(view.q[1]), z = float(view.q[2]), w = float(view.q[3]);
  const float r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                         {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                         {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  const float* const v = view.hull->table.f32.data();
  const std::size_t reals = 3 * std::size_t(view.hull->table.indices[0]);
  const double slack = double(view.size[0]) * 1e-5 + double(more);  // beyond the rounding of the products below
  const double c[3] = {centre.x + double(view.p[0]), centre.y + double(view.p[1]), centre.z + double(view.p[2])};
  Aabb box;
  for (int k = 0; k < 3; k++) {
    float low = 0, high = 0;  // the centre is inside
    for (std::size_t i = 0; i < reals; i += 3) {
      const float at = r[k][0] * v[i] + r[k][1] * v[i + 1] + r[k][2] * v[i + 2];
      low = std::min(low, at);
      high = std::max(high, at);
    }
    box.min[k] = round_down(c[k] + double(low) - slack);
    box.max[k] = round_up(c[k] + double(high) + slack);
  }
  return box;
}

/// Two coefficients as one; the rules' numbers are those of `Combine`.
template <class Scalar> Scalar combine(Scalar rule_a, Scalar rule_b, Scalar a, Scalar b) {
  switch (Combine(std::uint8_t(std::max(rule_a, rule_b)))) {
    case Combine::mean: return (a + b) * Scalar(0.5);
    case Combine::geometric_mean: return std::sqrt(a * b);
    case Combine::minimum: return std::min(a, b);
    case Combine::product: return a * b;
    case Combine::maximum: break;
  }
  return std::max(a, b);
}

/// A manifold as a row of the contact table (properties.inl), without impulses.
template <class Scalar>
void write_contact(const Manifold<Scalar>& m, const Scalar* material_a, const Scalar* material_b, Scalar* out,
                   std::uint32_t* features) {
  for (int k = 0; k < 3; k++) out[k] = m.normal[k];
  out[3] = Scalar(m.count);
  for (std::uint32_t i = 0; i < 4; i++) {
    const bool real = i < m.count;
    for (int k = 0; k < 3; k++) out[4 + 4 * i + k] = real ? m.points[i].p[k] : Scalar(0);
    out[7 + 4 * i] = real ? m.points[i].separation : Scalar(0);
    features[i] = real ? m.points[i].feature : 0xffffffffu;
  }
  std::fill_n(out + place::normal_impulse, impulse_count, Scalar(0));
  for (int k = 0; k < 2; k++) out[28 + k] = combine(material_a[3], material_b[3], material_a[k], material_b[k]);
  out[30] = combine(material_a[6], material_b[6], material_a[2], material_b[2]);
  std::fill(out + place::impact_time, out + reals_of(Buffer::contact), Scalar(0));
}

/// Hands on the impulses of the last step's manifold: point by point to the same feature; what is left over to
/// the nearest point within `reach` [m], since a feature may change its name while the contact stays; friction
/// goes with the manifold. `before` and `out` are rows of the contact table.
template <class Scalar>
void remember_impulses(const Scalar* before, const std::uint32_t* before_features, Scalar reach, Scalar* out,
                       const std::uint32_t* features) {
  const int count = int(out[3]), before_count = int(before[3]);
  if (count == before_count && std::equal(features, features + count, before_features)) {  // what the rest would find
    for (int i = 0; i < count; i++) out[place::normal_impulse + i] = before[place::normal_impulse + i];
    std::copy_n(before + place::friction_impulse, 4, out + place::friction_impulse);
    return;
  }
  bool taken[4] = {}, given[4] = {};
  const auto hand_on = [&](int i, int j) {
    out[place::normal_impulse + i] = before[place::normal_impulse + j];
    given[i] = taken[j] = true;
  };
  for (int i = 0; i < count; i++)
    for (int j = 0; j < before_count; j++)
      if (!given[i] && !taken[j] && features[i] == before_features[j]) hand_on(i, j);
  for (int i = 0; i < count; i++) {
    if (given[i]) continue;
    int nearest = -1;
    Scalar best = reach * reach;
    for (int j = 0; j < before_count; j++) {
      if (taken[j]) continue;
      const Scalar dx = out[4 + 4 * i] - before[4 + 4 * j], dy = out[5 + 4 * i] - before[5 + 4 * j],
                   dz = out[6 + 4 * i] - before[6 + 4 * j];
      const Scalar d = dx * dx + dy * dy + dz * dz;
      if (d < best) {
        best = d;
        nearest = j;
      }
    }
    if (nearest >= 0) hand_on(i, nearest);
  }
  if (taken[0] || taken[1] || taken[2] || taken[3])
    std::copy_n(before + place::friction_impulse, 4, out + place::friction_impulse);
}

}  // namespace pcphys
