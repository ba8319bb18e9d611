// The narrow phase within a step: which contacts act in a sub-step, and with what geometry.
//
// A manifold is found again when its bodies have moved against each other by more than a share of their size since. Of shapes that are
// apart a bound of their gap is kept, less what their motion may have taken of it. Where that is more than the way of the sub-step they do
// not meet and their rows push nothing; else conservative advancement finds the instant at which they do, and the manifold there.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "collision/detector.h"
#include "collision/flights.h"
#include "collision/hook.h"
#include "collision/meeting.h"
#include "collision/support_gap.h"
#include "collision/view.h"

namespace pcphys {
namespace {

/// Normals that are turned against each other by less than this are one [rad].
constexpr double same_normal = 3e-4;

/// Impacts within this share of a sub-step are at one time.
constexpr double at_once = 1e-3;

constexpr std::size_t contact_reals = reals_of(Buffer::contact), motion_reals = reals_of(Buffer::motion);

/// What a sub-step reads of bodies.
template <class Scalar> class Bodies {
 public:
  explicit Bodies(const Tables& t)
      : poses_(t),
        motion_(t.data<Scalar>(Buffer::motion)),
        mass_(t.data<Scalar>(Buffer::mass)),
        delta_(t.data<Scalar>(Buffer::delta)) {}

  const Scalar* motion(std::uint32_t row) const { return motion_ + row * motion_reals; }
  /// `lever`: how far a turn of one radian moves any point of its shapes, at most.
  Way way(std::uint32_t row, float lever, double h) const {
    const Scalar *d = delta_ + row * reals_of(Buffer::delta), *m = motion(row),
                 *inverse = mass_ + row * reals_of(Buffer::mass) + 4;
    const auto size = [](const Scalar* v) {
      return std::sqrt(float(v[0]) * float(v[0]) + float(v[1]) * float(v[1]) + float(v[2]) * float(v[2]));
    };
    const float most = float(std::max({inverse[0], inverse[1], inverse[2]}));
    constexpr float up = 1.00001f;  // beyond the rounding of all this
    return {up * (size(d) + size(d + 4) * lever), up * (size(m) + size(m + 4) * most * lever) * float(h), 0};
  }

  const BodyReader<Scalar>& poses() const { return poses_; }
  Moved moved(std::uint32_t a, std::uint32_t b) const {
    const Scalar *x = delta_ + a * reals_of(Buffer::delta), *y = delta_ + b * reals_of(Buffer::delta);
    Moved m;
    for (int k = 0; k < 3; k++) {
      m.apart[std::size_t(k)] = double(y[k]) - double(x[k]);
      m.turned_a[std::size_t(k)] = double(x[4 + k]);
      m.turned_b[std::size_t(k)] = double(y[4 + k]);
    }
    return m;
  }
  TwistOf<Scalar> twist(std::uint32_t row) const {
    const Scalar *motion = motion_ + row * motion_reals, *inverse = mass_ + row * reals_of(Buffer::mass) + 4;
    const Scalar* q = poses_.orientation(row);
    TwistOf<Scalar> t;
    const Scalar back[4] = {-q[0], -q[1], -q[2], q[3]};
    Scalar l[3];
    rotate_by(back, motion + 4, l);
    for (int k = 0; k < 3; k++) l[k] *= inverse[k];
    rotate_by(q, l, t.w);
    Scalar speed = 0, turn = 0;
    for (int k = 0; k < 3; k++) t.v[k] = motion[k], speed += motion[k] * motion[k], turn += l[k] * l[k];
    t.speed = std::sqrt(speed);
    t.turn = std::sqrt(turn);
    t.across = std::sqrt(l[0] * l[0] + l[2] * l[2]);
    return t;
  }

 private:
  BodyReader<Scalar> poses_;
  const Scalar *motion_, *mass_, *delta_;
};

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
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
void match_nearest(const Manifold<Scalar>& m, const Scalar* before, std::uint32_t count, std::array<std::uint32_t, 4>& from) {
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

}  // namespace

template <class Scalar>
void Detector::find(const Options& options, const Sight<Scalar>& view, const ShapeView<Scalar>& a, const ShapeView<Scalar>& b,
                    std::uint32_t pair, Manifold<Scalar>& manifold) {
  if (options.narrow == NarrowPhase::fcl)
    fcl_hook()(a, b, view.margin, manifold);
  else
    narrow(a, b, view.margin, hints_[pair], manifold), hinted_ |= hints_[pair] != 0;
}

float Detector::thickness(std::uint32_t a, std::uint32_t b) const {
  const float x = proxies_[a].inner, y = proxies_[b].inner;
  return x == 0 ? y : y == 0 ? x : std::min(x, y);
}

template void Detector::find(const Options&, const Sight<float>&, const ShapeView<float>&, const ShapeView<float>&, std::uint32_t,
                             Manifold<float>&);
template void Detector::find(const Options&, const Sight<double>&, const ShapeView<double>&, const ShapeView<double>&,
                             std::uint32_t, Manifold<double>&);

/// What a sub-step's contacts are looked at with.
template <class Scalar> struct Detector::Substep {
  WorldState& s;
  const Bodies<Scalar>& bodies;
  std::span<const std::uint32_t> contacts;
  const Options& options;
  double h;
  bool first, last;  // the first sub-step of the step; the last look of the sub-step
};

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
  TwistOf<Scalar> ta = bodies.twist(row_a), tb = bodies.twist(row_b);
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
    const Moved then = c.looked > 0 ? d.looked_[row] : Moved{};
    return distance(now.apart, then.apart) + distance(now.turned_a, then.turned_a) * lever(pa) +
           distance(now.turned_b, then.turned_b) * lever(pb);
  }
  /// And how far they may come in the sub-step by their own velocities [m].
  double way() const { return (speed() + spin(ta, pa) + spin(tb, pb)) * h; }
  /// What moves fast along what answers too, or turns into it, is struck and not held: nothing of the contact lasts.
  bool quick() const {
    const double turns = (pa.responds ? spin(ta, pa) : 0) + (pb.responds ? spin(tb, pb) : 0);
    const double shifts = (speed() * std::min(share, 1 - share) + turns) * h;
    return shifts > constants::quick_share * thick;
  }

