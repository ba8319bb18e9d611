// One step, readable on a screen: forces, contacts, schedule, plan, run.
#pragma once
#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <string>

#include "collision/detector.h"
#include "collision/hook.h"
#include "events/event_recorder.h"
#include "pcphys/constants.h"
#include "pcphys/step.h"
#include "plan/fourth_order.h"
#include "plan/infos.h"
#include "plan/island_class.h"
#include "plan/octaves.h"
#include "plan/plan.h"
#include "plan/sleepers.h"
#include "plan/step_infos.h"
#include "step/called_forces.h"
#include "step/check_settings.h"
#include "step/contact_looks.h"
#include "step/force_jumps.h"
#include "step/own_work.h"
#include "step/plans.h"
#include "step/processor_state.h"
#include "step/runner.h"
#include "step/schedule.h"
#include "step/unrest.h"
#include "world/range.h"
#include "world/state.h"
#include "world/validate.h"

namespace pcphys {

struct Stepper::Inside {
  using Clock = std::chrono::steady_clock;
  static constexpr int most_tries = 8;

  std::atomic<bool> running{false};
  StepReport refused;  // of a step that was asked for while one runs
  StepSettings settings;
  bool checked = false;               // the settings
  std::optional<Precision> prepared;  // for worlds of this one, by the settings
  Detector detector;
  Schedule schedule;
  Octaves octaves;
  FourthOrder fourth;
  Runner runner;
  StepReport report;
  Plans plans;
  OwnWork own;                 // kernels of the host's own
  std::uint64_t own_seen = 0;  // of which changes plans know
  const StepPlan* plan = nullptr;
  std::uint64_t serial = 0, contacts_version = 0;     // of the world of the last step
  std::uint64_t scheduled_serial = 0, scheduled = 0;  // the world and structure that `schedule` is of
  std::uint64_t scheduled_rest = 0;                   // and who slept in it
  bool other = false;                                 // than those of the last step
  bool undone = false;                                // a try of a step, with what it wrote of joints
  std::uint64_t restores = 0;                         // of the world, when that was written last
  bool regrouped = false;                             // islands may be others than after it
  Sleepers sleepers;
  Unrest unrest;
  Idle idle;  // the world, if all of it sleeps
  StepInfos infos;
  EventRecorder recorder;
  std::vector<std::uint32_t> outside, leaving;  // rows
  bool tighter = false;                         // loops came under more tension than sub-steps were chosen for
  bool strayed = false;                         // some body went further than it was looked for
  bool suspect = false;                         // a kernel of the host's own may have written what is no number
  bool watched = false;                         // of this step: such kernels one by one
  bool ran = false;                             // as far as its plan
  Status written;                               // whether what the host's own kernels left is finite
  int tries = 0;                                // of this step
  Vec3 sound_gravity;                           // the last that was looked at
  CalledForces called;
  ForceJumps jumps;
  StepPlan no_plan;
  Rollback unfrozen;  // of this step, once it has frozen bodies
  Clock::time_point began;
  ContactLooks looks{detector, schedule.contacts};

  bool spoiled = false;  // a step ended in the middle, for want of memory
  void step_within_memory(World& world, double dt);
  /// As a new stepper, but for its settings and kernels, and what it told.
  void start_anew();

  void lap(Timer timer) {
    if (!settings.timings) return;
    const auto now = Clock::now();
    report.ms[std::size_t(timer)] += std::chrono::duration<double, std::milli>(now - began).count();
    began = now;
  }

  Detector::Options detection() const {
    return {settings.narrow,    settings.contact_margin, settings.restitution_threshold,
            settings.max_pairs, settings.lanes,          runner.workers()};
  }

  /// Plans are of the kernels of the host's own that there are, and so are the places that take part.
  Status follow_own(WorldState& s) {
    const Status ok = own.follow(s);
    if (own_seen == own.kernels().version()) return ok;
    own_seen = own.kernels().version();
    plans.clear();
    plan = nullptr;
    idle = {};
    runner.unbind();
    prepared.reset();
    return ok;
  }
  /// Compiles it where it is to run, while it can still be refused.
  Status check_kernel(const WorldState& s, const OwnKernel& kernel);

