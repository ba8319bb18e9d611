#include "step/runner.h"

#include <chrono>
#include <string>
#include <utility>

namespace pcphys {
namespace {

using Clock = std::chrono::steady_clock;

Timer timer_of(Stage stage) {
  constexpr Timer timers[stage_count] = {Timer::integrate, Timer::joints, Timer::impulses};
  return timers[std::size_t(stage)];
}
Timer timer_of(const PlanEntry& entry) {
  if (entry.kind == PlanEntry::Kind::upload) return Timer::upload;
  if (entry.kind == PlanEntry::Kind::download) return Timer::download;
  return timer_of(schema(entry.kernel).stage);
}

bool takes_part(Place place, const StepSettings& s) { return s.integrate == place || s.joints == place || s.impulses == place; }

std::size_t info_index(const PlanEntry& entry) { return std::size_t{entry.octave} * phase_count + std::size_t(entry.phase); }
/// Where contact_impact raises its flag: the property `some_struck`.
constexpr std::uint32_t flag_quad = 2;

/// The list or slot array behind a buffer that is no table's, or null.
std::vector<std::uint32_t>* list_of(Buffer buffer, Schedule& schedule) {
  switch (buffer) {
    case Buffer::bodies: return &schedule.bodies;
    case Buffer::joint_ends: return &schedule.joints.ends();
    case Buffer::joint_order: return &schedule.joints.order();
    case Buffer::joint_paths: return &schedule.joints.paths();
    case Buffer::tree_blocks: return &schedule.trees.lists().blocks;
    case Buffer::tree_parents: return &schedule.trees.lists().parents;
    case Buffer::tree_ends: return &schedule.trees.lists().ends;
    case Buffer::tree_order: return &schedule.trees.lists().order;
    case Buffer::contact_paths: return &schedule.contacts.paths();
    case Buffer::contact_ends: return &schedule.contacts.ends();
    case Buffer::contact_order: return &schedule.contacts.order();
    default: return nullptr;
  }
}
/// Slots whose kernel writes no body are independent of each other: no colours, no barriers between them.
bool needs_colours(const KernelSchema& k) {
  for (const Access& a : k.accesses)
    if (a.write && a.buffer < Buffer::table_buffers && schema(a.buffer).table == Table::body) return true;
  return false;
}
bool of_contacts(Domain domain) {
  return domain == Domain::contact || domain == Domain::free_contact || domain == Domain::tree_contact;
}
bool of_joints(Domain domain) { return domain == Domain::joint || domain == Domain::free_joint || domain == Domain::tree_joint; }
/// How many of a domain may stand side by side.
std::uint32_t side_by_side(Domain domain, const Schedule& schedule) {
  if (domain == Domain::body) return schedule.moving;
  if (domain == Domain::tree) return schedule.trees.side_by_side();
  return (of_joints(domain) ? schedule.joints : schedule.contacts).side_by_side();
}
void pack(Domain domain, std::uint32_t lanes, Schedule& schedule) {
  if (of_joints(domain)) schedule.joints.pack(lanes);
  if (of_contacts(domain)) schedule.contacts.pack(lanes);
  if (domain == Domain::tree) schedule.trees.pack(lanes);
}
std::span<const Range> ranges_of(Domain domain, const Schedule& schedule, unsigned octave) {
  if (domain == Domain::body) return schedule.ranges(octave);
  if (domain == Domain::joint) return schedule.joints.ranges(octave);
  if (domain == Domain::free_joint) return schedule.joints.free_ranges(octave);
  if (domain == Domain::tree_joint) return schedule.joints.tree_ranges(octave);
  if (domain == Domain::tree) return schedule.trees.ranges(octave);
  if (domain == Domain::free_contact) return schedule.contacts.free_ranges(octave);
  if (domain == Domain::tree_contact) return schedule.contacts.tree_ranges(octave);
  return schedule.contacts.ranges(octave);
}
std::size_t slots_of(Buffer buffer, Domain domain, const Schedule& schedule) {
  if (buffer == Buffer::contact_reach) return schedule.contacts.reach_slots();
  if (domain == Domain::tree) return schedule.trees.slots();
  return (of_joints(domain) ? schedule.joints : schedule.contacts).slots();
}
std::uint64_t version_of(Buffer buffer, const WorldState& state, const Schedule& schedule) {
  if (buffer < Buffer::table_buffers) return state.tables.version(buffer) + 1;
  if (buffer == Buffer::bodies) return schedule.bodies_version + 1;
  if (buffer == Buffer::joint_ends || buffer == Buffer::joint_order || buffer == Buffer::joint_paths)
    return schedule.joints.version() + 1;
  if (buffer == Buffer::contact_ends || buffer == Buffer::contact_order || buffer == Buffer::contact_paths)
    return schedule.contacts.version() + 1;
  return schedule.trees.version() + 1;
}

}  // namespace

GlBackendMaker& gl_backend_maker() {
  static GlBackendMaker maker = make_gl_backend;
  return maker;
}

std::string Runner::device(Place place) const {
  const Device& d = devices_[std::size_t(place)];
  return d.backend ? d.backend->device() : std::string();
}

Status Runner::prepare(const StepSettings& s, Precision precision) {
  gl_ = takes_part(Place::gl, s);
  if (!workers_ || threads_ != s.threads) {
    at(Place::cpu) = {};
    workers_ = std::make_unique<Workers>(s.threads);
    threads_ = s.threads;
  }
  for (Place place : {Place::cpu, Place::gl}) {
    Device& d = at(place);
    if (!takes_part(place, s)) continue;
    const bool fits = d.backend && d.precision == precision &&
                      (place == Place::cpu ? d.lanes == s.lanes : d.index == s.device && d.host_context == s.host_context);
    if (fits) continue;
    auto made = place == Place::cpu ? make_cpu_backend(precision, s.lanes, workers_.get())
                                    : gl_backend_maker()(precision, s.device, s.host_context);
    if (!made) return made.error();
    d = {};
    d.backend = std::move(*made);
    d.precision = precision;
    d.lanes = s.lanes;
    d.index = s.device;
    d.host_context = s.host_context;
  }
  return {};
}

void Runner::forget() {
  for (Device& d : devices_) d.copies = {};
}

void Runner::keep(const WorldState& state, Buffer buffer) {
  const bool lasts = holds(buffer, Role::state) || holds(buffer, Role::input);
  const Table table = schema(buffer).table;
  if ((lasts || gl_) && table != Table::contact && table != Table::node) rollback_.keep(state.tables, buffer);
}

void Runner::undo(WorldState& state) {
  if (gl_) (void)at(Place::gl).backend->finish();  // lets go of the context and of errors that are of this step
  rollback_.put_back(state.tables);
  forget();  // kernels have written what the devices hold
}

Status Runner::attach(Place place, Buffer buffer, void* host, std::size_t bytes) {
  Device& d = at(place);
  Copy& copy = d.copies[std::size_t(buffer)];
  if (copy.host == host && copy.bytes == bytes) return {};
  if (place == Place::gl && copy.bytes != bytes) copy.version = 0;
  copy.host = host;
  copy.bytes = bytes;
  return d.backend->attach(buffer, host, bytes);
}

Status Runner::bind(const StepPlan& plan, WorldState& state, Schedule& schedule) {
  for (const PlanBinding& b : plan.bindings) {
    Status ok;
    if (b.buffer < Buffer::table_buffers) {
      AlignedBytes& rows = state.tables.bytes(b.buffer);
      ok = attach(b.place, b.buffer, rows.data(), rows.size());
    } else {
      pack(b.domain, lanes(b.place, b.domain, schedule), schedule);
      if (std::vector<std::uint32_t>* list = list_of(b.buffer, schedule))
        ok = attach(b.place, b.buffer, list->data(), list->size() * 4);
      else
        ok = at(b.place).backend->reserve(b.buffer, slots_of(b.buffer, b.domain, schedule));
    }
    if (!ok) return ok;
  }
  return {};
}

Status Runner::upload(Buffer buffer, std::uint64_t version, StepReport& report) {
  Device& d = at(Place::gl);
  Copy& copy = d.copies[std::size_t(buffer)];
  if (copy.version == version) return {};
  copy.version = version;
  report.transfer_bytes += copy.bytes;
  return d.backend->upload(buffer);
}

Status Runner::transfer(const PlanEntry& entry, WorldState& state, StepReport& report) {
  Device& d = at(Place::gl);
  Copy& copy = d.copies[std::size_t(entry.buffer)];
  report.transfer_bytes += copy.bytes;
  if (Status ok = d.backend->download(entry.buffer); !ok) return ok;
  state.tables.touch(entry.buffer);
  copy.version = state.tables.version(entry.buffer) + 1;
  return {};
}

std::uint32_t Runner::lanes(Place place, Domain domain, const Schedule& schedule) {
  return at(place).backend->width_for(side_by_side(domain, schedule));
}

std::span<const Range> Runner::of_octave(std::span<const Range> ranges, bool coloured) {
  ranges_.clear();
  for (const Range& range : ranges) {
    if (range.begin == range.end) continue;
    if (!coloured && !ranges_.empty() && ranges_.back().end == range.begin)
      ranges_.back().end = range.end;
    else
      ranges_.push_back(range);
  }
  return ranges_;
}

Status Runner::kernel(const PlanEntry& entry, WorldState& state, Schedule& schedule) {
  const KernelSchema& k = schema(entry.kernel);
  std::span<const Range> ranges = ranges_of(k.domain, schedule, entry.octave);
  const Range all = ranges.empty() ? Range{0, 0} : Range{ranges.front().begin, ranges.back().end};
  if (schedule.grouped())
    ranges = of_octave(ranges, needs_colours(k));
  else if (ranges.size() > 1 && !needs_colours(k))
    ranges = std::span<const Range>(&all, 1);
  Backend& backend = *at(entry.place).backend;
  // nothing to do, but later entries count on its barrier
  if (ranges.empty()) return entry.barrier ? backend.run(entry.kernel, info_index(entry), ranges, 1, true) : Status{};
  if (gl_ && entry.place == Place::cpu)
    for (const Access& a : k.accesses)
      if (a.write && a.buffer < Buffer::table_buffers) state.tables.touch(a.buffer);
  const std::uint32_t width = lanes(entry.place, k.domain, schedule);
  if (entry.again == 0) return backend.run(entry.kernel, info_index(entry), ranges, width, entry.barrier);
  for (std::uint32_t i = 0; i < entry.again; i++) {
    const Result<bool> struck = backend.take_flag(Buffer::velocity_parts, flag_quad);
    if (!struck) return struck.error();
    if (!*struck) break;
    if (Status ok = backend.run(entry.kernel, info_index(entry), ranges, width, true); !ok) return ok;
  }
  return {};
}

Status Runner::entry(const PlanEntry& entry, WorldState& state, Schedule& schedule, StepReport& report) {
  if (entry.kind == PlanEntry::Kind::kernel) return kernel(entry, state, schedule);
  if (entry.kind == PlanEntry::Kind::download) return transfer(entry, state, report);
  return upload(entry.buffer, version_of(entry.buffer, state, schedule), report);
}

Status Runner::run(const StepSettings& settings, const StepPlan& plan, WorldState& state, Schedule& schedule, const void* infos,
                   StepReport& report) {
  const std::size_t info_count = plan.entries.empty() ? phase_count : (1u + plan.entries.back().octave) * phase_count;
  for (Place place : {Place::cpu, Place::gl})
    if (takes_part(place, settings))
      if (Status ok = at(place).backend->set_infos(infos, info_count); !ok) return ok;
  for (const Buffer buffer : plan.overwritten) {
    keep(state, buffer);
    if (!gl_) state.tables.touch(buffer);  // else kernel by kernel, as devices follow them
  }
  Clock::time_point began;
  if (settings.timings) began = Clock::now();
  for (std::size_t i = 0; i < plan.entries.size(); i++) {
    const PlanEntry& e = plan.entries[i];
    if (Status ok = entry(e, state, schedule, report); !ok) return ok;
    if (!settings.timings) continue;
    const PlanEntry* next = i + 1 < plan.entries.size() ? &plan.entries[i + 1] : nullptr;
    if (next && timer_of(*next) == timer_of(e) && next->place == e.place) continue;
    if (gl_)
      if (Status done = at(Place::gl).backend->finish(); !done) return done;
    const auto now = Clock::now();
    report.ms[std::size_t(timer_of(e))] += std::chrono::duration<double, std::milli>(now - began).count();
    began = now;
  }
  if (gl_)
    if (Status done = at(Place::gl).backend->finish(); !done) return done;
  return {};
}

}  // namespace pcphys
