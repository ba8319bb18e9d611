#include "step/runner.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "plan/island_class.h"
#include "step/domains.h"
#include "step/entries.h"
#include "step/own_work.h"

namespace pcphys {
namespace {

using Clock = std::chrono::steady_clock;

bool takes_part(Place place, const StepSettings& s, const OwnKernels& own) {
  if (s.integrate == place || s.joints == place || s.impulses == place) return true;
  if (place == Place::gl && s.sleep && s.islands == place) return true;
  return std::ranges::any_of(own.ordered(),
                             [&](const auto& k) { return place == Place::gl ? !k->in_cpp() : k->body.empty(); });
}

/// Where kernels raise a flag, the last real of a quad.
std::uint32_t quad_of(std::string_view flag) {
  return std::ranges::find(properties(), flag, &PropertySchema::name)->offset / 4;
}
std::uint32_t struck_quad() {
  static const std::uint32_t quad = quad_of("some_struck");
  return quad;
}
std::uint32_t left_quad() {
  static const std::uint32_t quad = quad_of("some_left");
  return quad;
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

Status Runner::prepare(const StepSettings& s, Precision precision, const OwnKernels& own) {
  gl_ = takes_part(Place::gl, s, own);
  if (!workers_ || threads_ != s.threads) {
    bound_ = {};
    at(Place::cpu) = {};
    workers_ = std::make_unique<Workers>(s.threads);
    threads_ = s.threads;
  }
  for (Place place : {Place::cpu, Place::gl}) {
    Device& d = at(place);
    d.takes_part = takes_part(place, s, own);
    if (!d.takes_part) continue;
    const bool fits =
        d.backend && d.precision == precision &&
        (place == Place::cpu ? d.lanes == s.lanes : d.index == s.device && d.host_context == s.host_context);
    if (fits) continue;
    bring_home();
    bound_ = {};
    auto made = place == Place::cpu ? make_cpu_backend(precision, s.lanes, workers_.get())
                                    : gl_backend_maker()(precision, s.device, s.host_context);
    if (!made) return made.error();
    d = {};
    d.takes_part = true;
    d.backend = std::move(*made);
    d.precision = precision;
    d.lanes = s.lanes;
    d.index = s.device;
    d.host_context = s.host_context;
  }
  return {};
}

Runner::~Runner() { bring_home(); }

void Runner::bring_home() {
  if (Tables* tables = std::exchange(holds_of_, nullptr)) tables->take_back(this);
}

void Runner::fetch(Buffer buffer) {
  const Status ok = at(Place::gl).backend->download(buffer);
  if (fetched_) fetched_ = ok;
}

void Runner::list_memory(MemoryUses& uses) const {
  for (const Place place : {Place::cpu, Place::gl}) {
    const Backend* backend = devices_[std::size_t(place)].backend.get();
    if (!backend) continue;
    uses.add_buffers(place, [&](Buffer b) { return backend->held_bytes(b); });
    uses.add("sums", "", place, backend->sum_bytes());
  }
  uses.add("rollback", "", Place::cpu, rollback_.memory_bytes());
}

void Runner::forget() {
  bring_home();
  bound_ = {};
  for (Device& d : devices_) d.copies.clear();
}

void Runner::let_go() {
  devices_ = {};
  rollback_ = Rollback();
}

bool Runner::keeps(Buffer buffer) const {
  if (is_own(buffer)) return true;
  const bool lasts = holds(buffer, Role::state) || holds(buffer, Role::input);
  const Table table = schema(buffer).table;
  return (lasts || gl_) && table != Table::contact && table != Table::node && table != Table::touch;
}

void Runner::keep(const WorldState& state, Buffer buffer) {
  if (keeps(buffer)) rollback_.keep(state.tables, buffer);
}

void Runner::undo(WorldState& state) {
  if (gl_) (void)at(Place::gl).backend->finish();  // lets go of the context and of errors that are of this step
  for (const Buffer buffer : kept_there_) (void)at(Place::gl).backend->put_back(buffer);
  kept_there_.clear();
  rollback_.put_back(state.tables);
  forget();  // kernels have written what the devices hold
}

Status Runner::attach(Place place, Buffer buffer, void* host, std::size_t bytes) {
  Device& d = at(place);
  Copy& copy = d.copy(buffer);
  if (copy.attached && copy.host == host && copy.bytes == bytes) return {};
  copy.attached = true;
  if (place == Place::gl && copy.bytes != bytes) copy.version = 0;
  copy.host = host;
  copy.bytes = bytes;
  return d.backend->attach(buffer, host, bytes);
}

Status Runner::attach_table(Place place, Buffer buffer, WorldState& state) {
  AlignedBytes& rows = state.tables.place_of(buffer);
  return attach(place, buffer, rows.data(), rows.size());
}

Status Runner::bind(const StepSettings& settings, const StepPlan& plan, WorldState& state, Schedule& schedule,
                    bool strays) {
  const Bound now{&plan, state.serial, state.tables.layout(), schedule.changes(), settings.timings, strays};
  if (now == bound_) {
    for (const Place place : exchanged_)
      if (Status ok = attach_table(place, Buffer::contact, state); !ok) return ok;
    return {};
  }
  bound_ = {};  // until all of it stands
  exchanged_.clear();
  for (const PlanBinding& b : plan.bindings) {
    Status ok;
    if (b.buffer == Buffer::contact) exchanged_.push_back(b.place);
    if (of_table(b.buffer)) {
      ok = attach_table(b.place, b.buffer, state);
    } else {
      pack(b.domain, lanes(b.place, b.domain, schedule), schedule);
      if (std::vector<std::uint32_t>* list = list_of(b.buffer, schedule))
        ok = attach(b.place, b.buffer, list->data(), list->size() * 4);
      else
        ok = at(b.place).backend->reserve(b.buffer, slots_of(b.buffer, b.domain, schedule));
    }
    if (!ok) return ok;
  }
  for (const PlanEntry& entry : plan.entries)
    if (entry.own && entry.kind == PlanEntry::Kind::kernel)
      if (Status ok = at(entry.place).backend->prepare(*entry.own); !ok) return ok;
  prepare_calls(plan, settings.timings, strays, state, schedule);
  bound_ = now;
  return {};
}

Status Runner::upload(Buffer buffer, WorldState& state, const Schedule& schedule, StepReport& report) {
  Device& d = at(Place::gl);
  Copy& copy = d.copy(buffer);
  const std::uint64_t version = version_of(buffer, state, schedule);
  if (copy.version == version) return {};
  if (of_table(buffer)) (void)state.tables.bytes(buffer);  // another device may have it
  copy.version = version;
  report.transfer_bytes += copy.bytes;
  report.upload_bytes += copy.bytes;
  return d.backend->upload(buffer);
}

Status Runner::transfer(const PlanEntry& entry, WorldState& state, StepReport& report) {
  Device& d = at(Place::gl);
  Copy& copy = d.copy(entry.buffer);
  report.transfer_bytes += copy.bytes;
  if (Status ok = d.backend->download(entry.buffer); !ok) return ok;
  if (!of_table(entry.buffer)) return {};
  state.tables.touch(entry.buffer);
  copy.version = state.tables.version(entry.buffer) + 1;
  return {};
}

Status Runner::kernels(const Call& call, WorldState& state, const void* infos) {
  const PlanEntry& entry = *call.entry;
  const std::span<const KernelRun> runs(runs_.data() + call.first, call.count);
  Backend& backend = *at(entry.place).backend;
  if (gl_ && entry.place == Place::cpu && !runs[0].ranges.empty())
    for (const Access& a : accesses(entry))
      if (a.write && of_table(a.buffer)) state.tables.touch(a.buffer);
  if (bound_.plan->flight && !entry.own && stage(entry) != Stage::islands) {
    Status ok = backend.run(runs);
    if (!ok || runs[0].ranges.empty()) return ok;
    const Result<bool> left = backend.take_flag(Buffer::velocity_parts, left_quad());
    if (!left) return left.error();
    left_ = *left;
    return ok;
  }
  if (watched_ && entry.again == 0) return run_watched(entry.place, runs, state);
  if (entry.again == 0) return backend.run(runs);
  // later entries count on its barrier
  if (runs[0].ranges.empty()) return entry.barrier ? backend.run(runs) : Status{};
  const Buffer flag = stage(entry) == Stage::islands ? Buffer::island_labels : Buffer::velocity_parts;
  for (std::uint32_t i = 0; i < entry.again; i++) {
    const Result<bool> more = backend.take_flag(flag, struck_quad());
    if (!more) return more.error();
    const bool looks = collider_ && strikes(entry.kernel);
    if (!*more && !(looks && collider_->waits())) break;
    if (looks)
      if (Status ok = collide_again(entry, i + 1 == entry.again, state, infos, runs[0]); !ok) return ok;
    if (Status ok = backend.run(runs); !ok) return ok;
  }
  return {};
}

std::span<const Range> Runner::narrowed_to(const Narrowed& n) const {
  if (n.to == Narrowed::To::struck) return collider_->struck_blocks();
  const std::span<const Range> renewed = collider_->renewed_blocks();
  return n.to == Narrowed::To::renewed || renewed.empty() ? renewed : n.all;
}

/// What impacts have sent elsewhere may meet others there: contacts that act from now on have their rows made.
Status Runner::collide_again(const PlanEntry& entry, bool last, WorldState& state, const void* infos,
                             const KernelRun& impacts) {
  Backend& backend = *at(entry.place).backend;
  if (entry.place == Place::gl)
    for (const Buffer buffer : {Buffer::pose, Buffer::motion, Buffer::delta})
      if (Status ok = backend.download(buffer); !ok) return ok;
  PlanEntry biased = entry;
  biased.phase = Phase::biased;
  collider_->collide_again(state, entry.octave, last, substep_of(biased, infos, state.tables.precision()));
  if (entry.place == Place::gl)
    for (const Buffer buffer : {Buffer::contact, Buffer::delta})
      if (Status ok = backend.upload(buffer); !ok) return ok;
  const bool frictionless = entry.kernel == Kernel::contact_impact_frictionless;
  KernelRun prepare = impacts;
  prepare.kernel = frictionless ? Kernel::contact_prepare_frictionless : Kernel::contact_prepare;
  prepare.barrier = true;
  prepare.info = std::uint32_t(info_index(biased));
  if (entry.place == Place::cpu) prepare.ranges = collider_->renewed_blocks();
  for (const Narrowed& n : narrowed_)  // other ones than those of the sweep before
    if (n.to == Narrowed::To::struck && &runs_[n.run] == &impacts) runs_[n.run].ranges = collider_->struck_blocks();
  return backend.run(std::span(&prepare, 1));
}

Status Runner::run_watched(Place place, std::span<const KernelRun> runs, WorldState& state) {
  Backend& backend = *at(place).backend;
  for (const KernelRun& run : runs) {
    if (Status ok = backend.run(std::span(&run, 1)); !ok) return ok;
    if (!run.own) continue;
    for (const Access& a : run.own->accesses) {
      if (place == Place::cpu || !of_table(a.buffer)) continue;
      keep(state, a.buffer);
      if (Status ok = backend.download(a.buffer); !ok) return ok;
    }
    if (Status ok = check_written(state, *run.own); !ok && reads_finite(state, *run.own)) return ok;
  }
  return {};
}

double Runner::substep_of(const PlanEntry& entry, const void* infos, Precision precision) const {
  const std::size_t index = info_index(entry);
  if (precision == Precision::f64) return static_cast<const InfoOf<double>*>(infos)[index].h;
  return double(static_cast<const InfoOf<float>*>(infos)[index].h);
}

Status Runner::call(const Call& call, WorldState& state, const Schedule& schedule, const void* infos,
                    StepReport& report) {
  const PlanEntry& entry = *call.entry;
  if (entry.kind == PlanEntry::Kind::collide) {
    if (!collider_) return {};  // the table holds what was found
    const double h = substep_of(entry, infos, state.tables.precision());
    if (entry.phase == Phase::sent)
      collider_->collide_sent(state, entry.octave, h);
    else
      collider_->collide(state, entry.octave, entry.substep == 0, h);
    if (gl_) state.tables.touch(Buffer::contact);
    for (const Narrowed& n : std::span(narrowed_).subspan(call.narrowed, call.narrowed_count))
      runs_[n.run].ranges = narrowed_to(n);
    return {};
  }
  if (entry.kind == PlanEntry::Kind::kernel) return kernels(call, state, infos);
  if (entry.kind == PlanEntry::Kind::download) return transfer(entry, state, report);
  return upload(entry.buffer, state, schedule, report);
}

/// A step with kernels of the host's own may have to be made again. What it leaves on the device is not among what it
/// overwrites on the host; where the device alone has it as it was, a copy of that stays there.
Status Runner::keep_left(WorldState& state) {
  kept_there_.clear();
  if (!may_be_undone_) return {};
  for (const Buffer buffer : bound_.plan->left_there) {
    if (state.tables.keeper(buffer) != this) {
      rollback_.keep(state.tables, buffer);
      continue;
    }
    if (Status ok = at(Place::gl).backend->keep(buffer); !ok) return ok;
    kept_there_.push_back(buffer);
  }
  return {};
}

Status Runner::run(WorldState& state, const Schedule& schedule, const void* infos, StepReport& report,
                   Collider* collider) {
  left_ = false;
  collider_ = collider;
  if (!fetched_) return std::exchange(fetched_, Status{});
  if (state.tables.kept())  // by this device or another stepper's
    for (const PlanBinding& b : bound_.plan->bindings)
      if (b.place == Place::cpu && of_table(b.buffer)) (void)state.tables.bytes(b.buffer);
  for (Device& d : devices_)
    if (d.takes_part)
      if (Status ok = d.backend->set_infos(infos, infos_); !ok) return ok;
  for (const Buffer buffer : kept_) rollback_.keep(state.tables, buffer);
  if (Status ok = keep_left(state); !ok) return ok;
  if (!gl_)  // else kernel by kernel, as devices follow them
    for (const Buffer buffer : bound_.plan->overwritten) state.tables.touch(buffer);
  if (traces()) tracer_.told->begin(state);
  Clock::time_point began;
  if (bound_.timings) began = Clock::now();
  for (const Call& c : calls_) {
    if (Status ok = call(c, state, schedule, infos, report); !ok) return ok;
    if (c.ends)
      tracer_.substep({state, schedule, *bound_.plan, *c.entry, *at(Place::cpu).backend}, infos, info_index(*c.entry));
    if (!c.last) continue;
    if (gl_)
      if (Status done = at(Place::gl).backend->finish(); !done) return done;
    const auto now = Clock::now();
    report.ms[std::size_t(timer_of(*c.entry))] += std::chrono::duration<double, std::milli>(now - began).count();
    began = now;
  }
  if (gl_)
    if (Status done = at(Place::gl).backend->finish(); !done) return done;
  for (const Buffer buffer : bound_.plan->left_there) {
    holds_of_ = &state.tables;
    state.tables.leave(buffer, this);
    at(Place::gl).copy(buffer).version = state.tables.version(buffer) + 1;
  }
  return {};
}

}  // namespace pcphys
