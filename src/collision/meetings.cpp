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

constexpr std::size_t contact_reals = reals_of(Buffer::contact), motion_reals = reals_of(Buffer::motion);

/// What a sub-step reads of bodies.
template <class Scalar> class Bodies {
 public:
  explicit Bodies(const Tables& t)
      : poses_(t),
        motion_(t.data<Scalar>(Buffer::motion)),
        mass_(t.data<Scalar>(Buffer::mass)),
        delta_(t.data<Scalar>(Buffer::delta)) {}

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

double size_of(const std::array<double, 3>& a, const std::array<double, 3>& b) {
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

template void Detector::find(const Options&, const Sight<float>&, const ShapeView<float>&, const ShapeView<float>&, std::uint32_t, Manifold<float>&);
template void Detector::find(const Options&, const Sight<double>&, const ShapeView<double>&, const ShapeView<double>&, std::uint32_t, Manifold<double>&);

template <class Scalar>
void Detector::meet_all(WorldState& s, std::span<const std::uint32_t> contacts, bool first, double h, const Options& options) {
  const Bodies<Scalar> bodies(s.tables);
  const Scalar* shape_rows = s.tables.data<Scalar>(Buffer::shape);
  Scalar* records = s.tables.data<Scalar>(Buffer::contact);
  records[39] = first ? 2 : 0;  // slots that pad are made of it
  for (const std::uint32_t row : contacts) {
    if (row == 0) continue;
    Standing& c = standings_[row];
    Scalar* out = records + row * contact_reals;
    const auto [row_a, row_b] = s.contacts.ends[row];
    const Proxy &pa = proxies_[c.shapes[0]], &pb = proxies_[c.shapes[1]];
    const Moved now = bodies.moved(row_a, row_b);
    if (!first) out[39] = 0;
    // how far the two may have come since they were looked at
    const double lever_a = pa.lever_any + pa.lever_across, lever_b = pb.lever_any + pb.lever_across;
    const double moved = first ? 0 : size_of(now.apart, c.then.apart) + size_of(now.turned_a, c.then.turned_a) * lever_a + size_of(now.turned_b, c.then.turned_b) * lever_b;
    const double thick = double(thickness(c.shapes[0], c.shapes[1]));
    const TwistOf<Scalar> ta = bodies.twist(row_a), tb = bodies.twist(row_b);
    double closing = 0;
    for (int k = 0; k < 3; k++) closing += (double(tb.v[k]) - double(ta.v[k])) * (double(tb.v[k]) - double(ta.v[k]));
    const double spin_a = double(ta.across) * pa.lever_across + double(ta.turn) * pa.lever_any, spin_b = double(tb.across) * pb.lever_across + double(tb.turn) * pb.lever_any;
    const double way = (std::sqrt(closing) + spin_a + spin_b) * h;
    // how far what answers moves along the other, or turns into it: what is quick is struck, and not held
    const double share = share_of<Scalar>(s.tables, row_a, row_b);
    const double shifts = (std::sqrt(closing) * std::min(share, 1 - share) + spin_a + spin_b) * h;
    const bool quick = shifts > constants::quick_share * thick;
    if (c.touches && !quick && moved <= constants::manifold_share * thick) continue;
    const auto stand_aside = [&] {
      if (!c.acts) return;
      c.acts = false;
      out[3] = 0;
      out[31] = pa.jointed || pb.jointed ? -1 : 0;
      out[39] = 1;
      for (int k = 40; k < 44; k++) out[k] = 0;
      for (std::uint32_t& f : s.contacts.features[row]) f = 0xffffffffu;
    };
    if (!c.touches && c.gap - moved > way) {
      stand_aside();
      continue;
    }
    ShapeView<Scalar> a, b;
    place_shape(shape_rows + (c.shapes[0] + 1) * reals_of(Buffer::shape), pa.kind, pa.hull, pa.centred, bodies.poses().orientation(row_a), a);
    place_shape(shape_rows + (c.shapes[1] + 1) * reals_of(Buffer::shape), pb.kind, pb.hull, pb.centred, bodies.poses().orientation(row_b), b);
    Scalar apart[3] = {0, 0, 0};
    bodies.poses().shift(row_a, row_b, apart);
    ShapeView<Scalar> there = b;
    for (int k = 0; k < 3; k++) there.p[k] += apart[k];
    const double skin = margin(c.shapes[0], c.shapes[1]);
    const Scalar look = Scalar(skin + 2 * way);
    const auto look_at = [&](const ShapeView<Scalar>& x, const ShapeView<Scalar>& y, Manifold<Scalar>& m) {
      if (options.narrow == NarrowPhase::fcl) fcl_hook()(x, y, look, m);
      else narrow(x, y, look, c.hint, m);
    };
    Manifold<Scalar> m;
    look_at(a, there, m);
    c.then = now;
    if (m.count == 0) {
      c.touches = false;
      c.gap = double(look);
      stand_aside();
      continue;
    }
    const double gap = std::min(double(support_gap(a, there, m.normal)), double(least_separation(m)));
    const double far = std::sqrt(double(apart[0]) * double(apart[0]) + double(apart[1]) * double(apart[1]) + double(apart[2]) * double(apart[2]));
    const double near = near_of(thick, far, double(std::numeric_limits<Scalar>::epsilon()));
    double impact = pa.jointed || pb.jointed ? -1 : 0;
    c.touches = gap <= near;
    c.gap = gap;
    if (!c.touches) {
      if (gap > way) {
        stand_aside();
        continue;
      }
      const Mover<Scalar> mover_a{&a, ta, float(spin_a), pa.centred, float(lever_a)}, mover_b{&b, tb, float(spin_b), pb.centred, float(lever_b)};
      const double t = meet_within(mover_a, mover_b, apart, near, 1e-4 * thick, h, look_at, m);
      if (t < 0) {
        stand_aside();
        continue;
      }
      to_light_side(m, share);
      back_to_start(ta, tb, apart, share, t, m);
      if (impact == 0) impact = std::max(t, 1e-9 * h);
    } else {
      to_light_side(m, share);
      if (impact == 0 && quick) impact = 1e-9 * h;
    }
    const std::uint32_t count_before = c.acts ? std::uint32_t(out[3]) : 0;
    std::array<std::uint32_t, 4> from = points_before(m, s.contacts.features[row]);
    if (!c.acts || impact > 0) from = {};
    else match_nearest(m, out, count_before, from);
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
    for (int k = 0; k < 3; k++) out[36 + k] = apart[k];
    out[31] = Scalar(impact);
    out[39] = first ? Scalar(2) : Scalar(1);
  }
}

void Detector::meet(WorldState& s, std::span<const std::uint32_t> contacts, bool first, double h, const Options& options) {
  if (s.tables.precision() == Precision::f32)
    meet_all<float>(s, contacts, first, h, options);
  else
    meet_all<double>(s, contacts, first, h, options);
}

}  // namespace pcphys