  double softened(const WorldState& s, double dt) const {
    return soft_substep_length(s.soft_substep, substep_length(dt, settings.substeps), dt);
  }
  /// What the next step is told of this one.
  void follow_step(WorldState& s, double dt) const {
    s.soft_substep = softened(s, dt);
    s.last_substep = substep_length(dt, settings.substeps);
  }

  const void* fill(const WorldState& s, double dt) {
    const double h = substep_length(dt, settings.substeps);
    const InfoInputs from(settings, s.gravity, h, s.last_substep, softened(s, dt), s.kinematic > 0);
    return infos.fill(s.tables.precision(), from, octaves_of(octaves.used()));
  }

  Status prepare(Precision precision) {
    prepared.reset();
    Status ok = runner.prepare(settings, precision, own.kernels());
    if (ok) prepared = precision;
    return ok;
  }

  /// Refuses what cannot be stepped, and asks the callbacks for their forces.
  Status make_ready(World& world, double dt) {
    WorldState& s = world.state();
    Status ok = check_dt(dt);
    if (ok) ok = follow_own(s);
    if (ok && !checked) ok = check_settings(settings);
    checked = bool(ok);
    if (ok && !(s.gravity == sound_gravity)) {
      ok = check_finite(s.gravity, "gravity of the world");
      if (ok) sound_gravity = s.gravity;
    }
    if (ok && prepared != s.tables.precision()) ok = prepare(s.tables.precision());
    if (ok) ok = called.ask(world);
    return ok;
  }

  Status step(World& world, double dt) {
    WorldState& s = world.state();
    Status ok = make_ready(world, dt);
    if (!ok) return ok;
    lap(Timer::forces);

    if (settings.sleep && idle.holds(s) && own.ordered().empty()) {
      plan = idle.plan;
      idle.report_to(report, s);
      follow_step(s, dt);  // as beside what does not sleep
      return {};
    }
    const FlushSubnormals flush;
    if (serial != s.serial) runner.forget();
    if (s.rests && !settings.sleep) {
      runner.keep(s, Buffer::rest);
      s.forget_rest();
    }
    detector.forget_strays();
    schedule.own.near.forget_strays();
    octaves.begin();
    tries = 0;
    watched = false;
    while (ok = attempt(s, dt), !ok || !outside.empty() || strayed || tighter || suspect || !written) {
      undo(s);
      if (!ok && (ran || ok.error().code != ErrorCode::not_finite)) return ok;
      report.repeats++;
      if (strayed || tighter) continue;
      // the step anew, to see which kernel of the host's own it came from, if one it was
      watched |= suspect;
      if (suspect) continue;
      if (!written) return written;
      // others may have met it: those that leave the range by themselves are to blame, where there are any
      find_leaving(s, schedule.moving_bodies(), dt, leaving);
      if (leaving.empty()) leaving = outside;
      if (leaving.empty()) return ok;
      keep_unfrozen(s);
      freeze(s);
    }
    unfrozen.drop();
    record_events(s);
    detector.let_go(s);
    if (settings.sleep) {
      runner.keep(s, Buffer::rest);
      let_sleep(s, dt);
    }
    ForceJumps::forget(own.ordered());
    recorder.follow_sleep(settings, s);
    runner.drop();
    detector.drop();
    return ok;
  }

  void record_events(const WorldState& s) {
    if (!EventRecorder::wanted(settings)) return;
    const AlignedBytes* poses =
        plan->flight && settings.body_events ? recorder.kept_poses() : runner.before(Buffer::pose);
    recorder.record(settings, s, {poses, detector}, schedule.moving_bodies());
  }

