// The order of impacts within a sub-step: by time, and once more after each sweep for what it has struck.
#include <algorithm>
#include <limits>

#include "collision/contact_meeting.h"

namespace pcphys {
namespace {

/// Impacts within this share of a sub-step are at one time.
constexpr double at_once = 1e-3;

}  // namespace

/// Impacts come in the order of time: what meets later than something else meets one of the two waits, since that one
/// then goes elsewhere. Of those in `struck_` from `begin` on.
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
    meeting(look, look.contacts[struck_[i]]).stand_aside();
    gone_.push_back(look.contacts[struck_[i]]);
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
  inner_.clear();
  for (const std::uint32_t at : may_strike_) {
    const std::uint32_t row = look.contacts[at];
    Standing& c = standings_[row];
    if (c.acts || c.touches) continue;
    if (!is_marked(c.rows[0]) && !is_marked(c.rows[1]) && !c.waits) continue;  // as it was when it was looked at last
    const double from = std::max(struck_at(c.rows[0]), struck_at(c.rows[1]));
    c.waits = false;
    const Way a = way_of(look, c.rows[0]), b = way_of(look, c.rows[1]);
    if (c.gap > double(a.went + b.went + c.looked) + double(a.goes + b.goes)) continue;
    make_record(c);
    if (!meeting(look, row).find_from(from)) continue;
    renewed_.push_back(at);
    struck_.push_back(at);
    if (!look.s.stands(c.rows[1])) continue;
    on_standing_.push_back(at);
    inner_.push_back(at);
  }
  if (struck_.size() == before) return void(waiting_ = 0);
  drop_inner_edges(look);
  put_off(look, before);
  for (std::size_t i = before; i < struck_.size(); i++)  // no sweep has seen them
    for (const std::uint32_t body : standings_[look.contacts[struck_[i]]].rows) delta[body * reals_of(Buffer::delta) + 9] = 1;
}

/// Contacts that may have an impact: those that meet, and touching ones that bounce; after the `first` sweep those of
/// marked bodies.
template <class Scalar> void Detector::find_unseen(const Substep<Scalar>& look, bool first) {
  const Scalar* const delta = look.s.tables.template data<Scalar>(Buffer::delta);
  const auto is_marked = [&](std::uint32_t body) { return delta[body * reals_of(Buffer::delta) + 9] > 0; };
  const auto standing = [&](std::uint32_t at) -> const Standing& { return standings_[look.contacts[at]]; };
  if (first) {  // a contact that rests, and does not bounce, does so until the next sub-step
    may_strike_.clear();
    for (const std::uint32_t at : look.places) {
      const Standing& c = standing(at);
      if (!c.jointed && (!c.touches || c.struck || c.bounces)) may_strike_.push_back(at);
    }
  }
  unseen_.clear();
  for (const std::uint32_t at : may_strike_) {
    const Standing& c = standing(at);
    if (!c.acts || !(c.struck || c.bounces)) continue;
    if (first || is_marked(c.rows[0]) || is_marked(c.rows[1])) unseen_.push_back(at);
  }
}

void Detector::meet_again(WorldState& s, const Listed& contacts, unsigned level, bool last, double h, const Options& options) {
  look_in(s, contacts, level, h, options, [&](auto look) {
    look.last = last;
    mark_struck(look);
    meet_struck(look);
    find_unseen(look, false);
  });
}

template void Detector::put_off(const Substep<float>&, std::size_t);
template void Detector::mark_struck(const Substep<float>&);
template void Detector::find_unseen(const Substep<float>&, bool);
template void Detector::put_off(const Substep<double>&, std::size_t);
template void Detector::mark_struck(const Substep<double>&);
template void Detector::find_unseen(const Substep<double>&, bool);

}  // namespace pcphys
