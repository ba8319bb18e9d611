// What a step's plan asks of the backends: calls, each of kernels that go together or of a transfer.
#include <algorithm>

#include "plan/island_class.h"
#include "step/domains.h"
#include "step/entries.h"
#include "step/runner.h"

namespace pcphys {

std::uint32_t Runner::lanes(Place place, Domain domain, const Schedule& schedule) {
  return at(place).backend->width_for(domain, side_by_side(domain, schedule));
}

/// Rows that stand need not be made, and what has no impact no look at one: on the host such runs go over the blocks of
/// the others. Where joints have sent nothing together, runs that are for what they have are left out on any place.
void Runner::narrow(const PlanEntry& entry) {
  using To = Narrowed::To;
  if (entry.own) return;
  const bool on_host = entry.place == Place::cpu;
  const auto add = [&](To to) { narrowed_.push_back({std::uint32_t(runs_.size()) - 1, to, {}}); };
  if (on_host && strikes(entry.kernel)) return add(To::struck);
  if (on_host && prepares(entry.kernel) && entry.phase != Phase::first) return add(To::renewed);
  if (entry.phase == Phase::sent) add(To::all_or_none);
}

/// Empty ranges are left out, and those that need not follow one another are joined.
void Runner::add_run(const PlanEntry& entry, const WorldState& state, const Schedule& schedule) {
  if (entry.own) return add_own(entry, state, schedule);
  const KernelSchema& k = schema(entry.kernel);
  const bool coloured = needs_colours(entry.kernel);
  const std::size_t first = ranges_.size();
  for (const Range& range : ranges_of(k.domain, schedule, entry.octave)) {
    if (range.begin == range.end) continue;
    if (!coloured && ranges_.size() > first && ranges_.back().end == range.begin)
      ranges_.back().end = range.end;
    else
      ranges_.push_back(range);
  }
  // where they stand is known when all are there
  runs_.push_back({entry.kernel,
                   entry.barrier || entry.again > 0,
                   std::uint32_t(info_index(entry)),
                   lanes(entry.place, k.domain, schedule),
                   {static_cast<const Range*>(nullptr), ranges_.size() - first}});
}

void Runner::add_own(const PlanEntry& entry, const WorldState& state, const Schedule& schedule) {
  const std::size_t first = ranges_.size();
  const OwnKernel& k = *entry.own;
  if (k.form == OwnKernel::Form::reduction)
    ranges_.push_back(k.table == Table::body    ? Range{0, schedule.own.movable}
                      : k.table == Table::joint ? Range{0, state.tables.rows(k.table) - 1}
                                                : Range{1, state.tables.rows(k.table)});
  else if (k.form == OwnKernel::Form::joined)
    ranges_.insert(ranges_.end(), {schedule.own.joined_range(entry.octave), schedule.ranges(entry.octave)[0]});
  else if (k.table == Table::body)
    for (const Range& range : schedule.ranges(entry.octave)) ranges_.push_back(range);
  else
    ranges_.push_back({1, state.tables.rows(k.table)});
  runs_.push_back({Kernel::begin,
                   entry.barrier,
                   std::uint32_t(info_index(entry)),
                   1,
                   {static_cast<const Range*>(nullptr), ranges_.size() - first},
                   &k,
                   state.tables.rows(k.table) - 1});
}

void Runner::prepare_calls(const StepPlan& plan, bool timings, bool strays, const WorldState& state,
                           const Schedule& schedule) {
  calls_.clear();
  runs_.clear();
  ranges_.clear();
  narrowed_.clear();
  const PlanEntry* before = nullptr;
  std::size_t collides = 0;  // the call
  for (const PlanEntry& entry : plan.entries) {
    const bool kernel = entry.kind == PlanEntry::Kind::kernel;
    const bool clocked = timings && before && (timer_of(*before) != timer_of(entry) || before->place != entry.place);
    if (clocked) calls_.back().last = true;
    const bool traced = traces() && before && ends_substep(*before, entry);
    if (traced) calls_.back().ends = true;
    const bool joins = kernel && !traced && before && before->kind == PlanEntry::Kind::kernel &&
                       before->place == entry.place && before->again == 0 && entry.again == 0 && !clocked &&
                       !plan.flight && !(gl_ && entry.place == Place::cpu);
    if (!joins) calls_.push_back({&entry, std::uint32_t(runs_.size()), 0, false});
    if (entry.kind == PlanEntry::Kind::collide) {
      collides = calls_.size() - 1;
      calls_.back().narrowed = std::uint32_t(narrowed_.size());
    }
    if (kernel) {
      add_run(entry, state, schedule);
      calls_.back().count++;
      narrow(entry);
      if (!narrowed_.empty())
        calls_[collides].narrowed_count = std::uint32_t(narrowed_.size()) - calls_[collides].narrowed;
    }
    before = &entry;
  }
  if (!calls_.empty()) calls_.back().last = timings;
  std::size_t first = 0;
  for (KernelRun& run : runs_) {
    run.ranges = std::span(ranges_).subspan(first, run.ranges.size());
    first += run.ranges.size();
  }
  for (Narrowed& n : narrowed_) n.all = runs_[n.run].ranges;
  unsigned octave = 0;
  for (const PlanEntry& entry : plan.entries) octave = std::max(octave, octave_of(entry.octave));
  infos_ = phase_count * (1 + octave);
  may_be_undone_ = std::ranges::any_of(plan.own, [](const auto& k) { return !k->of_library(); });
  kept_.clear();
  if (plan.flight && !gl_ && !strays && plan.own.empty()) return;  // nothing of it can fail
  for (const Buffer buffer : plan.overwritten)
    if (keeps(buffer)) kept_.push_back(buffer);
}

}  // namespace pcphys
