#include "collision/detector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "collision/flights.h"
#include "collision/hook.h"
#include "collision/view.h"
#include "pcphys/constants.h"

namespace pcphys {
namespace {

bool may_touch(const void* filter, std::uint32_t a, std::uint32_t b) { return (*static_cast<const PairFilter*>(filter))(a, b); }

/// See Proxy. A shape that is not centred turns with its whole distance.
std::pair<float, float> levers(const ShapeDef& d) {
  const float off = float(length(d.local.position)), radius = float(d.size.x), half = float(d.size.y);
  const bool upright = d.local == Pose{};
  switch (d.kind) {
    case ShapeKind::sphere: return {0.0f, off};
    case ShapeKind::box: return {0.0f, float(length(d.size)) + off};
    case ShapeKind::capsule: return upright ? std::pair(half, 0.0f) : std::pair(0.0f, half + off);
    case ShapeKind::cylinder: return upright ? std::pair(half + radius, 0.0f) : std::pair(0.0f, half + radius + off);
    case ShapeKind::hull: return {0.0f, float(d.convex.radius()) + off};
    case ShapeKind::plane: break;
  }
  return {0.0f, 0.0f};
}

/// Whether a gap between bodies that move as they do now closes within the step. One between bodies that slide past each other by
/// more than `extent` before it closes does not: they would meet only if their contact plane had no end.
template <class Scalar>
bool gaps_close(const Manifold<Scalar>& m, const Twist& a, const Twist& b, const float* apart, double margin, double dt,
                double fall, double extent) {
  const float n[3] = {float(m.normal[0]), float(m.normal[1]), float(m.normal[2])};
  for (std::uint32_t i = 0; i < m.count; i++) {
    const double gap = double(m.points[i].separation) - margin;
    const float r[3] = {float(m.points[i].p[0]), float(m.points[i].p[1]), float(m.points[i].p[2])};
    const Passing<float> p = passing(a, b, n, r, apart);
    const double closing = std::max(0.0, double(p.closing));
    if (gap > fall + closing * dt) continue;
    const double until = closing * dt > gap ? gap / closing : dt;
    if (double(p.sliding) * until <= extent) return true;
  }
  return false;
}

/// The largest speed at which a gap closes [m/s].
/// Whether some contact is of a body that was just placed and settles still after this step has begun.
bool some_settles(const Tables& tables, std::span<const std::array<std::uint32_t, 2>> ends) {
  const auto settles = [&](std::uint32_t row) { return tables.get(Buffer::velocity_parts, row, 15) > 1; };
  return std::ranges::any_of(ends, [&](const auto& e) { return settles(e[0]) || settles(e[1]); });
}

template <class Scalar> double fastest(const Manifold<Scalar>& m, const Twist& a, const Twist& b, const Scalar* apart) {
  float n[3], d[3], most = 0;
  for (int k = 0; k < 3; k++) n[k] = float(m.normal[k]), d[k] = float(apart[k]);
  for (std::uint32_t i = 0; i < m.count; i++) {
    const float r[3] = {float(m.points[i].p[0]), float(m.points[i].p[1]), float(m.points[i].p[2])};
    most = std::max(most, passing(a, b, n, r, d).closing);
  }
  return double(most);
}

/// Of the sphere about the shape's centre that holds it [m].
double bounding_radius(const ShapeDef& d) {
  switch (d.kind) {
    case ShapeKind::sphere: return d.size.x;
    case ShapeKind::box: return length(d.size);
    case ShapeKind::hull: return d.convex.radius();
    case ShapeKind::plane: return std::numeric_limits<double>::infinity();
    default: return d.size.x + d.size.y;
  }
}

/// Half a shape's thickness [m].
float inner_radius(const ShapeDef& d) {
  if (d.kind == ShapeKind::plane) return std::numeric_limits<float>::infinity();
  if (d.kind == ShapeKind::box) return float(std::min({d.size.x, d.size.y, d.size.z}));
  if (d.kind == ShapeKind::hull) return float(d.convex.inner_radius());
  return float(d.kind == ShapeKind::cylinder ? std::min(d.size.x, d.size.y) : d.size.x);
}

constexpr float infinite = std::numeric_limits<float>::infinity();
constexpr Aabb everywhere = {{-infinite, -infinite, -infinite}, {infinite, infinite, infinite}};

}  // namespace

void Detector::rebuild(const WorldState& s) {
  structure_ = s.structure_version;
  serial_ = s.serial;
  pairs_ = PairCache();
  pairs_.set_margin(float(constants::broad_margin), 0.125f);
  filter_->rebuild(s);
  pairs_.set_filter(may_touch, filter_.get());
  constexpr std::size_t lanes = 8;
  const std::size_t room = (s.shapes.size() + lanes - 1) / lanes * lanes;
  proxies_.assign(s.shapes.size(), {});
  tight_.assign(room, {});
  margins_.assign(s.shapes.size(), 0);
  reach_.assign(room, 0);
  bodies_.assign(room, 0);
  odd_.clear();
  round_ = false;
  moving_.clear();
  for (std::uint32_t row = 1; row < s.bodies.size(); row++)
    if (!s.stands(row)) moving_.push_back(row);
  movers_ = std::uint32_t(moving_.size());
  moving_.resize((moving_.size() + lanes - 1) / lanes * lanes, 0);
  listed_margin_ = -1;
  hints_.clear();
  hinted_ = false;
  standing_.clear();
  bool some_dynamic = false;
  thinnest_ = std::numeric_limits<float>::infinity();
  std::uint32_t solid = 0;
  std::vector<bool> jointed(s.bodies.size());
  for (std::uint32_t row = 1; row < s.joints.size(); row++)
    for (std::uint32_t body : {s.joints[row].body_a, s.joints[row].body_b}) jointed[s.body_ids.row(body)] = true;
  for (std::uint32_t i = 0; i < s.shapes.size(); i++) {
    const ShapeRecord& shape = s.shapes[i];
    if (!shape.alive || (shape.filter.mask == 0 && shape.filter.group <= 0)) continue;
    const std::uint32_t row = s.body_ids.row(shape.body);
    const auto [across, any] = levers(shape.def);
    proxies_[i] = {shape.def.kind,
                   true,
                   shape.def.local == Pose{},
                   s.responds(row),
                   row,
                   across,
                   any,
                   bounding_radius(shape.def),
                   s.responds(row) ? inner_radius(shape.def) : 0.0f,
                   jointed[row],
                   !s.stands(row),
                   shape.def.convex.data()};
    bodies_[i] = row;
    round_ |= shape.def.kind == ShapeKind::sphere || shape.def.kind == ShapeKind::capsule;
    if (shape.def.kind == ShapeKind::plane || shape.def.kind == ShapeKind::hull) odd_.push_back(i);
    if (proxies_[i].responds) thinnest_ = std::min(thinnest_, proxies_[i].inner);
    if (!s.responds(row)) standing_.push_back(i);
    pairs_.add(i, !s.stands(row));
    some_dynamic |= s.responds(row);
    solid++;
  }
  possible_ = some_dynamic && solid > 1;
}

bool Detector::some_material(const WorldState& s, std::initializer_list<std::uint32_t> offsets) {
  for (std::uint32_t row = 0; row < s.bodies.size(); row++)
    for (std::uint32_t k : offsets)
      if (s.tables.get(Buffer::material, row, k) > 0) return true;
  return false;
}

Status Detector::find_pairs(const WorldState& s, double dt, const Options& options) {
  if (structure_ != s.structure_version || serial_ != s.serial) rebuild(s);
  if (!possible_) return {};
  if (s.tables.precision() == Precision::f32)
    bound(s, dt, options, scratch_f_);
  else
    bound(s, dt, options, scratch_d_);
  pairs_.set_capacity(options.max_pairs);
  const PairReport report = pairs_.update(tight_);
  if (report.overflow)
    return Error{ErrorCode::buffer_full,
                 "The scene has " + std::to_string(report.pairs_needed) + (report.needed_is_exact ? "" : " or fewer") +
                     " pairs of shapes close together and room for " + std::to_string(options.max_pairs) +
                     "; raise StepSettings::max_pairs, or spread the bodies. The world is as before the step."};
  if (report.refused > 0) {
    const std::uint32_t body = s.shapes[report.first_refused].body;
    structure_ = 0;  // the broad phase dropped the shape: list all of them anew once the host has mended it
    return Error{ErrorCode::not_finite, "The pose or velocity of body " + std::to_string(body) +
                                            " is not finite; set it anew or destroy the body. The world is as before the step."};
  }
  if (report.changed) {
    next_hints_.assign(pairs_.pairs().size(), 0);
    const auto previous = pairs_.previous_index();
    for (std::size_t i = 0; hinted_ && i < next_hints_.size(); i++)
      next_hints_[i] = previous[i] < hints_.size() ? hints_[previous[i]] : 0;
    hints_.swap(next_hints_);
  }
  return {};
}

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
    margins_[i] = options.contact_margin > 0 ? options.contact_margin : constants::margin_share * proxy.radius;
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

// Each box is grown by its shape's margin, if forces move it, and by how far the shape can come within the step, so that every
// two shapes that come within the margin of each other have overlapping boxes.
template <class Scalar> void Detector::bound(const WorldState& s, double dt, const Options& options, Scratch<Scalar>& scratch) {
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
    place_shape(table + (i + 1) * reals_of(Buffer::shape), proxy.kind, proxy.hull, proxy.centred, bodies.orientation(proxy.body),
                scratch.shapes[i]);
    bodies.write_row(proxy.body, scratch.shapes[i], rows + i * round_reals);
    if constexpr (rounds) round_row(rows + i * round_reals, bound_rows + i * round_reals);
  }
  float* const columns = reinterpret_cast<float*>(columns_.data());
  if (strays_)
    for (std::uint32_t i = 0; i < count; i++) columns[(bound_columns - 1) * stride + i] = went_[bodies_[i]];
  narrow_lanes<float>(options.lanes)
      .boxes({bound_rows, columns, twists_.data()->v, bodies_.data(), count, stride, float(dt),
              float(length(s.gravity) * dt * dt), largest_turn, reach_.data(), tight_.data()});
  scratch.looks.resize(count);
  for (std::uint32_t i = 0; i < count; i++)
    scratch.looks[i] = {Scalar(margins_[i]), reach_[i], proxies_[i].kind, proxies_[i].responds};
  for (const std::uint32_t i : odd_) {
    const float more = reach_[i] + (proxies_[i].responds ? float(margins_[i]) : 0.0f);
    const bool plane = proxies_[i].kind == ShapeKind::plane;
    tight_[i] = plane ? everywhere : box_of_hull(scratch.shapes[i], bodies.position(proxies_[i].body), more);
  }
  for (Twist& twist : twists_) twist.limit_turn(dt);
}