  void stand_aside() {
    if (!c.acts) return;
    c.acts = c.struck = false;
    out[31] = c.jointed ? -1 : 0;
    out[39] = 2;
    std::fill(out + 40, out + 44, Scalar(0));
    s.contacts.features[row].fill(0xffffffffu);
    d.gone_.push_back(row);
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

  /// Shapes may be as near by their supports as they are at no point of the manifold: then the nearest points are those that act.
  void find_together(const Manifold<Scalar>& m) {
    const double most = std::max(0.0, double(least_separation(m))) + seam_share * thick;
    c.together = 0;
    for (std::uint32_t i = 0; i < m.count; i++)
      if (double(m.points[i].separation) <= most) c.together |= std::uint8_t(1u << i);
  }

  /// `sent`: how far others of a joint tree may send them against each other.
  void find(double sent) {
    const double way = this->way(), goes = std::max(way, sent), moved = this->moved();
    const bool quick = this->quick();
    if (c.touches && !c.struck && !quick && moved <= constants::manifold_share * thick) return;
    if (!c.touches && c.gap - moved > goes) return stand_aside();
    const ShapeView<Scalar> a = view(pa, c.shapes[0], row_a), b = view(pb, c.shapes[1], row_b);
    bodies.poses().shift(row_a, row_b, apart);
    ShapeView<Scalar> there = b;
    for (int k = 0; k < 3; k++) there.p[k] += apart[k];
    look = Scalar(d.margin(c.shapes[0], c.shapes[1]) + 2 * goes);
    Manifold<Scalar> m;
    look_at(a, there, m);
    d.looked_[row] = now;
    c.looked = d.went(row_a) + d.went(row_b);
    c.touches = false;
    c.gap = double(look);
    if (m.count == 0) return stand_aside();
    c.gap = std::min(double(support_gap(a, there, m.normal)), double(least_separation(m)));
    const double far = std::sqrt(double(apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]));
    const double near = near_of(thick, far, double(std::numeric_limits<Scalar>::epsilon()));
    c.touches = c.gap <= (c.acts && !quick ? seam_share * thick : near);
    double t = 0;
    bool meets = c.touches;
    if (!c.touches) {
      if (c.gap > goes) return stand_aside();
      const auto look_there = [&](const ShapeView<Scalar>& x, const ShapeView<Scalar>& y, Manifold<Scalar>& z) {
        look_at(x, y, z);
      };
      Manifold<Scalar> met = m;
      t = meet_within(mover(pa, a, ta), mover(pb, b, tb), apart, near, 0.0, h, look_there, met);
      meets = t >= 0;
      if (!meets && c.gap > sent) return stand_aside();
      if (meets) m = met;  // else the rows stop what others send them beyond the gap of now
    }
    find_together(m);
    to_light_side(m, share);
    if (!c.touches && meets) back_to_start(ta, tb, apart, share, t, m);
    c.struck = !c.jointed && (!c.touches || quick);
    write(m, std::max(t, 0.0), c.jointed ? -1 : c.struck ? std::max(t, 1e-9 * h) : 0);
  }

