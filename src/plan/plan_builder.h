// Puts a plan's entries together, in the order in which they are asked for.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "pcphys/plan.h"
#include "plan/own_kernels.h"
#include "plan/plan.h"
#include "world/own_properties.h"
#include "world/schema.h"

namespace pcphys {

/// Of Detector::meet.
inline constexpr Access collide_accesses[] = {{Buffer::pose, false},
                                              {Buffer::motion, false},
                                              {Buffer::mass, false},
                                              {Buffer::delta, false},
                                              {Buffer::contact, true}};

/// Adds kernels to a plan, with the transfers and barriers that their declared accesses ask for.
class PlanBuilder {
 public:
  PlanBuilder(const PlanSignature& signature, OwnKernels::Ordered own, StepPlan& plan)
      : signature_(signature), own_(own), plan_(plan) {
    std::size_t count = buffer_count;
    for (const auto& k : own)
      for (const Access& a : k->accesses) count = std::max(count, std::size_t(a.buffer) + 1);
    buffers_.resize(count);
    for (const auto& k : own)
      for (const OwnArgument& a : k->arguments)
        if (a.of_property() && a.property.starts_with(own_prefix)) at(a.buffer).of_library = true;
    for (Known& b : buffers_) b.current[std::size_t(Place::cpu)] = true;
    at(Buffer::island_labels).current[std::size_t(Place::gl)] = true;  // its kernels begin anew
  }

  /// The kernels that follow are for islands of this octave.
  void enter(std::uint8_t octave) { octave_ = octave; }

  /// `again`: PlanEntry::again.
  void kernel(Kernel kernel, Phase phase, std::uint32_t substep, std::uint32_t again = 0) {
    const KernelSchema& k = schema(kernel);
    const Place place = k.stage == Stage::islands ? Place::gl : signature_.places[std::size_t(k.stage)];
    add({PlanEntry::Kind::kernel, place, kernel, {}, phase, false, substep, octave_, nullptr, again}, k.accesses,
        k.domain);
  }

  /// The narrow phase of a sub-step, on the host: Detector::meet.
  void collide(Phase phase, std::uint32_t substep) {
    for (const Access& a : collide_accesses) bring(a.buffer, Place::cpu, substep);
    plan_.entries.push_back({PlanEntry::Kind::collide, Place::cpu, {}, {}, phase, false, substep, octave_, nullptr, 0});
    for (const Access& a : collide_accesses) {
      if (!a.write) continue;
      overwrite(a.buffer);
      at(a.buffer).current = {true, false};
      at(a.buffer).host_wrote = true;
    }
  }

  /// The host's own kernels of a moment of the step, in a sub-step of `count`.
  void own(Stage stage, bool after, std::uint32_t substep, std::uint32_t count, bool once_a_step) {
    for (const auto& k : own_) {
      if (k->stage != stage || k->after != after || k->once_a_step != once_a_step) continue;
      if (k->form == OwnKernel::Form::reduction) continue;
      if (once_a_step && substep != (after ? count - 1 : 0)) continue;
      // rows that are no bodies are of no octave, but for joints with theirs
      const bool of_bodies = k->table == Table::body || k->form == OwnKernel::Form::joined;
      if (!of_bodies && octave_ != std::countr_zero(signature_.octaves)) continue;
      add(*k, substep);
    }
  }
  /// Those that make one value of all rows, when the step is made.
  void totals() {
    enter(0);
    for (const auto& k : own_)
      if (k->form == OwnKernel::Form::reduction) add(*k, plan_.entries.empty() ? 0 : plan_.entries.back().substep);
  }
  void own(Stage stage, bool after, std::uint32_t substep, std::uint32_t count) {
    own(stage, after, substep, count, true);
    own(stage, after, substep, count, false);
  }

  /// What the host is to know of it when the step is made.
  void bring_home(Buffer buffer) { bring(buffer, Place::cpu, plan_.entries.back().substep); }

  void results(std::uint32_t substep) {
    for (std::size_t b = 0; b < buffers_.size(); b++)
      if (is_result(Buffer(b)))
        leave(Buffer(b)) ? plan_.left_there.push_back(Buffer(b)) : bring(Buffer(b), Place::cpu, substep);
  }

