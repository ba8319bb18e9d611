#include "events/event_recorder.h"

#include <algorithm>
#include <cstring>
#include <iterator>

namespace pcphys {
namespace {

constexpr std::uint32_t speed_at = 4;            // in a row of Buffer::touch
constexpr std::uint32_t normal_impulse_at = 20;  // in a row of Buffer::contact

template <class Scalar> const Scalar* row_of(const AlignedBytes& bytes, Buffer buffer, std::uint32_t row) {
  return reinterpret_cast<const Scalar*>(bytes.data()) + std::size_t{row} * schema(buffer).reals;
}
template <class Scalar> const Scalar* row_of(const WorldState& s, Buffer buffer, std::uint32_t row) {
  return row_of<Scalar>(s.tables.bytes(buffer), buffer, row);
}
/// Without the sign of a zero, which devices may differ in.
template <class Scalar> Vec3 vec3(const Scalar* p) {
  return {double(p[0]) + 0.0, double(p[1]) + 0.0, double(p[2]) + 0.0};
}

TouchingPair pair_of(const WorldState& s, std::uint32_t contact) {
  const auto [row_a, row_b] = s.contacts.ends[contact];
  const BodyRecord &a = s.bodies[row_a], &b = s.bodies[row_b];
  auto [shape_a, shape_b] = s.contacts.keys[contact];
  if (s.shapes[shape_a].body != a.index) std::swap(shape_a, shape_b);
  const auto place = [](const BodyRecord& body, std::uint32_t shape) {
    return std::uint32_t(std::ranges::find(body.shapes, shape) - body.shapes.begin());
  };
  return {s.body_ids.id<BodyId>(a.index), s.body_ids.id<BodyId>(b.index), place(a, shape_a), place(b, shape_b)};
}

bool sleeps(const WorldState& s, std::uint32_t contact) {
  return s.asleep(s.contacts.ends[contact][0]) || s.asleep(s.contacts.ends[contact][1]);
}

/// Of the four points of a contact. What sleeps had no step, and its row of `touch` may be of another, or not be there:
/// its impulses are those that it rests on.
template <class Scalar> const Scalar* impulses_of(const WorldState& s, std::uint32_t contact) {
  if (sleeps(s, contact)) return row_of<Scalar>(s, Buffer::contact, contact) + normal_impulse_at;
  return row_of<Scalar>(s, Buffer::touch, contact);
}

/// Whether a point was pressed in this step, or the shapes overlap.
template <class Scalar> bool touches(const WorldState& s, std::uint32_t contact) {
  const Scalar *impulses = impulses_of<Scalar>(s, contact), *found = row_of<Scalar>(s, Buffer::contact, contact);
  if (impulses[0] > 0 || impulses[1] > 0 || impulses[2] > 0 || impulses[3] > 0) return true;
  for (int i = 0; i < int(found[3]); i++)
    if (found[7 + 4 * i] <= 0) return true;
  return false;
}

/// The mean of the points by their impulses; of a contact without any the deepest one.
template <class Scalar> Vec3 mean_point(const Scalar* impulses, const Scalar* found) {
  Vec3 mean, deepest;
  double whole = 0, least = 0;
  for (int i = 0; i < int(found[3]); i++) {
    const Vec3 point = vec3(found + 4 + 4 * i);
    const double impulse = double(impulses[i]), gap = double(found[7 + 4 * i]);
    mean = mean + impulse * point;
    whole += impulse;
    if (i > 0 && gap >= least) continue;
    deepest = point;
    least = gap;
  }
  return whole > 0 ? (1 / whole) * mean : deepest;
}

template <class Scalar>
Vec3 meeting_point(const WorldState& s, std::uint32_t contact, const EventRecorder::Before& before) {
  return before.detector.origin(contact) +
         mean_point(impulses_of<Scalar>(s, contact), row_of<Scalar>(s, Buffer::contact, contact));
}

/// Places of shapes are used again: whether these are the ones that touched.
bool same_bodies(const WorldState& s, const ContactKey& key, const TouchingPair& pair) {
  const auto body = [&](std::uint32_t shape) { return s.body_ids.id<BodyId>(s.shapes[shape].body); };
  const BodyId a = body(key.shape_a), b = body(key.shape_b);
  return (a == pair.a && b == pair.b) || (a == pair.b && b == pair.a);
}

}  // namespace

template <class Scalar>
ContactBegun EventRecorder::meeting(const WorldState& s, std::uint32_t contact, const Before& before) const {
  return {pair_of(s, contact), vec3(row_of<Scalar>(s, Buffer::contact, contact)),
          meeting_point<Scalar>(s, contact, before)};
}

template <class Scalar> void EventRecorder::find_hits(const WorldState& s, const Before& before, double least_speed) {
  for (std::uint32_t row = 1; row < s.contact_rows(); row++) {
    if (sleeps(s, row)) continue;
    const Scalar* touch = row_of<Scalar>(s, Buffer::touch, row);
    const double speed = double(touch[speed_at]);
    if (!(speed > 0 && speed >= least_speed)) continue;
    const double impulse = double(touch[0]) + double(touch[1]) + double(touch[2]) + double(touch[3]);
    hits_.push_back({meeting<Scalar>(s, row, before), speed, impulse});
  }
}

/// Both lists stand in ascending order of their keys.
template <class Scalar> void EventRecorder::follow_contacts(const WorldState& s, const Before& before) {
  next_.clear();
  auto old = touching_.begin();
  for (std::uint32_t row = 1; row < s.contact_rows(); row++) {
    const ContactKey key = s.contacts.keys[row];
    while (old != touching_.end() && (old->key < key || (old->key == key && !same_bodies(s, key, old->pair))))
      ended_.push_back((old++)->pair);
    if (old != touching_.end() && old->key == key) {
      next_.push_back(*old++);
    } else if (touches<Scalar>(s, row)) {
      begun_.push_back(meeting<Scalar>(s, row, before));
      next_.push_back({key, begun_.back()});
    }
  }
  while (old != touching_.end()) ended_.push_back((old++)->pair);
  touching_.swap(next_);
}

template <class Scalar>
void EventRecorder::find_moved(const WorldState& s, const AlignedBytes& poses, std::span<const std::uint32_t> moving) {
  for (const std::uint32_t row : moving) {
    const Scalar *now = row_of<Scalar>(s, Buffer::pose, row), *was = row_of<Scalar>(poses, Buffer::pose, row);
    if (!std::equal(now, now + 8, was)) moved_.push_back(s.body_ids.id<BodyId>(s.bodies[row].index));
  }
  if (!std::ranges::is_sorted(moved_)) std::ranges::sort(moved_);
}

template <class Scalar>
void EventRecorder::record_as(const StepSettings& settings, const WorldState& s, const Before& before,
                              std::span<const std::uint32_t> moving) {
  if (settings.contact_events) follow_contacts<Scalar>(s, before);
  if (settings.hit_events) find_hits<Scalar>(s, before, settings.hit_speed);
  if (settings.body_events && before.poses) find_moved<Scalar>(s, *before.poses, moving);
}

void EventRecorder::follow(const StepSettings& settings) {
  if (!settings.contact_events) touching_.clear();
  if (settings.body_events) return;
  asleep_.clear();
  rest_serial_ = 0;  // of no world
}

void EventRecorder::record(const StepSettings& settings, const WorldState& s, const Before& before,
                           std::span<const std::uint32_t> moving) {
  if (serial_ != s.serial) touching_.clear();
  serial_ = s.serial;
  if (s.tables.precision() == Precision::f32)
    record_as<float>(settings, s, before, moving);
  else
    record_as<double>(settings, s, before, moving);
}

void EventRecorder::keep_poses(const WorldState& s) {
  const AlignedBytes& now = s.tables.bytes(Buffer::pose);
  poses_.resize(now.size());
  std::memcpy(poses_.data(), now.data(), now.size());
}

/// By comparison with who slept after the last step, when that has changed.
void EventRecorder::follow_sleep(const StepSettings& settings, const WorldState& s) {
  if (!settings.body_events) return;
  if (rest_serial_ != s.serial) asleep_.clear();
  if ((s.sleepers == 0 && asleep_.empty()) || (rest_ == s.rest_version && rest_serial_ == s.serial)) return;
  rest_ = s.rest_version;
  rest_serial_ = s.serial;
  next_asleep_.clear();
  for (std::uint32_t index = 0; index < s.body_ids.size(); index++)
    if (s.body_ids.alive(index) && s.asleep(s.body_ids.row(index)))
      next_asleep_.push_back(s.body_ids.id<BodyId>(index));
  std::ranges::set_difference(next_asleep_, asleep_, std::back_inserter(slept_));
  std::ranges::set_difference(asleep_, next_asleep_, std::back_inserter(woken_));
  std::erase_if(woken_, [&](BodyId body) { return !s.body_ids.valid(body); });  // destroyed, not awake
  asleep_.swap(next_asleep_);
}

}  // namespace pcphys