  /// Of shapes that were apart, whose bodies were struck elsewhere at `from` [s]: whether they meet after that.
  bool find_from(double from) {
    const ShapeView<Scalar> a = view(pa, c.shapes[0], row_a), b = view(pb, c.shapes[1], row_b);
    bodies.poses().shift(row_a, row_b, apart);
    look = Scalar(d.margin(c.shapes[0], c.shapes[1]) + 2 * way());
    const double far = std::sqrt(double(apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]));
    const double near = near_of(thick, far, double(std::numeric_limits<Scalar>::epsilon()));
    const auto look_there = [&](const ShapeView<Scalar>& x, const ShapeView<Scalar>& y, Manifold<Scalar>& z) {
      look_at(x, y, z);
    };
    Manifold<Scalar> m;
    const double t = meet_within(mover(pa, a, ta), mover(pb, b, tb), apart, near, std::max(from, 1e-9 * h), h, look_there, m);
    if (t < 0) return false;
    find_together(m);
    to_light_side(m, share);
    back_to_start(ta, tb, apart, share, t, m);
    c.struck = true;
    write(m, t, std::max(t, 1e-9 * h));
    return true;
  }
  static Mover<Scalar> mover(const Proxy& p, const ShapeView<Scalar>& shape, const TwistOf<Scalar>& t) {
    return {&shape, t, float(spin(t, p)), p.centred, float(lever(p)), p.inner / 2};
  }

  /// Impacts remember nothing. `t`: when the shapes meet [s].
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
      out[40 + i] = Scalar(from[i]);
    }
    if (impact > 0) {
      std::fill(out + 20, out + 28, Scalar(0));
      std::fill(out + 32, out + 36, Scalar(0));
    }
    for (int k = 0; k < 3; k++) out[36 + k] = apart[k];
    out[31] = Scalar(impact);
    out[39] = 1;
    const auto on_the_way = [&](int k) { return t * (double(ta.v[k]) + share * (double(tb.v[k]) - double(ta.v[k]))); };
    d.origins_[row] = bodies.poses().position(row_a) + Vec3{on_the_way(0), on_the_way(1), on_the_way(2)};
  }
};

/// Whether a point that x has lies in what y is with, where the body touches that with another normal.
template <class Scalar> bool Detector::lies_in(const Meeting<Scalar>& x, std::uint32_t point, const Meeting<Scalar>& y) const {
  if (y.row == x.row || !y.c.acts) return false;
  Scalar turned = 0;
  for (int k = 0; k < 3; k++) turned += (x.out[k] - y.out[k]) * (x.out[k] - y.out[k]);
  if (turned < Scalar(same_normal * same_normal)) return false;
  const double t = std::max(0.0, double(x.out[31]));
  ShapeView<Scalar> place = y.view(y.pb, y.c.shapes[1], y.row_b);
  Scalar apart[3] = {0, 0, 0};
  x.bodies.poses().shift(y.row_a, y.row_b, apart);
  ShapeView<Scalar> dot{ShapeKind::sphere, {Scalar(1e-6 * x.thick), 0, 0}, {}, {0, 0, 0, 1}};
  for (std::uint32_t k = 0; k < 3; k++) {
    place.p[k] += apart[k];
    dot.p[k] = x.out[4 + 4 * point + k] + Scalar(double(x.ta.v[k]) * t);
  }
  Manifold<Scalar> m;
  std::uint32_t hint = 0;
  narrow(dot, place, Scalar(seam_share * x.thick), hint, m);
  return m.count > 0;
}

