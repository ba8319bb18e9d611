// Which pairs touch, and the contacts that come of them: the narrow phase of a step.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "collision/detector.h"
#include "collision/flights.h"
#include "collision/meeting.h"
#include "collision/view.h"

namespace pcphys {
namespace {

template <class Scalar> Vec3 to_vec3(const Scalar* v) { return {double(v[0]), double(v[1]), double(v[2])}; }

/// Whether some contact is of a body that was just placed and settles still after this step has begun.
bool some_settles(const WorldState& s, std::span<const std::array<std::uint32_t, 2>> ends) {
  return std::ranges::any_of(ends, [&](const auto& e) { return s.settles(e[0]) || s.settles(e[1]); });
}

}  // namespace

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

void Detector::leave_out_sleepers() {
  if (!parts_.empty()) std::erase_if(near_, [&](std::uint32_t i) { return !looked_at(pairs_.pairs()[i]); });
}

template <class Scalar> void Detector::sort_out(const Options& options, Scratch<Scalar>& scratch) {
  PairLanes<Scalar>& lanes = scratch.lanes;
  lanes.begin(batch_.size());
  marks_.clear(batch_.size());
  const Kind<Scalar>* kinds = scratch.kinds.data();
  const Pair* pairs = pairs_.pairs().data();
  const bool native = options.narrow == NarrowPhase::native;
  for (std::uint32_t place = 0; place < batch_.size(); place++) {
    auto [a, b] = pairs[batch_[place]];
    if (!kinds[a].responds) std::swap(a, b);  // as in_order
    const Kind<Scalar>&x = kinds[a], &y = kinds[b];
    const PairKind kind = pair_kind(x.kind, y.kind);
    if (native && kind != PairKind::other)
      lanes.add(kind, place, a, b, std::min(x.margin, y.margin) + Scalar(x.reach + y.reach));
    else
      lanes.leave(place), marks_.set(place);
  }
  lanes.run(narrow_lanes<Scalar>(options.lanes), reinterpret_cast<const Scalar*>(scratch.rows.data()), marks_);
}

template <class Scalar>
void Detector::find_manifolds(const WorldState& s, const Options& options, Scratch<Scalar>& scratch) {
  alone_.clear();
  each_candidate([&](std::uint32_t place) {
    if (!round_ || !scratch.lanes.manifold(place)) alone_.push_back(batch_[place]);
  });
  scratch.manifolds.resize(alone_.size());
  options.share(alone_.size(), [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t k = begin; k < end; k++) {
      const Sight<Scalar> view = sight(s, scratch, alone_[k]);
      scratch.manifolds[k].count = 0;
      find(options, view, scratch.shapes[view.shapes[0]], view.there, alone_[k], scratch.manifolds[k]);
    }
  });
  for (const std::uint32_t i : alone_) hinted_ |= hints_[i] != 0;
}

template <class Scalar>
bool Detector::touches(Scratch<Scalar>& scratch, std::uint32_t place, std::size_t& found, Touch<Scalar>& touch) {
  const Pair shapes = in_order(batch_[place]);
  const Proxy &a = proxies_[shapes.a], &b = proxies_[shapes.b];
  touch.rows[0] = a.body, touch.rows[1] = b.body;
  touch.impact = a.jointed || b.jointed ? -1 : 0;
  touch.manifold = round_ ? scratch.lanes.manifold(place) : nullptr;
  if (!touch.manifold) touch.manifold = &scratch.manifolds[found++];
  return touch.manifold->count > 0;
}

/// Whether a contact of the last step pushed.
template <class Scalar> bool holds(const Scalar* contact) {
  return contact[3] > 0 && std::max({contact[20], contact[21], contact[22], contact[23]}) > 0;
}