 private:
  struct Known {
    std::array<bool, 2> current{}, bound{};  // by Place
    bool written = false, read = false;      // on GL since the last barrier
    bool host_wrote = false, own_wrote = false, overwritten = false;
    bool of_library = false;  // a column of the library's beside those of the host's own: of one step
  };
  Known& at(Buffer buffer) { return buffers_[std::size_t(buffer)]; }
  /// What the host reads after a step: every buffer that holds state, or that events are made of, or that the host's
  /// own kernels wrote; and of what both sides wrote the last version, since the next step begins with the host's.
  bool is_result(Buffer b) const {
    const Known& known = buffers_[std::size_t(b)];
    if (!of_table(b) || known.of_library) return false;
    return is_own(b) || holds(b, Role::state) || b == Buffer::touch || known.host_wrote || known.own_wrote;
  }
  static bool is_rows(Buffer b) { return !of_table(b) && schema(b).reals > 0; }

  /// Whether the device may keep it.
  bool leave(Buffer b) const {
    return plan_.flight && signature_.resident && !is_own(b) &&
           !buffers_[std::size_t(b)].current[std::size_t(Place::cpu)];
  }

  void add(const OwnKernel& k, std::uint32_t substep) {
    Place place = signature_.places[std::size_t(k.stage)];
    if (k.body.empty()) place = Place::cpu;
    if (!k.in_cpp()) place = Place::gl;
    add({PlanEntry::Kind::kernel, place, {}, {}, Phase::biased, false, substep, octave_, &k, 0}, k.accesses,
        Domain::body);
  }
  void add(PlanEntry entry, std::span<const Access> accesses, Domain domain) {
    const Place place = entry.place;
    for (const Access& a : accesses) {
      if (!is_rows(a.buffer)) bring(a.buffer, place, entry.substep);
      entry.barrier |= place == Place::gl && (at(a.buffer).written || (a.write && at(a.buffer).read));
    }
    if (entry.barrier) settle();
    plan_.entries.push_back(entry);
    for (const Access& a : accesses) {
      Known& known = at(a.buffer);
      if (!std::exchange(known.bound[std::size_t(place)], true)) plan_.bindings.push_back({place, a.buffer, domain});
      if (place == Place::gl) (a.write ? known.written : known.read) = true;
      if (!a.write) continue;
      if (place == Place::cpu) overwrite(a.buffer);
      known.current[0] = place == Place::cpu;
      known.current[1] = place == Place::gl;
      known.host_wrote |= place == Place::cpu;
      known.own_wrote |= entry.own != nullptr;
    }
  }

  void bring(Buffer buffer, Place place, std::uint32_t substep) {
    bool& here = at(buffer).current[std::size_t(place)];
    if (here) return;
    here = true;
    const auto kind = place == Place::gl ? PlanEntry::Kind::upload : PlanEntry::Kind::download;
    plan_.entries.push_back({kind,
                             place,
                             {},
                             buffer,
                             Phase::biased,
                             kind == PlanEntry::Kind::download,
                             substep,
                             octave_,
                             user_of(buffer),
                             0});
    if (kind == PlanEntry::Kind::upload) return;
    overwrite(buffer);
    settle();
  }
  const OwnKernel* user_of(Buffer buffer) const {
    for (const auto& k : own_)
      for (const Access& a : k->accesses)
        if (a.buffer == buffer && is_own(buffer)) return k.get();
    return nullptr;
  }
  void overwrite(Buffer buffer) {
    if (of_table(buffer) && !std::exchange(at(buffer).overwritten, true)) plan_.overwritten.push_back(buffer);
  }
  void settle() {
    for (Known& b : buffers_) b.written = b.read = false;
  }

  const PlanSignature& signature_;
  OwnKernels::Ordered own_;
  StepPlan& plan_;
  std::uint8_t octave_ = 0;
  std::vector<Known> buffers_;  // by Buffer
};

}  // namespace pcphys