/// Of the points at which a contact is closed, how far apart the shapes are where they overlap most.
template <class Scalar> Scalar Detector::depth(const Meeting<Scalar>& x) {
  Scalar least = std::numeric_limits<Scalar>::max();
  for (std::uint32_t point = 0; point < 4; point++)
    if (x.c.together >> point & 1) least = std::min(least, x.out[7 + 4 * point]);
  return least;
}

/// Whether y may take x's place there. Over a seam each of two lies in the other: the one that holds more stays.
template <class Scalar> bool Detector::covers(const Meeting<Scalar>& y, const Meeting<Scalar>& x, std::uint32_t point) const {
  if (!lies_in<Scalar>(x, point, y)) return false;
  const Scalar of_x = depth(x), of_y = depth(y);
  if (of_y < of_x || (of_y == of_x && y.row < x.row)) return true;
  for (std::uint32_t other = 0; other < 4; other++)
    if ((y.c.together >> other & 1) != 0 && !lies_in<Scalar>(y, other, x)) return true;
  return false;
}

/// Inner edges: where all points at which a contact with what stands is closed lie in other things that stand, which the body touches with
/// other normals, the surface goes on, and there is nothing to hit. `among`: places of which some may go.
template <class Scalar> void Detector::drop_inner_edges(const Substep<Scalar>& look, std::span<const std::uint32_t> among) {
  const auto row_of = [&](std::uint32_t at) { return look.contacts[at]; };
  const auto body_of = [&](std::uint32_t at) { return standings_[row_of(at)].rows[0]; };
  const auto meeting = [&](std::uint32_t at) {
    return Meeting<Scalar>{*this, look.s, look.bodies, look.options, look.h, row_of(at)};
  };
  std::ranges::sort(on_standing_, {}, [&](std::uint32_t at) { return std::pair(body_of(at), row_of(at)); });
  inner_.clear();
  for (std::size_t begin = 0, end = 0; begin < on_standing_.size(); begin = end) {
    for (end = begin; end < on_standing_.size() && body_of(on_standing_[end]) == body_of(on_standing_[begin]);) end++;
    for (std::size_t i = begin; i < end && end - begin > 1; i++) {
      if (among.size() < on_standing_.size() && std::ranges::find(among, on_standing_[i]) == among.end()) continue;
      const Meeting<Scalar> x = meeting(on_standing_[i]);
      bool covered = x.c.together != 0;
      for (std::uint32_t point = 0; point < 4 && covered; point++) {
        if ((x.c.together >> point & 1) == 0) continue;
        covered = false;
        for (std::size_t j = begin; j < end && !covered; j++) covered = covers<Scalar>(meeting(on_standing_[j]), x, point);
      }
      if (covered) inner_.push_back(on_standing_[i]);
    }
  }
  for (const std::uint32_t at : inner_) {
    meeting(at).stand_aside();
    standings_[row_of(at)].touches = false;  // it is looked at again while it is near
    renewed_.push_back(at);
  }
}

template <class Scalar> Way Detector::way_of(const Substep<Scalar>& look, std::uint32_t body) {
  Way& way = ways_[body];
  if (way.of == meetings_) return way;
  way = look.bodies.way(body, levers_[body], look.h);
  way.of = meetings_;
  return way;
}

/// By tree, how far the fastest of its bodies may go in the sub-step: joints may send any other as far.
template <class Scalar> void Detector::find_sent(const Substep<Scalar>& look) {
  std::ranges::fill(sent_, 0.0f);
  sent_.resize(trees_.size());
  for (std::uint32_t row = 1; row < trees_.size(); row++)
    if (trees_[row] != 0) sent_[trees_[row]] = std::max(sent_[trees_[row]], way_of(look, row).goes);
}

