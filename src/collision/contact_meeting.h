// One contact in one sub-step: whether its shapes touch or come together, when, and the manifold there.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "collision/detector.h"
#include "collision/flights.h"
#include "collision/hook.h"
#include "collision/meeting.h"
#include "collision/substep_bodies.h"
#include "collision/support_gap.h"

namespace pcphys {

inline constexpr std::size_t contact_reals = reals_of(Buffer::contact);

inline double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/// Points of a manifold that go on from those of the one before: its number from 1, by feature, or 0.
template <class Scalar>
std::array<std::uint32_t, 4> points_before(const Manifold<Scalar>& m, const std::array<std::uint32_t, 4>& before) {
  std::array<std::uint32_t, 4> from{};
  bool taken[4] = {};
  for (std::uint32_t i = 0; i < m.count; i++)
    for (std::uint32_t j = 0; j < 4 && from[i] == 0; j++) {
      if (taken[j] || m.points[i].feature != before[j]) continue;
      taken[j] = true;
      from[i] = j + 1;
    }
  return from;
}

/// What is left over goes to the nearest point of before: a feature may change its name while the contact stays.
template <class Scalar>
void match_nearest(const Manifold<Scalar>& m, const Scalar* before, std::uint32_t count,
                   std::array<std::uint32_t, 4>& from) {
  for (std::uint32_t i = 0; i < m.count; i++) {
    if (from[i] != 0) continue;
    Scalar best = std::numeric_limits<Scalar>::max();
    for (std::uint32_t j = 0; j < count; j++) {
      if (std::find(from.begin(), from.end(), j + 1) != from.end()) continue;
      Scalar squared = 0;
      for (std::uint32_t k = 0; k < 3; k++) {
        const Scalar off = m.points[i].p[k] - before[4 + 4 * j + k];
        squared += off * off;
      }
      if (squared >= best) continue;
      best = squared;
      from[i] = j + 1;
    }
  }
}

/// What a sub-step's contacts are looked at with.
template <class Scalar> struct Detector::Substep {
  WorldState& s;
  const Bodies<Scalar>& bodies;
  std::span<const std::uint32_t> contacts, places;  // of the level: see Listed
  const Options& options;
  double h;
  bool first = false, last = false;  // the first sub-step of the step; the last look of the sub-step
};

/// Looks, of which `does` is one. The rows that it renews are those that count as such until the level is looked at
/// again.
template <class Does>
void Detector::look_in(WorldState& s, const Listed& contacts, unsigned level, double h, const Options& options,
                       const Does& does) {
  meetings_++;
  renewed_.clear();
  if (anew_.size() <= level) anew_.resize(level + 1);
  const auto in = [&]<class Scalar>(Scalar) {
    Scalar* const rows = s.tables.data<Scalar>(Buffer::contact);
    for (const std::uint32_t row : anew_[level]) rows[row * contact_reals + place::found_anew] = 0;
    const Bodies<Scalar> bodies(s.tables);
    scratch<Scalar>().twists.resize(twisted_.size());
    does(Substep<Scalar>{s, bodies, contacts.rows, contacts.places, options, h});
  };
  s.tables.precision() == Precision::f32 ? in(float{}) : in(double{});
  anew_[level].clear();
  for (const std::uint32_t at : renewed_) anew_[level].push_back(contacts.rows[at]);
}

/// One contact in one sub-step.
template <class Scalar> struct Detector::Meeting {
  Detector& d;
  WorldState& s;
  const Bodies<Scalar>& bodies;
  const Options& options;
  double h;
  std::uint32_t row;

  Standing& c = d.standings_[row];
  Scalar* out = s.tables.data<Scalar>(Buffer::contact) + row * contact_reals;
  std::uint32_t row_a = c.rows[0], row_b = c.rows[1];
  const Proxy &pa = d.proxies_[c.shapes[0]], &pb = d.proxies_[c.shapes[1]];
  double thick = double(c.thick);
  double share = share_of<Scalar>(s.tables, row_a, row_b);
  Moved now = bodies.moved(row_a, row_b);
  const TwistOf<Scalar>&ta = d.twist_of(bodies, row_a), &tb = d.twist_of(bodies, row_b);
  Scalar apart[3] = {0, 0, 0};
  Scalar look = 0;

  static double lever(const Proxy& p) { return double(p.lever_any) + double(p.lever_across); }
  static double spin(const TwistOf<Scalar>& t, const Proxy& p) {
    return double(t.across) * double(p.lever_across) + double(t.turn) * double(p.lever_any);
  }
  double speed() const {
    double squared = 0;
    for (int k = 0; k < 3; k++) squared += (double(tb.v[k]) - double(ta.v[k])) * (double(tb.v[k]) - double(ta.v[k]));
    return std::sqrt(squared);
  }
  /// How far the two may have come against each other since they were looked at, at most [m].
  double moved() const {
    const Moved& then = d.later_[c.later].moved;
    return distance(now.apart, then.apart) + distance(now.turned_a, then.turned_a) * lever(pa) +
           distance(now.turned_b, then.turned_b) * lever(pb);
  }
  /// And how far they may come in the sub-step by their own velocities [m].
  double way() const { return (speed() + spin(ta, pa) + spin(tb, pb)) * h; }
  /// What moves fast along what answers too, or turns into it, is struck and not held: nothing of the contact lasts.
  bool quick() const {
    const double turns = (pa.responds ? spin(ta, pa) : 0) + (pb.responds ? spin(tb, pb) : 0);
    const double shifts = (speed() * std::min(share, 1 - share) + turns) * h;
    return shifts > constants::stale_share * thick;
  }

  /// Whether shapes that are apart come no nearer than `near` in the sub-step.
  bool passes_by(double near) const { return !c.touches && c.gap - moved() > way() + near; }

  void stand_aside() {
    if (!c.acts) return;
    c.acts = c.struck = false;
    out[place::impact_time] = c.jointed ? -1 : 0;
    out[place::found_anew] = 2;
    std::fill_n(out + place::from_point, 4, Scalar(0));
    s.contacts.features[row].fill(0xffffffffu);
  }

  ShapeView<Scalar> view(const Proxy& p, std::uint32_t shape, std::uint32_t body) const {
    ShapeView<Scalar> v;
    const Scalar* at = s.tables.data<Scalar>(Buffer::shape) + (shape + 1) * reals_of(Buffer::shape);
    place_shape(at, p.kind, p.hull, p.centred, bodies.poses().orientation(body), v);
    return v;
  }
  void look_at(const ShapeView<Scalar>& x, const ShapeView<Scalar>& y, Manifold<Scalar>& m) const {
    if (options.narrow == NarrowPhase::fcl)
      fcl_hook()(x, y, look, m);
    else
      narrow(x, y, look, c.hint, m);
  }

  /// Of the two where they stand, with the manifold there; no end where they are further apart than is looked for [m].
  double gap_between(const ShapeView<Scalar>& a, ShapeView<Scalar> b, Manifold<Scalar>& m) const {
    for (int k = 0; k < 3; k++) b.p[k] += apart[k];
    look_at(a, b, m);
    if (m.count == 0) return std::numeric_limits<double>::infinity();
    return std::min(double(support_gap(a, b, m.normal)), double(least_separation(m)));
  }

  /// How fast they come together at the fastest of its points [m/s].
  double closing(const Manifold<Scalar>& m) const {
    double fastest = 0;
    for (std::uint32_t i = 0; i < m.count; i++)
      fastest = std::max(fastest, double(passing(ta, tb, m.normal, m.points[i].p, apart).closing));
    return fastest;
  }
  /// Whether what meets at `t` would be within the other by a quarter of its thickness at the end of the sub-step.
  bool sinks(const Manifold<Scalar>& m, double t) const { return closing(m) * (h - t) > thick / 2; }

  /// Whether they come together, and no faster than by what gravity gives in two sub-steps. What else holds them takes
  /// that back, which rows that are solved together know and an impact does not. (What bounces does so however slowly
  /// it comes. Limbs that part rest still: what their tree takes from them it gives back.)
  bool settles(const Manifold<Scalar>& m) const {
    if (c.bounces) return false;
    const double closing = this->closing(m);
    return (closing > 0 || c.jointed) && closing <= 2 * length(s.gravity) * h;
  }

  /// The points within this of the nearest are those that act. (Shapes may be as near by their supports as they are at
  /// no point of the manifold.)
  void find_together(const Manifold<Scalar>& m, double within) {
    const double most = std::max(0.0, double(least_separation(m))) + within;
    c.together = 0;
    for (std::uint32_t i = 0; i < m.count; i++)
      if (double(m.points[i].separation) <= most) c.together |= std::uint8_t(1u << i);
  }

  /// Whether one goes so far that it leaves the range of numbers: the step freezes it, and till then it meets nothing.
  static bool is_lost(double goes) { return !(goes < constants::largest_state); }

  /// `sent`: they were looked at before in the sub-step, and sent elsewhere since. Then what would sink in is stopped;
  /// the next sub-step sees the rest.
  void find(bool sent) {
    const double goes = way();
    const bool quick = this->quick();
    if (c.touches && !c.struck && !quick && moved() <= constants::contact_share * thick) return;
    if (passes_by(0) || is_lost(goes)) return stand_aside();
    const ShapeView<Scalar> a = view(pa, c.shapes[0], row_a), b = view(pb, c.shapes[1], row_b);
    bodies.poses().shift(row_a, row_b, apart);
    look = Scalar(d.margin(c.shapes[0], c.shapes[1]) + 2 * goes);
    Manifold<Scalar> m;
    const double gap = gap_between(a, b, m);
    d.later_[c.later].moved = now;
    c.looked = d.went(row_a) + d.went(row_b);
    c.touches = false;
    c.gap = m.count == 0 ? double(look) : gap;
    if (m.count == 0) return stand_aside();
    const double far = std::sqrt(double(apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]));
    const double near = near_of(thick, far, double(std::numeric_limits<Scalar>::epsilon()));
    c.touches = c.gap <= (!quick && (c.acts || settles(m)) ? seam_share * thick : near);
    double met = 0;
    if (!c.touches) {
      if (c.gap > goes) return stand_aside();
      const auto look_there = [&](const ShapeView<Scalar>& x, const ShapeView<Scalar>& y, Manifold<Scalar>& z) {
        look_at(x, y, z);
      };
      const auto at = meet_within(mover(pa, a, ta), mover(pb, b, tb), apart, near, 0.0, h, look_there, m);
      if (!at) return stand_aside();
      met = *at;
    }
    if (sent && !sinks(m, met)) {
      c.touches = false;
      return;
    }
    find_together(m, c.touches ? seam_share * thick : near);
    to_light_side(m, share);
    if (!c.touches) back_to_start(ta, tb, apart, share, met, m);
    // (what meets on its way overlaps nothing: rows of trees stop it there, and push nothing out)
    if (!c.touches && c.jointed)
      for (std::uint32_t i = 0; i < m.count; i++) m.points[i].separation = std::max(m.points[i].separation, Scalar(0));
    c.struck = !c.jointed && (!c.touches || quick);
    write(m, met, c.jointed ? -1 : c.struck ? std::max(met, 1e-9 * h) : 0);
  }