template <> Detector::Scratch<float>& Detector::scratch() { return scratch_f_; }
template <> Detector::Scratch<double>& Detector::scratch() { return scratch_d_; }

NarrowHook& fcl_hook() {
  static NarrowHook hook;
  return hook;
}

bool Detector::find_strays(const WorldState& s, const AlignedBytes& before) {
  if (!possible_) return false;
  return s.tables.precision() == Precision::f32 ? collect_strays(s, reinterpret_cast<const float*>(before.data()))
                                                : collect_strays(s, reinterpret_cast<const double*>(before.data()));
}

// Whether something that stands lies on the way from q to p and was too far off to be paired.
template <class Scalar> bool Detector::passes_unseen(std::uint32_t shape, const Scalar* q, const Scalar* p) const {
  const float r = float(proxies_[shape].radius);
  Aabb way;
  for (int k = 0; k < 3; k++) {
    way.min[k] = float(std::min(p[k], q[k])) - r;
    way.max[k] = float(std::max(p[k], q[k])) + r;
  }
  for (const std::uint32_t i : standing_)
    if (overlap(tight_[i], way) && !overlap(tight_[i], tight_[shape])) return true;
  return false;
}

// A body that went its reach and half of its thickness is at most half sunk into what it never saw: the next step finds it.
// (Bodies on joints are left out, as they are of look_ahead.)
template <class Scalar> bool Detector::collect_strays(const WorldState& s, const Scalar* before) {
  const Scalar* now = s.tables.data<Scalar>(Buffer::pose);
  bool found = false;
  for (std::uint32_t i = 0; i < proxies_.size(); i++) {
    const Proxy& proxy = proxies_[i];
    if (!proxy.alive || !proxy.responds || proxy.jointed) continue;
    const Scalar *p = now + proxy.body * reals_of(Buffer::pose), *q = before + proxy.body * reals_of(Buffer::pose);
    const float x = float(p[0] - q[0]), y = float(p[1] - q[1]), z = float(p[2] - q[2]), seen = reach_[i] + 0.5f * proxy.inner;
    const float way = x * x + y * y + z * z;
    if (way <= seen * seen || !passes_unseen(i, q, p)) continue;
    if (!strays_) went_.assign(s.bodies.size(), 0);
    strays_ = found = true;
    went_[proxy.body] = std::max(went_[proxy.body], std::sqrt(way));
  }
  return found;
}