  /// The step was made: what is at rest may fall asleep.
  void let_sleep(WorldState& s, double dt) {
    // in flight some places keep none
    const AlignedBytes* before = plan->flight ? nullptr : runner.before(Buffer::pose);
    const std::span<const std::uint32_t> labels =
        finds_islands() ? schedule.islands.labels() : std::span<const std::uint32_t>();
    unrest.find(s, own.ordered(), runner);
    sleepers.disturb(unrest.rows(), unrest.together(own.ordered()));
    sleepers.follow(s, schedule.moving_bodies(), before, dt, settings, labels, report);
    unrest.stir_sleepers(s);
    if (s.sleepers == 0 || report.fell_asleep < schedule.moving || !own.ordered().empty() || s.callbacks > 0) return;
    update_structure(s);
    PlanSignature nothing = signature(settings, s, schedule);
    nothing.shapes = detector.possible();
    idle = {s, plans.find(nothing, own.ordered()), settings.substeps, report.islands_asleep};
  }

  /// What stands for several joints, whose own impulses are none.
  void write_solved(WorldState& s);
  void update_structure(WorldState& s);
  /// Whether the schedule is of the world's objects of now.
  bool is_scheduled(const WorldState& s) const;
  /// The world, and the schedule where it is of what the world is now.
  void walk_in_debug(WorldState& s) const;

  void update_contacts(const WorldState& s) {
    schedule.update_contacts(s, detector.standings());
    octaves.update_contacts(s, schedule.trees.nodes(), schedule.uneven);
    fourth.forget_contacts();
  }

  /// Which trees move in fourth order in a step of dt.
  void choose_order(FourthOrder& order, const WorldState& s, const TreeSlots& trees, double dt) const;

  void freeze(WorldState& s) {
    for (const std::uint32_t row : leaving) {
      report.frozen.push_back(s.body_ids.id<BodyId>(s.bodies[row].index));
      s.freeze(row);
    }
    std::ranges::sort(report.frozen);
  }

  /// Before a step that is made anew freezes, since it may fail after that: then it has frozen nobody.
  void keep_unfrozen(const WorldState& s);
  void unfreeze(WorldState& s);

  /// Bodies in flight that their kernel has left where they were: all others have made the step.
  void freeze_left(WorldState& s);

  /// Pairs and contacts. What sleeps and is stirred or touched wakes, and then has its contacts found, too.
  Status detect(WorldState& s, double dt, Detector::Found& found) {
    Status ok;
    report.woke = 0;
    const bool all = unrest.wakes_all(s, own.ordered());
    if (all || (s.sleepers > 0 && (scheduled_serial != s.serial || scheduled_rest != s.rest_version))) {
      runner.keep(s, Buffer::rest);
      report.woke = all ? sleepers.wake_all(s) : sleepers.wake_stirred(s);
    }
    while (true) {
      update_structure(s);
      if (ok = detector.find_pairs(s, dt, detection()); !ok) return ok;
      lap(Timer::broad);
      called.add(s, runner);
      if (ok = detector.find_contacts(s, detection(), found); !ok) return ok;
      lap(Timer::narrow);
      if (detector.touched().empty()) return {};
      runner.keep(s, Buffer::rest);
      report.woke += sleepers.wake_touched(s, detector.touched());
      detector.put_back(s);
    }
  }

  /// And order, of each island, in which kernels then go.
  void choose_substeps(WorldState& s, double dt, const Detector::Found& found) {
    choose_order(fourth, s, schedule.trees, dt);
    if (octaves.choose(s, schedule.trees.forest(), schedule.trees.nodes(), found.faces, fourth.trees(),
                       own.kernels().pairs_of_bodies(), settings, dt) ||
        other)
      schedule.group(octaves.of_bodies());
  }

