// The narrow phase within a step: which contacts act in a sub-step, and with what geometry.
//
// A manifold is found again when its bodies have moved against each other by more than a share of their size since. Of
// shapes that are apart a bound of their gap is kept, less what their motion may have taken of it. Where that is more
// than the way of the sub-step they do not meet and their rows push nothing; else conservative advancement finds the
// instant at which they do, and the manifold there.
#include <algorithm>

#include "collision/contact_meeting.h"

namespace pcphys {

template <class Scalar>
void Detector::find(const Options& options, const Sight<Scalar>& view, const ShapeView<Scalar>& a,
                    const ShapeView<Scalar>& b, std::uint32_t pair, Manifold<Scalar>& manifold) {
  if (options.narrow == NarrowPhase::fcl)
    fcl_hook()(a, b, view.margin, manifold);
  else
    narrow(a, b, view.margin, hints_[pair], manifold);
}

float Detector::thickness(std::uint32_t a, std::uint32_t b) const {
  const float x = proxies_[a].inner, y = proxies_[b].inner;
  return x == 0 ? y : y == 0 ? x : std::min(x, y);
}

template void Detector::find(const Options&, const Sight<float>&, const ShapeView<float>&, const ShapeView<float>&,
                             std::uint32_t, Manifold<float>&);
template void Detector::find(const Options&, const Sight<double>&, const ShapeView<double>&, const ShapeView<double>&,
                             std::uint32_t, Manifold<double>&);

template <class Scalar> void Detector::find_way(const Substep<Scalar>& look, std::uint32_t body) {
  ways_[body] = look.bodies.way(body, levers_[body], look.h);
  ways_[body].of = meetings_;
}

/// All looks, on as many threads as there are: one writes what is of its own contact alone. Then notes whose rows are
/// to be made anew.
template <class Scalar> void Detector::find_all(const Substep<Scalar>& look, bool sent) {
  for (const Look& l : looks_)
    for (const std::uint32_t body : standings_[look.contacts[l.at]].rows) twist_of(look.bodies, body);
  look.options.share(looks_.size(), [&](std::uint32_t begin, std::uint32_t end) {
    for (const Look& l : std::span(looks_).subspan(begin, end - begin)) meeting(look, look.contacts[l.at]).find(sent);
  });
  const Scalar* const rows = look.s.tables.template data<Scalar>(Buffer::contact);
  for (const Look& l : looks_)
    if (rows[look.contacts[l.at] * contact_reals + place::found_anew] != 0) renewed_.push_back(l.at);
}

/// What the bounds of both bodies' motion settle needs no look at the two together.
template <class Scalar> void Detector::meet_in(const Substep<Scalar>& look) {
  const auto stands_on = [&](std::uint32_t at, bool anew) {
    const Standing& c = standings_[look.contacts[at]];
    if (!c.acts || !look.s.stands(c.rows[1])) return;
    on_standing_.push_back(at);
    if (anew) inner_.push_back(at);
  };
  looks_.clear();
  unseen_.clear();
  for (const std::uint32_t at : look.places) {
    const std::uint32_t row = look.contacts[at];
    Standing& c = standings_[row];
    const Way a = way_of(look, c.rows[0]), b = way_of(look, c.rows[1]);
    const float moved = a.went + b.went + c.looked, goes = a.goes + b.goes;
    const bool rests = c.touches && !c.struck && goes <= float(constants::stale_share) * c.thick &&
                       moved <= float(constants::contact_share) * c.thick;
    const bool far = !c.touches && !c.acts && c.gap > double(moved) + double(goes);
    if (rests || far) {
      if (may_strike(c)) unseen_.push_back(at);
      stands_on(at, look.first);
      continue;
    }
    if (!c.touches && !c.acts && meeting(look, row).passes_by(0)) {
      stands_on(at, look.first);
      continue;
    }
    make_record(c);
    looks_.push_back({at, c.acts});
  }
  find_all(look, false);
  for (const Look& l : looks_) {
    const std::uint32_t row = look.contacts[l.at];
    const Standing& c = standings_[row];
    if (c.struck) struck_.push_back(l.at);
    if (l.acted && !c.acts) gone_.push_back(row);
    stands_on(l.at, true);
  }
  drop_inner_edges(look);
  put_off(look);
  for (const Look& l : looks_)
    if (may_strike(standings_[look.contacts[l.at]])) unseen_.push_back(l.at);
  note_swept(look);
}

void Detector::meet(WorldState& s, const Listed& contacts, unsigned level, bool first, double h,
                    const Options& options) {
  struck_.clear();
  on_standing_.clear();
  inner_.clear();
  look_in(s, contacts, level, h, options, [&](auto look) {
    look.first = first;
    mark_struck(look);
    meet_in(look);
  });
}

/// Of limbs that are apart, which of those that contacts and joints have sent elsewhere since meet there.
template <class Scalar> void Detector::meet_sent_in(const Substep<Scalar>& look) {
  looks_.clear();
  inner_.clear();
  for (const std::uint32_t at : look.places) {
    Standing& c = standings_[look.contacts[at]];
    if (!c.jointed || c.acts || c.touches) continue;
    const Way a = way_of(look, c.rows[0]), b = way_of(look, c.rows[1]);
    if (c.gap > double(a.went + b.went + c.looked) + double(a.goes + b.goes)) continue;
    make_record(c);
    looks_.push_back({at, false});
  }
  find_all(look, true);
  for (const Look& l : looks_) {
    const Standing& c = standings_[look.contacts[l.at]];
    if (!c.acts || !look.s.stands(c.rows[1])) continue;
    on_standing_.push_back(l.at);
    inner_.push_back(l.at);
  }
  drop_inner_edges(look);
}

void Detector::meet_sent(WorldState& s, const Listed& contacts, unsigned level, double h, const Options& options) {
  look_in(s, contacts, level, h, options, [&](auto look) { meet_sent_in(look); });
}

void Detector::let_go(WorldState& s) {
  for (const std::uint32_t row : gone_)
    if (!standings_[row].acts) s.tables.set(Buffer::contact, row, 3, 0);
  gone_.clear();
}

template void Detector::find_way(const Substep<float>&, std::uint32_t);
template void Detector::find_way(const Substep<double>&, std::uint32_t);

}  // namespace pcphys