/// How a pair stands when the step begins, whose contact held something in the last one or not. Rows of shapes that are
/// apart are of no manifold yet.
template <class Scalar>
Standing Detector::stand(const WorldState& s, const Scratch<Scalar>& scratch, std::uint32_t pair, bool held,
                         Touch<Scalar>& touch) const {
  const Sight<Scalar> view = sight(s, scratch, pair);
  Manifold<Scalar>& m = *touch.manifold;
  Standing c;
  c.shapes[0] = view.shapes[0], c.shapes[1] = view.shapes[1];
  c.rows[0] = touch.rows[0], c.rows[1] = touch.rows[1];
  c.thick = thickness(c.shapes[0], c.shapes[1]);
  c.jointed = touch.impact < 0;
  c.hint = hints_[pair];
  const double far = length({double(view.apart[0]), double(view.apart[1]), double(view.apart[2])});
  const double near = near_of(double(c.thick), far, double(std::numeric_limits<Scalar>::epsilon()));
  const double most = held ? seam_share * double(c.thick) : near;
  c.gap = double(least_separation(m));
  if (c.gap > most) c.gap = std::min(c.gap, double(support_gap(scratch.shapes[view.shapes[0]], view.there, m.normal)));
  c.touches = c.acts = c.gap <= most;
  for (std::uint32_t i = 0; i < m.count && c.touches; i++) c.together |= std::uint8_t(1u << i);
  const Vec3 normal = to_vec3(m.normal);
  c.soon = !c.touches && c.gap < centre_comes(c, 0, normal) + centre_comes(c, 1, normal);
  if (c.touches)
    to_light_side(m, share_of<Scalar>(s.tables, touch.rows[0], touch.rows[1]));
  else
    m.count = 0;
  return c;
}

/// How far a body of a contact comes towards the other in the step, as its centre moves [m].
double Detector::centre_comes(const Standing& c, int side, const Vec3& normal) const {
  const Twist& t = twists_[c.rows[side]];
  const double along = normal.x * double(t.v[0]) + normal.y * double(t.v[1]) + normal.z * double(t.v[2]);
  return (side == 0 ? along : -along) * dt_ + (proxies_[c.shapes[side]].responds ? fall_ : 0);
}

/// Shapes that are further apart than they are thick: how far each comes towards the other by its own motion, unless
/// something sends it elsewhere.
Detector::Distant Detector::distant(std::uint32_t row, const Standing& c, const Vec3& normal) const {
  const auto comes = [&](int side) {
    const Proxy& p = proxies_[c.shapes[side]];
    const Twist& t = twists_[c.rows[side]];
    const double turns = std::min(double(t.across) * dt_, double(largest_turn)) * double(p.lever_across) +
                         std::min(double(t.turn) * dt_, double(largest_turn)) * double(p.lever_any);
    return centre_comes(c, side, normal) + turns;
  };
  return {row, c.gap - margin(c.shapes[0], c.shapes[1]), {comes(0), comes(1)}};
}

/// Bodies of a contact are of one island and need one another's sub-steps. So distant pairs are none that do not come
/// together, wherever contacts with others may send their bodies.
void Detector::drop_distant(ContactColumns& contacts, AlignedBytes& table, std::size_t row_bytes) {
  if (distant_.empty()) return;
  sent_elsewhere_.assign(levers_.size(), false);
  const auto note = [&](std::uint32_t row) {
    for (const std::uint32_t body : contacts.ends[row]) sent_elsewhere_[body] = true;
  };
  std::size_t next = 0;
  for (std::uint32_t row = 1; row < contacts.keys.size(); row++) {
    const bool far = next < distant_.size() && distant_[next].row == row;
    if (!far || distant_[next].comes[0] + distant_[next].comes[1] >= distant_[next].gap) note(row);
    next += far;
  }
  std::size_t kept = 1;
  next = 0;
  for (std::uint32_t row = 1; row < contacts.keys.size(); row++) {
    if (next < distant_.size() && distant_[next].row == row) {
      const Distant& d = distant_[next++];
      const auto comes = [&](int side) {
        const std::uint32_t body = contacts.ends[row][std::size_t(side)];
        return sent_elsewhere_[body] ? double(reach_[standings_[row].shapes[side]]) : d.comes[side];
      };
      if (comes(0) + comes(1) < d.gap) continue;
    }
    if (kept != row) {
      contacts.keys[kept] = contacts.keys[row];
      contacts.ends[kept] = contacts.ends[row];
      contacts.features[kept] = contacts.features[row];
      standings_[kept] = standings_[row];
      std::copy_n(table.data() + row * row_bytes, row_bytes, table.data() + kept * row_bytes);
    }
    kept++;
  }
  contacts.keys.resize(kept);
  contacts.ends.resize(kept);
  contacts.features.resize(kept);
  standings_.resize(kept);
}

