// The order of impacts within a sub-step: by time, and once more after each sweep for what it has struck.
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "collision/contact_meeting.h"

namespace pcphys {
namespace {

/// Impacts within this share of a sub-step are at one time.
constexpr double at_once = 1e-3;

}  // namespace

/// Impacts come in the order of time: what meets later than something else meets one of the two waits, since that one
/// then goes elsewhere. Of those in `struck_`.
template <class Scalar> void Detector::put_off(const Substep<Scalar>& look) {
  const auto standing = [&](std::uint32_t at) -> Standing& { return standings_[look.contacts[at]]; };
  const auto soonest = [&](const Standing& c, int side) -> double* {
    return proxies_[c.shapes[side]].responds ? &soonest_[c.rows[side]] : nullptr;
  };
  const auto when = [&](std::uint32_t at) { return double(look.s.tables.get(Buffer::contact, look.contacts[at], 31)); };
  const double h = look.h;
  waiting_.clear();
  std::erase_if(struck_, [&](std::uint32_t at) { return !standing(at).struck; });  // an inner edge, for one
  if (struck_.empty() || look.last) return;
  soonest_.resize(levers_.size(), std::numeric_limits<double>::infinity());
  const auto each = [&](const auto& does) {
    for (const std::uint32_t at : struck_)
      for (int side = 0; side < 2; side++)
        if (double* soon = soonest(standing(at), side)) does(*soon, at);
  };
  each([&](double& soon, std::uint32_t at) { soon = std::min(soon, when(at)); });
  each([&](double& soon, std::uint32_t at) { standing(at).waits |= when(at) > soon + at_once * h; });
  each([&](double& soon, std::uint32_t) { soon = std::numeric_limits<double>::infinity(); });
  for (const std::uint32_t at : struck_) {
    if (!standing(at).waits) continue;
    meeting(look, look.contacts[at]).stand_aside();
    gone_.push_back(look.contacts[at]);
    waiting_.push_back(at);
  }
  std::erase_if(struck_, [&](std::uint32_t at) { return !standing(at).struck; });
}

/// Marks the bodies that impacts have struck since it was called last, of those that the last sweep looked at: looks
/// and sweeps go by that.
template <class Scalar> void Detector::mark_struck(const Substep<Scalar>& look) {
  Scalar* const delta = look.s.tables.template data<Scalar>(Buffer::delta);
  constexpr std::size_t reals = reals_of(Buffer::delta);
  if (std::exchange(none_struck_, false)) {  // the step has begun: what is marked or counted is of the last one
    times_struck_.assign(levers_.size(), 0);
    marked_.clear();
    swept_.clear();
  }
  for (const std::uint32_t body : marked_) delta[body * reals + 9] = 0;
  marked_.clear();
  for (const std::uint32_t body : swept_) {
    const float times = float(delta[body * reals + 7]);
    if (times == times_struck_[body]) continue;
    times_struck_[body] = times;
    mark(look, body);
  }
}

template <class Scalar> void Detector::mark(const Substep<Scalar>& look, std::uint32_t body) {
  look.s.tables.template data<Scalar>(Buffer::delta)[body * reals_of(Buffer::delta) + 9] = 1;
  marked_.push_back(body);
}

/// By body that answers impulses, its contacts of a level: their numbers in the order of rows.
void Detector::list_contacts_of(const Listed& contacts, unsigned level) {
  if (std::exchange(listed_level_, level + 1) == level + 1) return;
  first_of_.assign(levers_.size() + 1, 0);
  const auto each = [&](const auto& does) {
    for (std::uint32_t number = 0; number < contacts.places.size(); number++) {
      const Standing& c = standings_[contacts.rows[contacts.places[number]]];
      for (int side = 0; side < 2 && !c.jointed; side++)
        if (proxies_[c.shapes[side]].responds) does(c.rows[side], number);
    }
  };
  each([&](std::uint32_t body, std::uint32_t) { first_of_[body + 1]++; });
  std::partial_sum(first_of_.begin(), first_of_.end(), first_of_.begin());
  contacts_of_.resize(first_of_.back());
  each([&](std::uint32_t body, std::uint32_t number) { contacts_of_[first_of_[body]++] = number; });
  std::shift_right(first_of_.begin(), first_of_.end(), 1);
  first_of_[0] = 0;
}

/// Places of the contacts of marked bodies, and of `others`, in the order of their rows.
void Detector::find_beside_struck(const Listed& contacts, std::span<const std::uint32_t> others) {
  const auto row_of = [&](std::uint32_t at) { return contacts.rows[at]; };
  of_marked_.clear(contacts.places.size());
  for (const std::uint32_t at : others)
    of_marked_.set(
        std::uint32_t(std::ranges::lower_bound(contacts.places, row_of(at), {}, row_of) - contacts.places.begin()));
  for (const std::uint32_t body : marked_)
    for (std::uint32_t i = first_of_[body]; i < first_of_[body + 1]; i++) of_marked_.set(contacts_of_[i]);
  beside_struck_.clear();
  of_marked_.each([&](std::uint32_t number) { beside_struck_.push_back(contacts.places[number]); });
}

/// Contacts that do not act, of bodies that were struck since: as their velocities are now, from that instant on.
template <class Scalar> void Detector::meet_struck(const Substep<Scalar>& look) {
  const Scalar* const delta = look.s.tables.template data<Scalar>(Buffer::delta);
  const auto struck_at = [&](std::uint32_t body) { return double(delta[body * reals_of(Buffer::delta) + 8]); };
  struck_.clear();
  inner_.clear();
  find_beside_struck({look.contacts, look.places}, waiting_);
  for (const std::uint32_t at : beside_struck_) {
    const std::uint32_t row = look.contacts[at];
    Standing& c = standings_[row];
    if (c.acts || c.touches) continue;
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
  drop_inner_edges(look);
  put_off(look);
  for (const std::uint32_t at : struck_)  // no sweep has seen them
    for (const std::uint32_t body : standings_[look.contacts[at]].rows)
      if (look.s.responds(body)) mark(look, body);
}

/// Contacts of marked bodies that may have an impact: those that meet, and touching ones that bounce.
template <class Scalar> void Detector::find_unseen(const Substep<Scalar>& look) {
  unseen_.clear();
  find_beside_struck({look.contacts, look.places}, {});
  for (const std::uint32_t at : beside_struck_)
    if (may_strike(standings_[look.contacts[at]])) unseen_.push_back(at);
  note_swept(look);
}

/// The bodies that the sweep to come may strike.
template <class Scalar> void Detector::note_swept(const Substep<Scalar>& look) {
  swept_.clear();
  for (const std::uint32_t at : unseen_)
    for (const std::uint32_t body : standings_[look.contacts[at]].rows) swept_.push_back(body);
}

void Detector::meet_again(WorldState& s, const Listed& contacts, unsigned level, bool last, double h,
                          const Options& options) {
  look_in(s, contacts, level, h, options, [&](auto look) {
    look.last = last;
    list_contacts_of(contacts, level);
    mark_struck(look);
    meet_struck(look);
    find_unseen(look);
  });
}

template void Detector::put_off(const Substep<float>&);
template void Detector::mark_struck(const Substep<float>&);
template void Detector::note_swept(const Substep<float>&);
template void Detector::put_off(const Substep<double>&);
template void Detector::mark_struck(const Substep<double>&);
template void Detector::note_swept(const Substep<double>&);

}  // namespace pcphys