  /// Of shapes that were apart, whose bodies were struck elsewhere at `from` [s]: whether they meet after that.
  bool find_from(double from) {
    if (is_lost(way())) return false;
    bodies.poses().shift(row_a, row_b, apart);
    const double far = std::sqrt(double(apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]));
    const double near = near_of(thick, far, double(std::numeric_limits<Scalar>::epsilon()));
    if (passes_by(near)) return false;
    const ShapeView<Scalar> a = view(pa, c.shapes[0], row_a), b = view(pb, c.shapes[1], row_b);
    look = Scalar(d.margin(c.shapes[0], c.shapes[1]) + 2 * way());
    const auto look_there = [&](const ShapeView<Scalar>& x, const ShapeView<Scalar>& y, Manifold<Scalar>& z) {
      look_at(x, y, z);
    };
    Manifold<Scalar> m;
    const auto met =
        meet_within(mover(pa, a, ta), mover(pb, b, tb), apart, near, std::max(from, 1e-9 * h), h, look_there, m);
    if (!met) return false;
    find_together(m, near);
    to_light_side(m, share);
    back_to_start(ta, tb, apart, share, *met, m);
    c.struck = true;
    write(m, *met, std::max(*met, 1e-9 * h));
    return true;
  }
  static Mover<Scalar> mover(const Proxy& p, const ShapeView<Scalar>& shape, const TwistOf<Scalar>& t) {
    return {&shape, t, float(spin(t, p)), p.centred, float(lever(p))};
  }

  /// Impacts remember nothing. `t`: when the manifold was found [s].
  void write(const Manifold<Scalar>& m, double t, double impact) {
    std::array<std::uint32_t, 4> from{};
    if (c.acts && impact <= 0) {
      from = points_before(m, s.contacts.features[row]);
      match_nearest(m, out, std::uint32_t(out[3]), from);
    }
    c.acts = true;
    for (int k = 0; k < 3; k++) out[k] = m.normal[k];
    out[3] = Scalar(m.count);
    for (std::uint32_t i = 0; i < 4; i++) {
      const bool real = i < m.count;
      for (std::uint32_t k = 0; k < 3; k++) out[4 + 4 * i + k] = real ? m.points[i].p[k] : Scalar(0);
      out[7 + 4 * i] = real ? m.points[i].separation : Scalar(0);
      s.contacts.features[row][i] = real ? m.points[i].feature : 0xffffffffu;
      out[place::from_point + i] = Scalar(from[i]);
    }
    if (impact > 0) std::fill_n(out + place::normal_impulse, impulse_count, Scalar(0));
    for (int k = 0; k < 3; k++) out[place::apart + k] = apart[k];
    out[place::impact_time] = Scalar(impact);
    out[place::found_anew] = 1;
    const auto on_the_way = [&](int k) { return t * (double(ta.v[k]) + share * (double(tb.v[k]) - double(ta.v[k]))); };
    d.later_[c.later].origin = bodies.poses().position(row_a) + Vec3{on_the_way(0), on_the_way(1), on_the_way(2)};
  }
};

template <class Scalar> Detector::Meeting<Scalar> Detector::meeting(const Substep<Scalar>& look, std::uint32_t row) {
  return {*this, look.s, look.bodies, look.options, look.h, row};
}

}  // namespace pcphys