template <class Scalar>
void Detector::keep(const WorldState& s, Scratch<Scalar>& scratch, std::uint32_t first, std::uint32_t last,
                    Found& found) {
  if (first == last) return;
  const std::size_t row = next_.keys.size(), bytes = reals_of(Buffer::contact) * sizeof(Scalar);
  const auto copy = [&](const auto& from, auto& to) { to.insert(to.end(), from.begin() + first, from.begin() + last); };
  copy(s.contacts.keys, next_.keys);
  copy(s.contacts.ends, next_.ends);
  copy(s.contacts.features, next_.features);
  const std::size_t end = (row + last - first) * bytes;
  if (scratch.contacts.size() < end) scratch.contacts.resize(end);
  const std::byte* contacts = s.tables.bytes(Buffer::contact).data();
  std::copy(contacts + first * bytes, contacts + last * bytes, scratch.contacts.data() + row * bytes);
  standings_.resize(row + last - first);
  for (std::size_t i = row; i < standings_.size(); i++) std::ranges::copy(next_.ends[i], standings_[i].rows);
  found.kept += last - first;
  for (; first < last; first++)
    found.kept_points += std::uint32_t(s.tables.data<Scalar>(Buffer::contact)[first * reals_of(Buffer::contact) + 3]);
}

/// The contacts of this step, in ascending order of their keys, from its pairs and the contacts of the last one, which
/// stand in that order too.
template <class Scalar> struct Detector::Merge {
  Detector& d;
  WorldState& s;
  Scratch<Scalar>& scratch;
  Found& found;
  const Scalar* materials = s.tables.data<Scalar>(Buffer::material);
  const Scalar* before = s.tables.data<Scalar>(Buffer::contact);
  std::uint32_t before_rows = s.contact_rows(), old = 1, kept = d.parts_.empty() ? before_rows : 1;
  std::size_t of_alone = 0;  // how many of a batch had no manifold in lanes
  BodyReader<Scalar> bodies{s.tables};
  Touch<Scalar> touch{};
  static constexpr std::size_t reals = reals_of(Buffer::contact);

  /// Contacts of what sleeps, up to a key; null: all.
  void keep_until(const ContactKey* end) {
    const auto ends = [&] { return kept == before_rows || (end && *end <= s.contacts.keys[kept]); };
    while (!ends()) {
      const std::uint32_t first = kept;
      while (!ends() && d.stays(s.contacts.ends[kept])) kept++;
      d.keep(s, scratch, first, kept, found);
      while (!ends() && !d.stays(s.contacts.ends[kept])) kept++;
    }
  }

  void add(std::uint32_t place) {
    if (!d.touches(scratch, place, of_alone, touch)) return;
    const std::uint32_t pair = d.batch_[place];
    const auto [a, b] = d.pairs_.pairs()[pair];
    const ContactKey key{a, b};
    while (old < before_rows && s.contacts.keys[old] < key) old++;
    const bool was_there = old < before_rows && s.contacts.keys[old] == key;
    const Scalar* was = was_there ? before + old * reals : nullptr;
    found.faces |= touch.manifold->count > 1;
    const Standing standing = d.template stand<Scalar>(s, scratch, pair, was_there && holds(was), touch);
    if (kept < before_rows) keep_until(&key);
    const std::size_t row = d.next_.keys.size();
    d.next_.keys.push_back(key);
    d.next_.ends.push_back({touch.rows[0], touch.rows[1]});
    d.next_.features.push_back({});
    d.standings_.resize(row + 1);
    d.standings_[row] = standing;
    if (!d.parts_.empty())
      for (const std::uint32_t body : touch.rows)
        if (d.parts_[body] == Part::sleeps) d.touched_.push_back(body);
    const double margin = d.margin(a, b);
    if (!standing.touches && standing.gap > margin + double(standing.thick))
      d.distant_.push_back(d.distant(std::uint32_t(row), standing, to_vec3(touch.manifold->normal)));
    write(row, standing.touches ? was : nullptr, margin);
  }

  /// `was`: the row of before, if its impulses are to act on.
  void write(std::size_t row, const Scalar* was, double margin) {
    const std::size_t end = (row + 1) * reals * sizeof(Scalar);
    if (scratch.contacts.size() < end) scratch.contacts.resize(end);
    Scalar* out = reinterpret_cast<Scalar*>(scratch.contacts.data()) + row * reals;
    auto& features = d.next_.features.back();
    const Scalar* of_a = materials + touch.rows[0] * reals_of(Buffer::material);
    const Scalar* of_b = materials + touch.rows[1] * reals_of(Buffer::material);
    write_contact(*touch.manifold, of_a, of_b, out, features.data());
    out[place::impact_time] = Scalar(touch.impact);
    bodies.shift(touch.rows[0], touch.rows[1], out + place::apart);
    if (was) remember_impulses(was, s.contacts.features[old].data(), Scalar(margin), out, features.data());
    found.points += touch.manifold->count;
    found.friction |= out[28] > 0 || out[29] > 0;
    d.standings_[row].bounces = out[30] > 0;
    found.restitution |= out[30] > 0;
    found.rolling |= std::max({of_a[4], of_a[5], of_b[4], of_b[5]}) > 0;
    found.impacts |= touch.impact >= 0;
  }
};