void Detector::forget_strays() {
  if (strays_) listed_margin_ = -1;  // the column of ways
  strays_ = false;
}

void Detector::put_back(WorldState& s) {
  if (!replaced_) return;
  replaced_ = false;
  AlignedBytes& before = s.tables.precision() == Precision::f32 ? scratch_f_.contacts : scratch_d_.contacts;
  s.tables.exchange(Table::contact, Buffer::contact, before, std::uint32_t(next_.keys.size()));
  std::swap(s.contacts, next_);
}

Status Detector::find_contacts(WorldState& s, double dt, const Options& options, Found& found) {
  replaced_ = false;
  if (!possible_ && s.contact_rows() == 1) return {};
  return s.tables.precision() == Precision::f32 ? narrow_all(s, dt, options, scratch<float>(), found)
                                                : narrow_all(s, dt, options, scratch<double>(), found);
}

void Detector::list_near() {
  const auto pairs = pairs_.pairs();
  near_.resize(pairs.size());
  std::size_t n = 0;
  for (std::size_t i = 0; i < pairs.size(); i++) {  // without a branch, which could not be predicted
    near_[n] = std::uint32_t(i);
    n += overlap(tight_[pairs[i].a], tight_[pairs[i].b]);
  }
  near_.resize(n);
}

template <class Scalar> void Detector::sort_out(const Options& options, Scratch<Scalar>& scratch) {
  PairLanes<Scalar>& lanes = scratch.lanes;
  lanes.begin(pairs_.pairs().size(), near_.size());
  marks_.clear(pairs_.pairs().size());
  std::size_t flight = 0;
  scratch.flights.push_back({});  // none comes after it
  scratch.flights.back().pair = 0xffffffffu;
  const Look<Scalar>* looks = scratch.looks.data();
  const Pair* pairs = pairs_.pairs().data();
  const bool native = options.narrow == NarrowPhase::native;
  for (const std::uint32_t i : near_) {
    auto [a, b] = pairs[i];
    if (!looks[a].responds) std::swap(a, b);  // as in_order
    const Look<Scalar>&x = looks[a], &y = looks[b];
    const PairKind kind = pair_kind(x.kind, y.kind);
    const bool flies = scratch.flights[flight].pair == i;
    flight += flies;
    if (!flies && native && kind != PairKind::other)
      lanes.add(kind, i, a, b, std::min(x.margin, y.margin) + Scalar(x.reach + y.reach));
    else
      lanes.leave(i), marks_.set(i);
  }
  scratch.flights.pop_back();
  lanes.run(narrow_lanes<Scalar>(options.lanes), reinterpret_cast<const Scalar*>(scratch.rows.data()), marks_);
}

