// How bodies move within the step, and the boxes that hold their shapes wherever they can come.
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "collision/detector.h"
#include "collision/view.h"
#include "pcphys/constants.h"

namespace pcphys {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();
constexpr Aabb everywhere = {{-infinite, -infinite, -infinite}, {infinite, infinite, infinite}};

}  // namespace

void Detector::list_columns(const WorldState& s, const Options& options) {
  listed_margin_ = options.contact_margin;
  const std::size_t stride = bodies_.size();
  twists_.assign(s.bodies.size(), {});
  columns_.resize(0);  // zeros
  columns_.resize(stride * bound_columns * sizeof(float));
  float* const columns = reinterpret_cast<float*>(columns_.data());
  for (std::uint32_t i = 0; i < proxies_.size(); i++) {
    const Proxy& proxy = proxies_[i];
    if (!proxy.alive) continue;
    margins_[i] = options.contact_margin > 0 ? options.contact_margin : constants::contact_share * proxy.radius;
    const bool box = proxy.kind == ShapeKind::box, ball = proxy.kind == ShapeKind::sphere;
    const Vec3 size = s.shapes[i].def.size;
    const Vec3 half = box ? size : Vec3{0, ball ? 0 : size.y, 0};  // a cylinder's box is within its capsule's
    const float of[bound_columns] = {proxy.lever_across,
                                     proxy.lever_any,
                                     proxy.moves ? 1.0f : 0.0f,
                                     float(half.x),
                                     float(half.y),
                                     float(half.z),
                                     box ? 0.0f : float(size.x),
                                     proxy.responds ? float(margins_[i]) : 0.0f,
                                     0.0f};
    for (std::size_t k = 0; k < bound_columns; k++) columns[k * stride + i] = of[k];
  }
}

// In both precisions in float: nothing but which contacts are listed comes of it.
template <class Scalar> void Detector::find_twists(const WorldState& s, const Options& options) {
  const auto table = [&](Buffer buffer, AlignedBytes& rounded) {
    const Scalar* of = s.tables.data<Scalar>(buffer);
    if constexpr (std::is_same_v<Scalar, float>) {
      return of;
    } else {
      const std::size_t reals = s.bodies.size() * reals_of(buffer);
      rounded.resize(reals * sizeof(float));
      float* out = reinterpret_cast<float*>(rounded.data());
      std::transform(of, of + reals, out, [](Scalar x) { return float(x); });
      return static_cast<const float*>(out);
    }
  };
  narrow_lanes<float>(options.lanes)
      .twists({table(Buffer::motion, rounded_[0]), table(Buffer::mass, rounded_[1]), table(Buffer::pose, rounded_[2]),
               moving_.data(), movers_, twists_.data()->v});
}

// A blow that stops one body of a joint tree sends its neighbours on, or draws them along: a foot that stands is pushed
// through the floor by what falls on it from the same ragdoll, though it did not move. So each may go as far as the
// fastest body that joints connect it to, where that is further than half of the thinnest shape.
void Detector::find_drawn(double dt) {
  const bool drew = std::exchange(draws_, false);
  drawn_.assign(trees_.size(), 0);
  fastest_.assign(trees_.size(), 0);
  for (std::size_t row = 1; row < trees_.size(); row++)
    fastest_[trees_[row]] = std::max(fastest_[trees_[row]], twists_[row].speed);
  for (std::size_t row = 1; row < trees_.size(); row++) {
    const float fastest = fastest_[trees_[row]], way = fastest * float(dt);
    if (trees_[row] == 0 || fastest <= twists_[row].speed || way <= 0.5f * thinnest_) continue;
    drawn_[row] = way;
    draws_ = true;
  }
  if (!strays_ && !draws_ && !drew) return;
  float* const column = reinterpret_cast<float*>(columns_.data()) + (bound_columns - 1) * bodies_.size();
  for (std::size_t i = 0; i < proxies_.size(); i++) {
    const std::uint32_t row = bodies_[i];
    column[i] = std::max(strays_ ? went_[row] : 0.0f, drawn_.empty() ? 0.0f : drawn_[row]);
  }
}

// Each box is grown by its shape's margin, if forces move it, and by how far the shape can come within the step, so
// that every two shapes that come within the margin of each other have overlapping boxes.
template <class Scalar>
void Detector::bound(const WorldState& s, double dt, const Options& options, Scratch<Scalar>& scratch) {
  constexpr bool rounds = !std::is_same_v<Scalar, float>;
  const std::uint32_t count = std::uint32_t(proxies_.size()), stride = std::uint32_t(bodies_.size());
  if (listed_margin_ != options.contact_margin) list_columns(s, options);
  find_twists<Scalar>(s, options);
  scratch.shapes.resize(count);
  scratch.rows.resize(stride * round_reals * sizeof(Scalar));
  if (rounds) rows_.resize(stride * round_reals * sizeof(float));
  const BodyReader<Scalar> bodies(s.tables);
  Scalar* const rows = reinterpret_cast<Scalar*>(scratch.rows.data());
  float* const bound_rows = reinterpret_cast<float*>(rounds ? rows_.data() : scratch.rows.data());
  const Scalar* table = s.tables.data<Scalar>(Buffer::shape);
  for (std::uint32_t i = 0; i < count; i++) {
    const Proxy& proxy = proxies_[i];
    if (!proxy.alive) continue;
    place_shape(table + (i + 1) * reals_of(Buffer::shape), proxy.kind, proxy.hull, proxy.centred,
                bodies.orientation(proxy.body), scratch.shapes[i]);
    bodies.write_row(proxy.body, scratch.shapes[i], rows + i * round_reals);
    if constexpr (rounds) round_row(rows + i * round_reals, bound_rows + i * round_reals);
  }
  float* const columns = reinterpret_cast<float*>(columns_.data());
  find_drawn(dt);
  dt_ = dt;
  fall_ = length(s.gravity) * dt * dt;
  narrow_lanes<float>(options.lanes)
      .boxes({bound_rows, columns, twists_.data()->v, bodies_.data(), count, stride, float(dt), float(fall_),
              largest_turn, reach_.data(), tight_.data()});
  scratch.kinds.resize(count);
  for (std::uint32_t i = 0; i < count; i++)
    scratch.kinds[i] = {Scalar(margins_[i]), reach_[i], proxies_[i].kind, proxies_[i].responds};
  for (const std::uint32_t i : odd_) {
    const float more = reach_[i] + (proxies_[i].responds ? float(margins_[i]) : 0.0f);
    const bool plane = proxies_[i].kind == ShapeKind::plane;
    tight_[i] = plane ? everywhere : box_of_hull(scratch.shapes[i], bodies.position(proxies_[i].body), more);
  }
  for (Twist& twist : twists_) twist.limit_turn(dt);
}

template void Detector::bound(const WorldState&, double, const Options&, Scratch<float>&);
template void Detector::bound(const WorldState&, double, const Options&, Scratch<double>&);

}  // namespace pcphys