template <class Scalar>
Status Detector::narrow_all(WorldState& s, const Options& options, Scratch<Scalar>& scratch, Found& found) {
  next_.keys.resize(1);
  next_.ends.resize(1);
  next_.features.resize(1);
  standings_.resize(1);
  later_.resize(1);
  for (std::vector<std::uint32_t>& rows : anew_) rows.clear();
  listed_level_ = 0;
  none_struck_ = true;
  distant_.clear();
  touched_.clear();
  hints_.resize(pairs_.pairs().size());
  found = {};
  found.pairs = std::uint32_t(near_.size());
  leave_out_sleepers();
  Merge<Scalar> merge{*this, s, scratch, found};
  for (std::size_t first = 0; first < near_.size(); first += most_in_batch) {
    batch_ = std::span(near_).subspan(first, std::min(most_in_batch, near_.size() - first));
    merge.of_alone = 0;
    if (round_) sort_out(options, scratch);
    find_manifolds(s, options, scratch);
    each_candidate([&](std::uint32_t place) { merge.add(place); });
  }
  merge.keep_until(nullptr);
  found.points += found.kept_points;
  const std::size_t row_bytes = reals_of(Buffer::contact) * sizeof(Scalar);
  drop_distant(next_, scratch.contacts, row_bytes);
  found.contacts = std::uint32_t(next_.keys.size()) - 1;
  starts_.resize(s.bodies.size());
  for (std::uint32_t row = 0; row < starts_.size(); row++) starts_[row] = merge.bodies.position(row);
  found.placed = s.settling > 0 && some_settles(s, next_.ends);
  found.changed = next_.ends != s.contacts.ends || next_.keys != s.contacts.keys;
  scratch.contacts.resize(next_.keys.size() * row_bytes);
  s.tables.exchange(Table::contact, Buffer::contact, scratch.contacts, std::uint32_t(next_.keys.size()));
  std::swap(s.contacts, next_);
  replaced_ = true;
  return {};
}

template Status Detector::narrow_all(WorldState&, const Options&, Scratch<float>&, Found&);
template Status Detector::narrow_all(WorldState&, const Options&, Scratch<double>&, Found&);

}  // namespace pcphys