template <class Scalar>
bool Detector::closes(const WorldState& s, double dt, Pair shapes, const Manifold<Scalar>& manifold) const {
  const double margin = this->margin(shapes.a, shapes.b);
  for (std::uint32_t i = 0; i < manifold.count; i++)
    if (double(manifold.points[i].separation) <= margin) return true;
  if (manifold.count == 0) return false;
  const Proxy &a = proxies_[shapes.a], &b = proxies_[shapes.b];
  Scalar d[3] = {0, 0, 0};
  BodyReader<Scalar>(s.tables).shift(a.body, b.body, d);
  const float apart[3] = {float(d[0]), float(d[1]), float(d[2])};
  return gaps_close(manifold, twists_[a.body], twists_[b.body], apart, margin, dt, length(s.gravity) * dt * dt,
                    a.radius + b.radius);
}

template <class Scalar>
bool Detector::touches(const WorldState& s, double dt, const Options& options, Scratch<Scalar>& scratch, std::uint32_t pair,
                       Touch<Scalar>& touch) {
  const Pair shapes = in_order(pair);
  const Proxy &a = proxies_[shapes.a], &b = proxies_[shapes.b];
  touch.rows[0] = a.body, touch.rows[1] = b.body;
  touch.impact = a.jointed || b.jointed ? -1 : 0;
  touch.manifold = round_ ? scratch.lanes.manifold(pair) : nullptr;
  if (!touch.manifold) {
    const Sight<Scalar> view = sight(s, scratch, pair);
    if (scratch.flight < scratch.flights.size() && scratch.flights[scratch.flight].pair == pair) {
      Flight<Scalar>& f = scratch.flights[scratch.flight++];
      touch.manifold = &f.manifold;
      if (!settle(s, dt, options, scratch, view, f)) return false;
      touch.impact = f.impact;
      return true;
    }
    touch.manifold = &touch.own;
    find(options, view, scratch.shapes[shapes.a], view.there, pair, touch.own);
  }
  if (!closes(s, dt, shapes, *touch.manifold)) return false;
  to_light_side(*touch.manifold, share_of<Scalar>(s.tables, touch.rows[0], touch.rows[1]));
  return true;
}

