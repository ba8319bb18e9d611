#include "collision/detector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "collision/hook.h"
#include "collision/view.h"
#include "pcphys/constants.h"
#include "world/union_find.h"

namespace pcphys {
namespace {

bool may_touch(const void* filter, std::uint32_t a, std::uint32_t b) {
  return (*static_cast<const PairFilter*>(filter))(a, b);
}

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

}  // namespace

namespace {
bool meets_some(const ShapeRecord& shape) { return shape.alive && (shape.filter.mask != 0 || shape.filter.group > 0); }

bool some_could_touch(const WorldState& s) {
  std::uint32_t solid = 0;
  bool responds = false;
  for (const ShapeRecord& shape : s.shapes) {
    if (!meets_some(shape)) continue;
    solid++;
    responds |= s.responds(s.body_ids.row(shape.body));
    if (responds && solid > 1) return true;
  }
  return false;
}

/// By body row the lowest row of its joint tree, whatever the order of the joints; 0 for bodies of none, and where the
/// tree hangs on something that does not respond. (What never gives way may leave a body nowhere to go, wherever it is
/// looked for: docs/substeps.md, hands that slip.) Empty where there are no joints.
void list_trees(const WorldState& s, std::vector<std::uint32_t>& trees) {
  trees.clear();
  if (s.joints.size() == 1) return;
  trees.resize(s.bodies.size());
  UnionFind joined(s.bodies.size());
  std::vector<bool> jointed(s.bodies.size());
  for (std::uint32_t row = 1; row < s.joints.size(); row++) {
    if (s.joints[row].spring) continue;
    std::uint32_t ends[] = {s.body_ids.row(s.joints[row].body_a), s.body_ids.row(s.joints[row].body_b)};
    for (std::uint32_t& end : ends) {
      jointed[end] = true;
      if (!s.responds(end)) end = 0;  // what hangs on row 0 is held
    }
    joined.join(ends[0], ends[1]);
  }
  for (std::uint32_t row = 1; row < trees.size(); row++) trees[row] = jointed[row] ? joined.root(row) : 0;
}

/// Bodies that hang on joints, by row.
std::vector<bool> jointed_rows(const WorldState& s) {
  std::vector<bool> jointed(s.bodies.size());
  for (std::uint32_t row = 1; row < s.joints.size(); row++)
    for (std::uint32_t body : {s.joints[row].body_a, s.joints[row].body_b}) jointed[s.body_ids.row(body)] = true;
  return jointed;
}
}  // namespace

void Detector::follow(const WorldState& s) {
  if (structure_ == s.structure_version && serial_ == s.serial) return;
  const bool same_bodies =
      structure_ > 0 && serial_ == s.serial && structure_ - joint_changes_ == s.structure_version - s.joint_changes;
  structure_ = s.structure_version;
  joint_changes_ = s.joint_changes;
  serial_ = s.serial;
  same_bodies ? follow_joints(s) : rebuild(s);
}

void Detector::follow_joints(const WorldState& s) {
  if (!possible_) return;
  std::vector<std::uint32_t> changed;
  filter_->follow_joints(s, changed);
  for (const std::uint32_t shape : changed)
    if (proxies_[shape].alive) pairs_.touch(shape);
  const std::vector<bool> jointed = jointed_rows(s);
  for (Proxy& proxy : proxies_) proxy.jointed = proxy.alive && jointed[proxy.body];
  list_trees(s, trees_);
}

void Detector::rebuild(const WorldState& s) {
  pairs_ = PairCache();
  list_trees(s, trees_);
  possible_ = some_could_touch(s);
  hints_.clear();
  hinted_ = false;
  proxies_.clear();
  standing_.clear();
  round_ = false;
  rest_ = 0;
  if (!possible_) return;  // none of the columns below is needed
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
  thinnest_ = std::numeric_limits<float>::infinity();
  levers_.assign(s.bodies.size(), 0);
  ways_.assign(s.bodies.size(), {});
  twisted_.assign(s.bodies.size(), 0);
  const std::vector<bool> jointed = jointed_rows(s);
  for (std::uint32_t i = 0; i < s.shapes.size(); i++) {
    const ShapeRecord& shape = s.shapes[i];
    if (!meets_some(shape)) continue;
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
    levers_[row] = std::max(levers_[row], across + any);
    round_ |= shape.def.kind == ShapeKind::sphere || shape.def.kind == ShapeKind::capsule;
    if (shape.def.kind == ShapeKind::plane || shape.def.kind == ShapeKind::hull) odd_.push_back(i);
    if (proxies_[i].responds) thinnest_ = std::min(thinnest_, proxies_[i].inner);
    if (!s.responds(row)) standing_.push_back(i);
    pairs_.add(i, !s.stands(row));
  }
}

std::size_t Detector::memory_bytes() const {
  const std::size_t of_shapes =
      bytes_of(proxies_, standing_, tight_, margins_, reach_, columns_, rows_, odd_, *filter_);
  const std::size_t of_bodies = bytes_of(parts_, touched_, twists_, rounded_, moving_, bodies_, starts_, levers_, ways_,
                                         twisted_, touching_, times_struck_, marked_, swept_, first_of_, contacts_of_,
                                         of_marked_, soonest_, sent_elsewhere_, went_, trees_, fastest_, drawn_);
  const std::size_t of_contacts = bytes_of(standings_, later_, renewed_, struck_, waiting_, unseen_, beside_struck_,
                                           on_standing_, inner_, beside_, looks_, anew_, distant_, gone_, next_);
  return of_shapes + of_bodies + of_contacts +
         bytes_of(pairs_, near_, marks_, hints_, next_hints_, alone_, scratch_f_, scratch_d_);
}

void Detector::follow_rest(const WorldState& s) {
  if (rest_ == s.rest_version) return;
  rest_ = s.rest_version;
  parts_.clear();
  if (s.sleepers == 0) return;
  parts_.resize(s.bodies.size(), Part::none);
  for (std::uint32_t row = 0; row < parts_.size(); row++) {
    if (s.asleep(row))
      parts_[row] = Part::sleeps;
    else if (!s.stands(row) || s.tables.get(Buffer::rest, row, rest_stirred) > 0)
      parts_[row] = Part::looked_at;
  }
}

bool Detector::some_material(const WorldState& s, std::initializer_list<std::uint32_t> offsets) {
  for (std::uint32_t row = 1; row < s.bodies.size(); row++)  // the ground has no shapes
    for (std::uint32_t k : offsets)
      if (s.tables.get(Buffer::material, row, k) > 0) return true;
  return false;
}

namespace {
/// What a list holds beside pairs whose tight boxes overlap depends on what the broad phase has seen, so it has room
/// for some more: whether there are too many is asked of those that overlap.
constexpr std::size_t list_room(std::size_t max_pairs) { return 4 * max_pairs + 64; }

Error too_many_pairs(std::uint64_t needed, bool exact, std::size_t room) {
  return {ErrorCode::buffer_full,
          "The scene has " + std::to_string(needed) + (exact ? "" : " or fewer") +
              " pairs of shapes close together and room for " + std::to_string(room) +
              "; raise StepSettings::max_pairs, or spread the bodies. The world is as before the step."};
}
}  // namespace

Status Detector::find_pairs(const WorldState& s, double dt, const Options& options) {
  follow(s);
  follow_rest(s);
  near_.clear();
  if (!possible_) return {};
  if (s.tables.precision() == Precision::f32)
    bound(s, dt, options, scratch_f_);
  else
    bound(s, dt, options, scratch_d_);
  pairs_.set_capacity(list_room(options.max_pairs));
  const PairReport report = pairs_.update(tight_);
  if (report.overflow) return too_many_pairs(report.pairs_needed, false, options.max_pairs);
  if (report.refused > 0) {
    const std::uint32_t body = s.shapes[report.first_refused].body;
    structure_ = 0;  // the broad phase dropped the shape: list all of them anew once the host has mended it
    return Error{ErrorCode::not_finite,
                 "The pose or velocity of body " + std::to_string(body) +
                     " is not finite; set it anew or destroy the body. The world is as before the step."};
  }
  if (report.changed) {
    const std::size_t pairs = pairs_.pairs().size();
    if (next_hints_.capacity() < pairs)
      next_hints_.reserve(pairs + pairs / 4);  // a few more than ever before are no reason to allocate
    next_hints_.assign(pairs, 0);
    const auto previous = pairs_.previous_index();
    for (std::size_t i = 0; hinted_ && i < next_hints_.size(); i++)
      next_hints_[i] = previous[i] < hints_.size() ? hints_[previous[i]] : 0;
    hints_.swap(next_hints_);
  }
  list_near();
  if (near_.size() > options.max_pairs) return too_many_pairs(near_.size(), true, options.max_pairs);
  return {};
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

// A body that went its reach and half of its thickness is at most half sunk into what it never saw:
// the next step finds it.
template <class Scalar> bool Detector::collect_strays(const WorldState& s, const Scalar* before) {
  const Scalar* now = s.tables.data<Scalar>(Buffer::pose);
  bool found = false;
  for (std::uint32_t i = 0; i < proxies_.size(); i++) {
    const Proxy& proxy = proxies_[i];
    if (!proxy.alive || !proxy.responds) continue;
    const Scalar *p = now + proxy.body * reals_of(Buffer::pose), *q = before + proxy.body * reals_of(Buffer::pose);
    const float x = float(p[0] - q[0]), y = float(p[1] - q[1]), z = float(p[2] - q[2]),
                seen = reach_[i] + 0.5f * proxy.inner;
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

Status Detector::find_contacts(WorldState& s, const Options& options, Found& found) {
  replaced_ = false;
  gone_.clear();  // of a step that could not be made
  if (!possible_ && s.contact_rows() == 1) return {};
  return s.tables.precision() == Precision::f32 ? narrow_all(s, options, scratch<float>(), found)
                                                : narrow_all(s, options, scratch<double>(), found);
}

}  // namespace pcphys