template <class Scalar> void Detector::meet_in(const Substep<Scalar>& look) {
  find_sent(look);
  const auto sent = [&](std::uint32_t row) { return trees_.empty() || trees_[row] == 0 ? 0.0f : sent_[trees_[row]]; };
  for (std::uint32_t at = 0; at < look.contacts.size(); at++) {
    const std::uint32_t row = look.contacts[at];
    if (row == 0) continue;
    Standing& c = standings_[row];
    const Way a = way_of(look, c.rows[0]), b = way_of(look, c.rows[1]);
    const float moved = a.went + b.went + c.looked, from_others = c.jointed ? sent(c.rows[0]) + sent(c.rows[1]) : 0.0f;
    const float goes = std::max(a.goes + b.goes, from_others);
    // what the bounds of both bodies' motion settle needs no look at the two together
    const bool rests = c.touches && !c.struck && goes <= float(constants::quick_share) * c.thick &&
                       moved <= float(constants::manifold_share) * c.thick;
    const bool far = !c.touches && !c.acts && c.gap > double(moved) + double(goes);
    if (rests || far) {
      if (look.first && c.acts && look.s.stands(c.rows[1])) on_standing_.push_back(at);
      continue;
    }
    Meeting<Scalar> m{*this, look.s, look.bodies, look.options, look.h, row};
    m.find(double(from_others));
    if (m.out[39] != 0) renewed_.push_back(at);
    if (c.struck) struck_.push_back(at);
    if (c.acts && look.s.stands(c.rows[1])) on_standing_.push_back(at);
  }
  drop_inner_edges(look, on_standing_);
  put_off(look, 0);
}

/// Impacts come in the order of time: what meets later than something else meets one of the two waits, since that one then goes elsewhere.
/// Of those in `struck_` from `begin` on.
template <class Scalar> void Detector::put_off(const Substep<Scalar>& look, std::size_t begin) {
  const auto standing = [&](std::uint32_t at) -> Standing& { return standings_[look.contacts[at]]; };
  const auto soonest = [&](const Standing& c, int side) -> double* {
    return proxies_[c.shapes[side]].responds ? &soonest_[c.rows[side]] : nullptr;
  };
  const auto when = [&](std::uint32_t at) { return double(look.s.tables.get(Buffer::contact, look.contacts[at], 31)); };
  const double h = look.h;
  waiting_ = 0;
  std::erase_if(struck_, [&](std::uint32_t at) { return !standing(at).struck; });  // an inner edge, for one
  if (struck_.size() <= begin || look.last) return;
  soonest_.resize(levers_.size(), std::numeric_limits<double>::infinity());
  const auto each = [&](const auto& does) {
    for (std::size_t i = begin; i < struck_.size(); i++)
      for (int side = 0; side < 2; side++)
        if (double* at = soonest(standing(struck_[i]), side)) does(*at, struck_[i]);
  };
  each([&](double& at, std::uint32_t place) { at = std::min(at, when(place)); });
  each([&](double& at, std::uint32_t place) { standing(place).waits |= when(place) > at + at_once * h; });
  each([&](double& at, std::uint32_t) { at = std::numeric_limits<double>::infinity(); });
  for (std::size_t i = begin; i < struck_.size(); i++) {
    if (!standing(struck_[i]).waits) continue;
    Meeting<Scalar>{*this, look.s, look.bodies, look.options, h, look.contacts[struck_[i]]}.stand_aside();
    waiting_++;
  }
  std::erase_if(struck_, [&](std::uint32_t at) { return !standing(at).struck; });
}

/// Marks the bodies that impacts have struck since it was called last: looks and sweeps go by that.
template <class Scalar> void Detector::mark_struck(const Substep<Scalar>& look) {
  Scalar* const delta = look.s.tables.template data<Scalar>(Buffer::delta);
  constexpr std::size_t reals = reals_of(Buffer::delta);
  times_struck_.resize(levers_.size());
  for (std::size_t body = 0; body < times_struck_.size(); body++) {
    const float times = float(delta[body * reals + 7]);
    delta[body * reals + 9] = times != times_struck_[body];
    times_struck_[body] = times;
  }
}

