// What a host calls of a stepper.
#include <atomic>
#include <bit>
#include <chrono>
#include <optional>
#include <string>

#include "step/inside.h"
#include "step/schedule_invariants.h"
#include "step/transfer_bytes.h"
#include "world/invariants.h"

namespace pcphys {

const char* name(Timer timer) {
  constexpr const char* names[] = {"forces",    "broad",  "narrow",   "plan",    "upload",
                                   "integrate", "joints", "impulses", "download"};
  return names[std::size_t(timer)];
}

Status Stepper::Inside::check_kernel(const WorldState& s, const OwnKernel& kernel) {
  const Place stage_place =
      std::array{settings.integrate, settings.joints, settings.impulses}[std::size_t(kernel.stage)];
  const Place place = kernel.body.empty() ? Place::cpu : !kernel.in_cpp() ? Place::gl : stage_place;
  if (place == Place::cpu) return {};
  if (Status ok = prepare(s.tables.precision()); !ok) return ok;
  return runner.check(place, kernel);
}

void Stepper::Inside::list_islands(const WorldState& s, PlanSignature& wanted) {
  IslandLists& islands = schedule.islands;
  if (!finds_islands()) return islands.forget();
  if (regrouped || !islands.listed()) islands.list(s);
  wanted.islands = !islands.known();
  wanted.islands_known = islands.known();
}

Status Stepper::Inside::order_own(const WorldState& s, double dt, Schedule& of) const {
  OwnLists& lists = of.own;
  lists.order(s, own.kernels(), of.octave_of());
  const double cutoff = own.kernels().cutoff();
  if (cutoff == 0) return {};
  return lists.near.find(s, of.rows_that_move(), lists.places(), cutoff, dt, settings.max_pairs);
}

void Stepper::Inside::choose_order(FourthOrder& order, const WorldState& s, const TreeSlots& trees, double dt) const {
  order.choose(s, trees.forest(), trees.solved(), trees.closing(), !own.ordered().empty(), settings, dt);
}

Stepper::Stepper(const StepSettings& settings) try : inside_(std::make_unique<Inside>()) {
  inside_->settings = settings;
} catch (...) {
  detail::no_memory_for("Stepper");
}
Stepper::~Stepper() {
  if (inside_ && inside_->running)
    detail::misuse("A Stepper was destroyed while it makes a step; no callback may do that.");
}
Stepper::Stepper(Stepper&& other) noexcept {
  if (other.inside_ && other.inside_->running)
    detail::misuse("A Stepper was moved while it makes a step; no callback may do that.");
  inside_ = std::move(other.inside_);
}
Stepper& Stepper::operator=(Stepper&& other) noexcept {
  Stepper taken(std::move(other));
  Stepper given(std::move(*this));
  inside_ = std::move(taken.inside_);
  return *this;
}

Stepper::Inside& Stepper::inside(const char* call) {
  if (!inside_) detail::moved_from("Stepper", call);
  return *inside_;
}
const Stepper::Inside& Stepper::inside(const char* call) const {
  if (!inside_) detail::moved_from("Stepper", call);
  return *inside_;
}
Status Stepper::changeable(const char* call) const {
  if (inside(call).running) return busy("stepper");
  return {};
}
Status Stepper::changeable(const World& world, const char* call) const {
  if (world.state(call).stepping) return busy("world");
  return changeable(call);
}

Status Stepper::configure(const StepSettings& settings) try {
  if (Status ok = changeable(); !ok) return ok;
  if (Status ok = check_settings(settings); !ok) return ok;
  Inside& in = inside();
  in.settings = settings;
  in.recorder.follow(settings);
  in.checked = true;
  in.prepared.reset();
  in.idle = {};
  return {};
} catch (...) {
  return caught();
}
const StepSettings& Stepper::settings() const { return inside().settings; }

namespace {
/// Of a flag that is up while a step runs: of what was already up there is none.
class Running {
 public:
  explicit Running(std::atomic<bool>& flag) : flag_(flag.exchange(true) ? nullptr : &flag) {}
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  ~Running() {
    if (flag_) *flag_ = false;
  }
  explicit operator bool() const { return flag_; }

