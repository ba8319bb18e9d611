// Which pairs touch, and the contacts that come of them: the narrow phase of a step.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "collision/detector.h"
#include "collision/flights.h"
#include "collision/view.h"

namespace pcphys {
namespace {

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

/// Whether some contact is of a body that was just placed and settles still after this step has begun.
bool some_settles(const WorldState& s, std::span<const std::array<std::uint32_t, 2>> ends) {
  return std::ranges::any_of(ends, [&](const auto& e) { return s.settles(e[0]) || s.settles(e[1]); });
}

/// The largest speed at which a gap closes [m/s].
template <class Scalar> double fastest(const Manifold<Scalar>& m, const Twist& a, const Twist& b, const Scalar* apart) {
  float n[3], d[3], most = 0;
  for (int k = 0; k < 3; k++) n[k] = float(m.normal[k]), d[k] = float(apart[k]);
  for (std::uint32_t i = 0; i < m.count; i++) {
    const float r[3] = {float(m.points[i].p[0]), float(m.points[i].p[1]), float(m.points[i].p[2])};
    most = std::max(most, passing(a, b, n, r, d).closing);
  }
  return double(most);
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
  if (!through_.empty()) std::erase_if(near_, [&](std::uint32_t i) { return let_through(pairs[i]); });
  if (!parts_.empty()) std::erase_if(near_, [&](std::uint32_t i) { return !looked_at(pairs[i]); });
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
  if (draws_ && a.responds != b.responds) {  // what stands is met by whatever is sent there
    const double far = margin + double(drawn_[a.responds ? a.body : b.body]);
    for (std::uint32_t i = 0; i < manifold.count; i++)
      if (double(manifold.points[i].separation) <= far) return true;
  }
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
void Detector::keep(const WorldState& s, Scratch<Scalar>& scratch, std::uint32_t first, std::uint32_t last, Found& found) {
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
  found.kept += last - first;
  for (; first < last; first++)
    found.kept_points += std::uint32_t(s.tables.data<Scalar>(Buffer::contact)[first * reals_of(Buffer::contact) + 3]);
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
  touched_.clear();
  std::uint32_t kept = parts_.empty() ? before_rows : 1;
  // contacts of what sleeps, up to a key
  const auto keep_until = [&](const ContactKey* end) {
    const auto ends = [&] { return kept == before_rows || (end && *end <= s.contacts.keys[kept]); };
    while (!ends()) {
      const std::uint32_t first = kept;
      while (!ends() && stays(s.contacts.ends[kept])) kept++;
      keep(s, scratch, first, kept, found);
      while (!ends() && !stays(s.contacts.ends[kept])) kept++;
    }
  };
  const auto add = [&](std::uint32_t i) {
    if (!touches(s, dt, options, scratch, i, touch)) return;
    const auto [a, b] = pairs[i];
    const auto [row_a, row_b] = touch.rows;
    const Manifold<Scalar>& manifold = *touch.manifold;
    const ContactKey key{a, b};
    if (kept < before_rows) keep_until(&key);
    const std::size_t row = next_.keys.size();
    next_.keys.push_back(key);
    next_.ends.push_back({row_a, row_b});
    next_.features.push_back({});
    if (scratch.contacts.size() < (row + 1) * reals * sizeof(Scalar)) scratch.contacts.resize((row + 1) * reals * sizeof(Scalar));
    Scalar* out = reinterpret_cast<Scalar*>(scratch.contacts.data()) + row * reals;
    auto& features = next_.features.back();
    if (!parts_.empty())
      for (const std::uint32_t body : touch.rows)
        if (parts_[body] == Part::sleeps) touched_.push_back(body);
    const Scalar *of_a = materials + row_a * reals_of(Buffer::material), *of_b = materials + row_b * reals_of(Buffer::material);
    write_contact(manifold, of_a, of_b, out, features.data());
    out[31] = Scalar(touch.impact);
    while (old < before_rows && s.contacts.keys[old] < key) old++;
    if (old < before_rows && s.contacts.keys[old] == key)
      remember_impulses(before + old * reals, s.contacts.features[old].data(), Scalar(margin(a, b)), out, features.data());
    found.points += manifold.count;
    found.friction |= out[28] > 0 || out[29] > 0;
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
  keep_until(nullptr);
  found.points += found.kept_points;
  found.contacts = std::uint32_t(next_.keys.size()) - 1;
  found.placed = s.settling > 0 && some_settles(s, next_.ends);
  found.changed = next_.ends != s.contacts.ends || next_.keys != s.contacts.keys;
  scratch.contacts.resize(next_.keys.size() * reals * sizeof(Scalar));
  s.tables.exchange(Table::contact, Buffer::contact, scratch.contacts, std::uint32_t(next_.keys.size()));
  std::swap(s.contacts, next_);
  replaced_ = true;
  return {};
}

template Status Detector::narrow_all(WorldState&, double, const Options&, Scratch<float>&, Found&);
template Status Detector::narrow_all(WorldState&, double, const Options&, Scratch<double>&, Found&);

}  // namespace pcphys