  /// The whole step from pairs on, with the bodies that can move; which of them end outside of the range of numbers.
  Status attempt(WorldState& s, double dt) {
    Detector::Found found;
    outside.clear();
    strayed = tighter = suspect = ran = false;
    written = {};
    Status ok = detect(s, dt, found);
    if (!ok) return ok;
    if (found.changed) s.contacts_version++;  // whichever stepper comes next
    regrouped = other || contacts_version != s.contacts_version;
    if (regrouped) update_contacts(s);
    choose_substeps(s, dt, found);
    PlanSignature wanted = signature(settings, s, schedule);
    wanted.octaves = octaves.used();
    wanted.second_order = fourth.reasons();
    const double h = substep_length(dt, wanted.substeps);
    wanted.shapes = detector.possible();
    add_contacts(wanted, schedule, found);
    if (ok = order_own(s, dt, schedule); !ok) return ok;
    jumps.act(s, own.ordered(), schedule.moving_bodies(), h, dt, runner);
    if (other) s.tables.resize(Table::node, 1);
    remember(s);
    if (const std::uint32_t rows = schedule.trees.nodes().rows();
        (wanted.tree_contacts || wanted.tree_joints) && s.tables.rows(Table::node) != rows)
      s.tables.resize(Table::node, rows);
    if (wanted.touches && s.tables.rows(Table::touch) != s.contact_rows())
      s.tables.resize(Table::touch, s.contact_rows());
    list_islands(s, wanted);
    plan = &plans.find(wanted, own.ordered());
    if (ok = runner.bind(settings, *plan, s, schedule, wanted.shapes); !ok) return ok;
    lap(Timer::plan);

    if (plan->flight && settings.body_events) recorder.keep_poses(s);
    ran = true;
    runner.watch(watched);
    looks.look_with(detection());
    if (ok = runner.run(s, schedule, fill(s, dt), report, &looks); !ok) return ok;
    if (wanted.islands && !schedule.islands.take())
      return Error{ErrorCode::device_error,
                   "The device found no end of the islands of this world; find them on the CPU "
                   "(StepSettings::islands). The world "
                   "is as it was."};
    const AlignedBytes* before = runner.before(Buffer::pose);
    tighter = once_more(octaves.find_tighter(s, schedule.trees.forest(), before));
    if (tighter) return {};
    const bool left = plan->flight && runner.left();
    if (!plan->flight) find_outside(s, schedule.moving_bodies(), outside);
    if (own.hosts()) written = own.check_written(s);
    suspect = own.hosts() && !watched && (left || !outside.empty() || !written);
    if (suspect || !written) return {};
    if (!outside.empty()) return {};
    // what others sent further than it was looked for is looked for anew
    strayed = once_more(before && find_strays(s, *before));
    if (strayed) return {};
    if (left) freeze_left(s);
    follow_step(s, dt);
    if (s.settling > 0) s.settling--;
    tell(wanted, found);
    return {};
  }

  /// Of a step that was made.
  void tell(const PlanSignature& wanted, const Detector::Found& found);

  /// Whether a step that asks for it is made anew: most_tries times in all.
  bool once_more(bool asked) {
    if (!asked) return false;
    report.given_up = ++tries >= most_tries;
    return !report.given_up;
  }

  /// What the device is asked about islands, if it is.
  void list_islands(const WorldState& s, PlanSignature& wanted);
  bool finds_islands() const { return settings.sleep && settings.islands == Place::gl; }

  /// Who comes when in pair kernels and reductions.
  Status order_own(const WorldState& s, double dt, Schedule& of) const;
  bool find_strays(const WorldState& s, const AlignedBytes& before) {
    const bool near = own.kernels().cutoff() > 0 && schedule.own.near.find_strays(s, schedule.rows_that_move());
    return detector.find_strays(s, before) || near;
  }

  /// The world as it was: what the step wrote into its tables goes back, and the contacts are the last step's again.
  void undo(WorldState& s) {
    undone = true;
    runner.undo(s);
    s.count_rest();
    detector.put_back(s);
    s.tables.resize(Table::node, 0);  // nothing is pending, not in the row that pads either
    s.tables.resize(Table::node, 1);
    s.contacts_version++;
  }

  void remember(const WorldState& s) {
    serial = s.serial;
    contacts_version = s.contacts_version;
    other = false;
  }
};

}  // namespace pcphys