template <class Scalar>
Status Detector::narrow_all(WorldState& s, double dt, const Options& options, Scratch<Scalar>& scratch, Found& found) {
  const auto pairs = pairs_.pairs();
  const Scalar* materials = s.tables.data<Scalar>(Buffer::material);
  const Scalar* before = s.tables.data<Scalar>(Buffer::contact);
  const std::uint32_t before_rows = s.contact_rows();
  const std::size_t reals = schema(Buffer::contact).reals;
  next_.keys.resize(1);
  next_.ends.resize(1);
  next_.features.resize(1);
  const double fall = length(s.gravity) * dt * dt;
  std::uint32_t old = 1;
  hints_.resize(pairs.size());
  found = {};
  found.pairs = std::uint32_t(pairs.size());
  list_near();
  look_ahead(s, dt, options, scratch);
  if (round_) sort_out(options, scratch);
  scratch.flight = 0;
  const BodyReader<Scalar> bodies(s.tables);
  Touch<Scalar> touch;
  const auto add = [&](std::uint32_t i) {
    if (!touches(s, dt, options, scratch, i, touch)) return;
    const auto [a, b] = pairs[i];
    const auto [row_a, row_b] = touch.rows;
    const Manifold<Scalar>& manifold = *touch.manifold;
    const ContactKey key{a, b};
    const std::uint32_t row = std::uint32_t(next_.keys.size());
    next_.keys.push_back(key);
    next_.ends.push_back({row_a, row_b});
    next_.features.push_back({});
    if (scratch.contacts.size() < (row + 1) * reals * sizeof(Scalar)) scratch.contacts.resize((row + 1) * reals * sizeof(Scalar));
    Scalar* out = reinterpret_cast<Scalar*>(scratch.contacts.data()) + row * reals;
    const Scalar *of_a = materials + row_a * reals_of(Buffer::material), *of_b = materials + row_b * reals_of(Buffer::material);
    write_contact(manifold, of_a, of_b, out, next_.features[row].data());
    out[31] = Scalar(touch.impact);
    while (old < before_rows && s.contacts.keys[old] < key) old++;
    if (old < before_rows && s.contacts.keys[old] == key)
      remember_impulses(before + old * reals, s.contacts.features[old].data(), Scalar(margin(a, b)), out,
                        next_.features[row].data());
    found.points += manifold.count;
    found.restitution |= out[30] > 0;
    found.rolling |= std::max({of_a[4], of_a[5], of_b[4], of_b[5]}) > 0;
    found.impacts = found.impacts || touch.impact > 0;
    if (found.impacts || touch.impact < 0 || !(out[30] > 0)) return;
    Scalar apart[3] = {0, 0, 0};
    bodies.shift(row_a, row_b, apart);
    found.impacts = fastest(manifold, twists_[row_a], twists_[row_b], apart) + fall / dt >= options.least_bounce;
  };
  if (round_)
    marks_.each(add);
  else
    for (const std::uint32_t i : near_) add(i);
  found.contacts = std::uint32_t(next_.keys.size()) - 1;
  found.placed = s.settling > 0 && some_settles(s.tables, next_.ends);
  found.changed = next_.ends != s.contacts.ends || next_.keys != s.contacts.keys;
  scratch.contacts.resize(next_.keys.size() * reals * sizeof(Scalar));
  s.tables.exchange(Table::contact, Buffer::contact, scratch.contacts, std::uint32_t(next_.keys.size()));
  std::swap(s.contacts, next_);
  replaced_ = true;
  return {};
}

}  // namespace pcphys