 private:
  std::atomic<bool>* flag_;
};
}  // namespace

const StepReport& Stepper::step(World& world, double dt) {
  using Clock = Inside::Clock;
  Inside& in = inside();
  WorldState& s = world.state();
  const Running stepper_runs(in.running), world_runs(s.stepping);
  if (!stepper_runs || !world_runs) {
    in.refused.error = busy(stepper_runs ? "world" : "stepper");
    return in.refused;
  }
  static const StepReport blank;
  const std::uint64_t made = in.report.step;
  in.report = blank;
  in.recorder.clear();
  const bool clocked = in.settings.timings;
  Clock::time_point start;
  if (clocked) start = in.began = Clock::now();
  in.step_within_memory(world, dt);
  in.walk_in_debug(s);
  in.report.step = made + (in.report ? 1 : 0);
  in.report.bodies = std::uint32_t(world.body_count());
  in.report.joints = std::uint32_t(world.joint_count());
  if (clocked) in.report.total_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return in.report;
}

void Stepper::Inside::start_anew() {
  runner.forget();
  detector = Detector();
  schedule = Schedule();
  octaves = Octaves();
  fourth = FourthOrder();
  plans.clear();
  plan = nullptr;
  sleepers = Sleepers();
  unrest = Unrest();
  idle = {};
  prepared.reset();
  serial = scheduled_serial = 0;
  spoiled = false;
}

void Stepper::Inside::walk_in_debug(WorldState& s) const {
  pcphys::walk_in_debug(s, "step");
#ifndef NDEBUG
  const bool walked = s.seen.rows_paid == 0;
  if (walked && !spoiled && is_scheduled(s)) walk_invariants(s, schedule);
#endif
}

bool Stepper::Inside::is_scheduled(const WorldState& s) const {
  return scheduled_serial == s.serial && scheduled == s.structure_version && scheduled_rest == s.rest_version;
}

void Stepper::Inside::keep_unfrozen(const WorldState& s) {
  constexpr Buffer written[] = {Buffer::motion,  Buffer::velocity_parts, Buffer::mass,
                                Buffer::inertia, Buffer::delta,          Buffer::rest};
  for (const Buffer buffer : written) unfrozen.keep(s.tables, buffer);
}

void Stepper::Inside::unfreeze(WorldState& s) {
  for (const BodyId id : report.frozen) {
    s.frozen.erase(id.index);
    s.bodies[s.body_ids.row(id.index)].frozen = false;
  }
  if (!report.frozen.empty()) s.structure_version++;
  report.frozen.clear();
  unfrozen.put_back(s.tables);
  s.count_rest();
}

void Stepper::Inside::freeze_left(WorldState& s) {
  leaving.clear();
  for (const std::uint32_t row : schedule.moving_bodies())
    if (s.tables.get(Buffer::motion, row, 7) == frozen_phase) leaving.push_back(row);
  freeze(s);
}

void Stepper::Inside::write_solved(WorldState& s) {
  undone = false;
  restores = s.restores;
  if (s.joints.size() == 1) return;  // not even the rows that pad need be there
  runner.keep(s, Buffer::joint_impulse);
  schedule.trees.solved().write(s);
  write_pivots(s, schedule.trees.solved(), schedule.trees.pivots());
}

void Stepper::Inside::update_structure(WorldState& s) {
  if (is_scheduled(s)) {
    if (undone || restores != s.restores) write_solved(s);
    return;
  }
  scheduled_serial = s.serial;
  scheduled = s.structure_version;
  scheduled_rest = s.rest_version;
  other = true;
  schedule.update_structure(s);
  write_solved(s);
  octaves.update_structure(s, schedule.trees.solved(), schedule.trees.closing(), schedule.trees.parallel());
  fourth.forget();
}

void Stepper::Inside::tell(const PlanSignature& wanted, const Detector::Found& found) {
  report.substeps = wanted.substeps << (std::bit_width(octaves_of(octaves.used())) - 1);
  report.refined = octaves.refined();
  report.limited = octaves.limited();
  report.fourth_order = octaves.fourth_order();
  report.pairs = found.pairs;
  report.contacts = found.contacts;
  report.points = found.points;
  report.joints_as_rows = schedule.joints.constraints() - schedule.joints.with_trees() - schedule.trees.free_springs();
  report.tree_contacts_as_rows = schedule.contacts.beside_trees();
  report.colours = found.contacts ? schedule.contacts.colours() : 0;
}

/// Where there is no memory for a step the world is as it was,
/// and what the stepper holds of it is made anew by the next.
void Stepper::Inside::step_within_memory(World& world, double dt) {
  WorldState& s = world.state();
  const double last_substep = s.last_substep, soft_substep = s.soft_substep, settling = s.settling;
  try {
    s.settle_contacts();
    if (spoiled) start_anew();
    if (const Status ok = step(world, dt); !ok) {
      unfreeze(s);
      report.error = ok.error();
    }
  } catch (...) {
    spoiled = true;
    undo(s);
    unfreeze(s);
    s.last_substep = last_substep;
    s.soft_substep = soft_substep;
    s.settling = settling;
    report = {};
    report.error = caught();
    recorder.clear();
  }
}

StepEvents Stepper::events() const { return inside().recorder.events(); }

const StepPlan& Stepper::plan() const {
  const Inside& in = inside();
  return in.plan ? *in.plan : in.no_plan;
}

Result<StepPlan> Stepper::plan_for(const World& world, double dt) try {
  Inside& in = inside();
  Status ok = changeable();
  if (ok) ok = check_dt(dt);
  if (ok) ok = check_settings(in.settings);
  if (ok) ok = in.own.check(world.state());
  if (!ok) return ok.error();
  Schedule schedule;
  schedule.update_structure(world.settled());
  Detector detector;
  if (ok = detector.find_pairs(world.state(), dt, in.detection()); !ok) return ok.error();
  PlanSignature wanted = signature(in.settings, world.state(), schedule);
  wanted.shapes = detector.possible();
  wanted.free_contacts = wanted.shapes && (wanted.bodies || !wanted.sleepers);
  wanted.tree_contacts = wanted.free_contacts && wanted.trees;
  wanted.friction = detector.may_resist(world.state());
  wanted.restitution = detector.may_bounce(world.state());
  wanted.impacts = wanted.free_contacts;
  wanted.rolling = detector.may_resist_rolling(world.state());
  wanted.touches = wanted.contact_events && wanted.contacts();
  FourthOrder order;
  in.choose_order(order, world.state(), schedule.trees, dt);
  wanted.octaves = order.classes(schedule.moving);
  wanted.second_order = order.reasons();
  if (in.finds_islands() && wanted.bodies && (wanted.contacts() || world.joint_count() > 0)) {
    schedule.islands.list(world.state());
    wanted.islands = true;
  }
  if (ok = in.order_own(world.state(), dt, schedule); !ok) return ok.error();
  StepPlan plan = make_plan(wanted, in.own.ordered());
  measure_transfers(plan, world.state(), schedule);
  return plan;
} catch (...) {
  return caught();
}

Status Stepper::add_kernel(World& world, const KernelDef& def) {
  if (Status ok = changeable(world); !ok) return ok;
  Inside& in = inside();
  WorldState& s = world.state();
  std::optional<OwnWork> others;  // of another world: they give way, unless this one is refused
  if (in.own.of_another(s)) {
    others = in.own;
    in.own.clear();
  }
  const auto add = [&]() -> Status {
    if (Status ok = in.follow_own(s); !ok) return ok;
    const Result<const OwnKernel*> added = in.own.add(s, def);
    if (!added) return added.error();
    Status ok = in.follow_own(s);
    if (ok) ok = in.check_kernel(s, **added);
    if (!ok) return (void)in.own.remove(s, def.text.name), ok;
    for (const Access& a : (*added)->accesses)
      if (is_own(a.buffer)) s.own.name(a.buffer);
    return ok;
  };
  const auto add_within_memory = [&]() -> Status {
    try {
      return add();
    } catch (...) {
      in.spoiled = true;
      const Error error = caught();
      (void)in.own.remove(s, def.text.name);
      return error;
    }
  };
  const Status ok = add_within_memory();
  if (!ok && others) in.own.put_back(*others);
  if (ok) s.stir_all();
  return ok;
}

Status Stepper::remove_kernel(World& world, std::string_view name) try {
  if (Status ok = changeable(world); !ok) return ok;
  const Status ok = inside().own.remove(world.state(), name);
  if (ok) world.state().stir_all();
  return ok;
} catch (...) {
  return caught();
}

Status Stepper::remove_kernels() {
  if (Status ok = changeable(); !ok) return ok;
  inside().own.clear();
  return {};
}

Status Stepper::set_parameter(std::string_view kernel, const KernelParameter& parameter) try {
  if (Status ok = changeable(); !ok) return ok;
  OwnKernel* k = inside().own.find(kernel);
  if (!k)
    return Error{ErrorCode::unknown_name,
                 "There is no kernel \"" + std::string(kernel) + "\"; Stepper::add_kernel adds one."};
  if (k->parameters_before.empty()) k->parameters_before = k->parameters;
  return set(*k, parameter);
} catch (...) {
  return caught();
}

std::vector<BufferUse> Stepper::memory(const World& world) const try {
  const Inside& in = inside();
  MemoryUses uses(world.state());
  uses.add_host(inside_->schedule);
  uses.add("collision", "", Place::cpu, in.detector.memory_bytes() + in.looks.memory_bytes());
  uses.add("islands", "", Place::cpu, bytes_of(in.octaves, in.fourth, in.sleepers, in.unrest, in.unfrozen));
  uses.add("events", "", Place::cpu, in.recorder.memory_bytes());
  in.runner.list_memory(uses);
  return uses.take();
} catch (...) {
  detail::no_memory_for("Stepper::memory");
}

Status Stepper::shrink() try {
  if (Status ok = changeable(); !ok) return ok;
  Inside& in = inside();
  in.start_anew();
  in.runner.let_go();
  in.unfrozen = Rollback();
  return {};
} catch (...) {
  return caught();
}

void Stepper::set_trace(ContactTrace* trace) { inside().runner.trace(trace); }

std::string Stepper::device(Place place) const { return inside().runner.device(place); }

}  // namespace pcphys