/// Contacts that do not act, of bodies that were struck since: as their velocities are now, from that instant on.
template <class Scalar> void Detector::meet_struck(const Substep<Scalar>& look) {
  Scalar* const delta = look.s.tables.template data<Scalar>(Buffer::delta);
  const auto struck_at = [&](std::uint32_t body) { return double(delta[body * reals_of(Buffer::delta) + 8]); };
  const auto is_marked = [&](std::uint32_t body) { return delta[body * reals_of(Buffer::delta) + 9] > 0; };
  const std::size_t before = struck_.size();
  for (std::uint32_t at = 0; at < look.contacts.size(); at++) {
    const std::uint32_t row = look.contacts[at];
    Standing& c = standings_[row];
    if (row == 0 || c.acts || c.touches || c.jointed) continue;
    if (!is_marked(c.rows[0]) && !is_marked(c.rows[1]) && !c.waits) continue;  // as it was when it was looked at last
    const double from = std::max(struck_at(c.rows[0]), struck_at(c.rows[1]));
    c.waits = false;
    const Way a = way_of(look, c.rows[0]), b = way_of(look, c.rows[1]);
    if (c.gap > double(a.went + b.went + c.looked) + double(a.goes + b.goes)) continue;
    Meeting<Scalar> m{*this, look.s, look.bodies, look.options, look.h, row};
    if (!m.find_from(from)) continue;
    renewed_.push_back(at);
    struck_.push_back(at);
    if (look.s.stands(c.rows[1])) on_standing_.push_back(at);
  }
  if (struck_.size() == before) return void(waiting_ = 0);
  drop_inner_edges(look, std::span(struck_).subspan(before));
  put_off(look, before);
  for (std::size_t i = before; i < struck_.size(); i++)  // no sweep has seen them
    for (const std::uint32_t body : standings_[look.contacts[struck_[i]]].rows) delta[body * reals_of(Buffer::delta) + 9] = 1;
}

/// Contacts that may have an impact: those that meet, and touching ones that bounce; after the `first` sweep those of marked bodies.
template <class Scalar> void Detector::find_unseen(const Substep<Scalar>& look, bool first) {
  const Scalar* const delta = look.s.tables.template data<Scalar>(Buffer::delta);
  const auto is_marked = [&](std::uint32_t body) { return delta[body * reals_of(Buffer::delta) + 9] > 0; };
  unseen_.clear();
  for (std::uint32_t at = 0; at < look.contacts.size(); at++) {
    const std::uint32_t row = look.contacts[at];
    const Standing& c = standings_[row];
    if (row == 0 || !c.acts || c.jointed || !(c.struck || c.bounces)) continue;
    if (first || is_marked(c.rows[0]) || is_marked(c.rows[1])) unseen_.push_back(at);
  }
}

void Detector::meet(WorldState& s, std::span<const std::uint32_t> contacts, unsigned level, bool first, double h,
                    const Options& options) {
  meetings_++;
  renewed_.clear();
  struck_.clear();
  on_standing_.clear();
  if (anew_.size() <= level) anew_.resize(level + 1);
  const auto in = [&]<class Scalar>(Scalar) {
    Scalar* const rows = s.tables.data<Scalar>(Buffer::contact);
    for (const std::uint32_t row : anew_[level]) rows[row * contact_reals + 39] = 0;
    const Bodies<Scalar> bodies(s.tables);
    const Substep<Scalar> look{s, bodies, contacts, options, h, first, false};
    meet_in(look);
    mark_struck(look);
    find_unseen(look, true);
  };
  s.tables.precision() == Precision::f32 ? in(float{}) : in(double{});
  anew_[level].clear();
  for (const std::uint32_t at : renewed_) anew_[level].push_back(contacts[at]);
}

void Detector::meet_again(WorldState& s, std::span<const std::uint32_t> contacts, unsigned level, bool last, double h,
                          const Options& options) {
  meetings_++;
  renewed_.clear();
  const auto in = [&]<class Scalar>(Scalar) {
    Scalar* const rows = s.tables.data<Scalar>(Buffer::contact);
    for (const std::uint32_t row : anew_[level]) rows[row * contact_reals + 39] = 0;
    const Bodies<Scalar> bodies(s.tables);
    const Substep<Scalar> look{s, bodies, contacts, options, h, false, last};
    mark_struck(look);
    meet_struck(look);
    find_unseen(look, false);
  };
  s.tables.precision() == Precision::f32 ? in(float{}) : in(double{});
  anew_[level].clear();
  for (const std::uint32_t at : renewed_) anew_[level].push_back(contacts[at]);
}

void Detector::let_go(WorldState& s) {
  for (const std::uint32_t row : gone_)
    if (!standings_[row].acts) s.tables.set(Buffer::contact, row, 3, 0);
  gone_.clear();
}

}  // namespace pcphys
