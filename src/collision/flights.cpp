#include "collision/flights.h"

#include <limits>
#include <type_traits>

#include "collision/detector.h"
#include "collision/hook.h"
#include "collision/meeting.h"

namespace pcphys {
namespace {

/// Beyond this turn within the step [rad] a body is taken to meet others with its centre behind the point: which of its
/// corners comes first is then chance, and the rows of a manifold know small turns only.
constexpr double many_corners = 0.5;

template <class Scalar> void behind_centre(Manifold<Scalar>& m) {
  ManifoldPoint<Scalar>& first = m.points[0];
  for (std::uint32_t i = 1; i < m.count; i++)
    if (m.points[i].separation < first.separation) first = m.points[i];
  m.count = 1;
  const Scalar along = m.normal[0] * first.p[0] + m.normal[1] * first.p[1] + m.normal[2] * first.p[2];
  for (int k = 0; k < 3; k++) first.p[k] = m.normal[k] * along;
}

/// Their normals turn as they come together; those of faces do not.
bool is_round(ShapeKind kind) { return kind == ShapeKind::sphere || kind == ShapeKind::capsule; }

/// The manifold of time t as seen from the start: gaps open again with the speeds of the points, arms go back by the
/// first body's share of the way.
template <class Scalar>
void back_to_start(const TwistOf<Scalar>& a, const TwistOf<Scalar>& b, const Scalar* apart, double share, double t,
                   Manifold<Scalar>& m) {
  Scalar path[3], d[3];
  for (int k = 0; k < 3; k++) path[k] = Scalar((double(b.v[k]) - double(a.v[k])) * t), d[k] = apart[k] + path[k];
  for (std::uint32_t i = 0; i < m.count; i++) {
    ManifoldPoint<Scalar>& point = m.points[i];
    point.separation += Scalar(double(passing(a, b, m.normal, point.p, d).closing) * t);
    for (int k = 0; k < 3; k++) point.p[k] -= Scalar(double(path[k]) * share);
  }
}

/// As seen from the start, for whatever way it comes.
template <class Scalar> void from_start(double dt, double share, bool whirls, Flight<Scalar>& f) {
  to_light_side(f.manifold, share);
  f.impact = dt;
  if (whirls) behind_centre(f.manifold);
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

template <class Scalar>
void Detector::begin_strikes(const WorldState& s, double dt, const Options& options, Scratch<Scalar>& scratch) {
  struck_.assign(s.bodies.size(), float(dt));
  if (strays_)  // what strays goes another way from the start, for all that is known
    for (std::uint32_t row = 0; row < s.bodies.size(); row++)
      if (went_[row] > 0) struck_[row] = 0;
  if constexpr (!std::is_same_v<Scalar, float>) {
    const auto data = [&](Buffer buffer) { return s.tables.data<Scalar>(buffer); };
    scratch.twists.resize(0);
    scratch.twists.resize(s.bodies.size() * sizeof(TwistOf<Scalar>));
    auto* twists = reinterpret_cast<TwistOf<Scalar>*>(scratch.twists.data());
    narrow_lanes<Scalar>(options.lanes)
        .twists({data(Buffer::motion), data(Buffer::mass), data(Buffer::pose), moving_.data(), movers_, twists->v});
    for (std::size_t row = 0; row < s.bodies.size(); row++) twists[row].limit_turn(dt);
  }
}

// Bodies on joints are left out: their impulses are not theirs alone.
template <class Scalar>
void Detector::look_ahead(const WorldState& s, double dt, const Options& options, Scratch<Scalar>& scratch) {
  scratch.flights.clear();
  const Scalar* materials = s.tables.data<Scalar>(Buffer::material);
  const Scalar* phases = s.tables.data<Scalar>(Buffer::motion) + 7;
  const auto untouched = [phases](std::uint32_t row) { return phases[row * reals_of(Buffer::motion)] <= 0; };
  const auto pairs = pairs_.pairs();
  // what comes no further in the step than `slow` approaches too slowly to bounce
  bool begun = false;
  const float slow = float(options.least_bounce * dt), certain = std::min(slow, 0.5f * thinnest_);
  for (const std::uint32_t i : near_) {
    const auto [a, b] = pairs[i];
    const float way = reach_[a] + reach_[b];
    if (way <= certain) continue;
    const Proxy &x = proxies_[a], &y = proxies_[b];
    if (x.jointed || y.jointed) continue;
    constexpr std::size_t stride = reals_of(Buffer::material);
    const float thick = thickness(a, b);
    if (way <= 0.001f * thick || (way <= slow && way <= 0.5f * thick)) continue;
    const bool flies = way > 0.5f * thick || materials[x.body * stride + 2] + materials[y.body * stride + 2] > 0;
    if (!flies && !(is_round(x.kind) && is_round(y.kind) && untouched(x.body) && untouched(y.body))) continue;
    if (!begun) begin_strikes(s, dt, options, scratch);
    begun = true;
    Flight<Scalar>& f = scratch.flights.emplace_back();
    f.pair = i;
    const Sight<Scalar> view = sight(s, scratch, i);
    fly(s, dt, options, scratch, view, f);
    if (!flies && f.impact <= 0) {  // as if it had not been looked at
      scratch.flights.pop_back();
      continue;
    }
    if (f.counts && f.impact > 0)
      for (std::uint32_t row : view.rows) struck_[row] = std::min(struck_[row], float(f.impact));
  }
}

template <class Scalar>
void Detector::fly(const WorldState& s, double dt, const Options& options, const Scratch<Scalar>& scratch,
                   const Sight<Scalar>& view, Flight<Scalar>& f) {
  const auto mover = [&](int side) {
    const Proxy& p = proxies_[view.shapes[side]];
    const Twist& t = twists_[view.rows[side]];
    const float spin = t.across * p.lever_across + t.turn * p.lever_any;
    const auto* twists = reinterpret_cast<const TwistOf<Scalar>*>(
        std::is_same_v<Scalar, float> ? static_cast<const void*>(twists_.data()) : scratch.twists.data());
    return Mover<Scalar>{&scratch.shapes[view.shapes[side]], twists[view.rows[side]], spin, p.centred};
  };
  const Mover<Scalar> a = mover(0), b = mover(1);
  f.counts = f.stray = f.turned = false;
  f.impact = 0;
  find(options, view, *a.view, view.there, f.pair, f.manifold);
  if (f.manifold.count == 0) return;
  const double gap = double(least_separation(f.manifold)), share = share_of<Scalar>(s.tables, view.rows[0], view.rows[1]);
  const double far = length({double(view.apart[0]), double(view.apart[1]), double(view.apart[2])});
  const double near = std::max(1e-6 * double(thickness(view.shapes[0], view.shapes[1])),
                               16 * double(std::numeric_limits<Scalar>::epsilon()) * far);
  const double margin = this->margin(view.shapes[0], view.shapes[1]);
  f.counts = gap <= margin;
  if (gap <= near) return to_light_side(f.manifold, share);
  Manifold<Scalar> met = f.manifold;
  const double fall = length(s.gravity) * dt * dt;
  const double t = meet(
      a, b, view.apart, near, fall + 0.5 * margin, dt,
      [&](const ShapeView<Scalar>& x, const ShapeView<Scalar>& y, Manifold<Scalar>& m) { find(options, view, x, y, f.pair, m); },
      met);
  const bool whirls = double(a.spin) > 0 && double(a.twist.turn) * dt > many_corners;
  if (t >= 0) {
    f.counts = true;
    f.impact = t;
    const Scalar *n = f.manifold.normal, *m = met.normal;
    f.turned = !(share > 0 && share < 1) && n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < Scalar(0.5);
    f.manifold = met;
    if (whirls) behind_centre(f.manifold);
    to_light_side(f.manifold, share);
    back_to_start(a.twist, b.twist, view.apart, share, t, f.manifold);
    return;
  }
  if (f.counts) return to_light_side(f.manifold, share);
  // what stands may be met all the same, once something sends the other there
  if (share > 0 && share < 1) return;
  (t == past ? f.stray : f.counts) = true;
  from_start(dt, share, whirls, f);
}

template <class Scalar>
bool Detector::settle(const WorldState& s, double dt, const Options& options, const Scratch<Scalar>& scratch,
                      const Sight<Scalar>& view, Flight<Scalar>& f) {
  const float first = std::min(struck_[view.rows[0]], struck_[view.rows[1]]);
  if (f.turned && double(first) < f.impact) {  // it will be sent elsewhere before
    find(options, view, scratch.shapes[view.shapes[0]], view.there, f.pair, f.manifold);
    from_start(dt, share_of<Scalar>(s.tables, view.rows[0], view.rows[1]), false, f);
  }
  return f.counts || (f.stray && first < float(dt));
}

#define PC_INSTANTIATE(Scalar)                                                                                            \
  template void Detector::find(const Options&, const Sight<Scalar>&, const ShapeView<Scalar>&, const ShapeView<Scalar>&,  \
                               std::uint32_t, Manifold<Scalar>&);                                                         \
  template bool Detector::settle(const WorldState&, double, const Options&, const Scratch<Scalar>&, const Sight<Scalar>&, \
                                 Flight<Scalar>&);                                                                        \
  template void Detector::look_ahead(const WorldState&, double, const Options&, Scratch<Scalar>&);
PC_INSTANTIATE(float)
PC_INSTANTIATE(double)

}  // namespace pcphys
