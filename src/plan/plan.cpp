#include "plan/plan.h"

#include <utility>

#include "pcphys/constants.h"

namespace pcphys {
namespace {

/// Adds kernels to a plan, with the transfers and barriers that their declared accesses ask for.
class Builder {
 public:
  Builder(const PlanSignature& signature, StepPlan& plan) : signature_(signature), plan_(plan) {
    for (std::size_t b = 0; b < buffer_count; b++) current_[b][std::size_t(Place::cpu)] = true;
  }

  /// The kernels that follow are for islands of this octave.
  void enter(std::uint8_t octave) { octave_ = octave; }

  /// `again`: PlanEntry::again.
  void kernel(Kernel kernel, Phase phase, std::uint32_t substep, std::uint32_t again = 0) {
    const KernelSchema& k = schema(kernel);
    const Place place = signature_.places[std::size_t(k.stage)];
    bool barrier = false;
    for (const Access& a : k.accesses) {
      if (!is_rows(a.buffer)) bring(a.buffer, place, substep);
      barrier |= place == Place::gl && (written_[std::size_t(a.buffer)] || (a.write && read_[std::size_t(a.buffer)]));
    }
    if (barrier) settle();
    plan_.entries.push_back({PlanEntry::Kind::kernel, place, kernel, {}, phase, barrier, substep, octave_, again});
    for (const Access& a : k.accesses) {
      if (!std::exchange(bound_[std::size_t(a.buffer)][std::size_t(place)], true))
        plan_.bindings.push_back({place, a.buffer, k.domain});
      if (place == Place::gl) (a.write ? written_ : read_)[std::size_t(a.buffer)] = true;
      if (!a.write) continue;
      if (place == Place::cpu) overwrite(a.buffer);
      current_[std::size_t(a.buffer)][0] = place == Place::cpu;
      current_[std::size_t(a.buffer)][1] = place == Place::gl;
      host_wrote_[std::size_t(a.buffer)] |= place == Place::cpu;
    }
  }

  /// What the host reads after a step: every buffer that holds state; and of what both sides wrote the last version, since
  /// the next step begins with the host's.
  void results(std::uint32_t substep) {
    for (std::size_t b = 0; b < table_buffer_count; b++)
      if (holds(Buffer(b), Role::state) || host_wrote_[b]) bring(Buffer(b), Place::cpu, substep);
  }

 private:
  static bool is_rows(Buffer b) { return b >= Buffer::table_buffers && schema(b).reals > 0; }

  void bring(Buffer buffer, Place place, std::uint32_t substep) {
    bool& here = current_[std::size_t(buffer)][std::size_t(place)];
    if (here) return;
    here = true;
    const auto kind = place == Place::gl ? PlanEntry::Kind::upload : PlanEntry::Kind::download;
    plan_.entries.push_back({kind, place, {}, buffer, Phase::biased, kind == PlanEntry::Kind::download, substep, octave_});
    if (kind == PlanEntry::Kind::upload) return;
    overwrite(buffer);
    settle();
  }
  void overwrite(Buffer buffer) {
    if (buffer < Buffer::table_buffers && !std::exchange(overwritten_[std::size_t(buffer)], true))
      plan_.overwritten.push_back(buffer);
  }
  void settle() {
    written_.fill(false);
    read_.fill(false);
  }

  const PlanSignature& signature_;
  StepPlan& plan_;
  std::uint8_t octave_ = 0;
  std::array<std::array<bool, 2>, buffer_count> current_{};  // by Place
  std::array<bool, buffer_count> written_{}, read_{};        // on GL since the last barrier
  std::array<bool, buffer_count> host_wrote_{}, overwritten_{};
  std::array<std::array<bool, 2>, buffer_count> bound_{};  // by Place
};

void leave_out(const PlanSignature& s, StepPlan& plan) {
  const auto out = [&](const char* what, const char* why) { plan.left_out.push_back({what, why}); };
  if (!s.bodies) out("integrate", "no body moves");
  if (s.bodies && !s.drag) out("drag", "no body has any");
  const bool seed = s.integrator == Integrator::seed;
  if (s.bodies && s.gyroscopic && seed) out("gyroscopic terms", "the original's scheme has none");
  if (s.bodies && !s.gyroscopic) out("gyroscopic terms", "every body has three equal moments of inertia");
  if (!s.joints() && !s.trees) out("joints", "the world has no joints");
  if (!s.joints() && s.trees) out("joint rows", "no joint closes a loop");
  if ((s.joints() || s.trees) && !s.tree_drives && !s.joint_drives) out("motors and springs", "no joint has any");
  if (s.trees && !s.pivots) out("pivots", "no body hangs on a fixed one by one pin alone");
  if (s.trees && !s.solves_trees()) out("tree solve", "every joint is a pin that one body turns about");
  if (s.pivots_alone) out("free motion", "every body that moves turns about a pin");
  if (!s.shapes) out("collision", "no two shapes could ever touch");
  if (!s.contacts()) out("impulses", s.shapes ? "nothing touches in this step" : "no two shapes could ever touch");
  if (s.free_contacts && !s.gyroscopic) out("refreshed contacts", "every body has three equal moments of inertia");
  if (s.contacts() && !s.restitution) out("restitution", "no contact has a restitution above zero");
  if (s.contacts() && !s.rolling) out("rolling friction", "no material that touches has any");
  if (s.contacts() && !s.impacts) out("impacts", "nothing bounces, and no body flies into another");
}

/// The kernels that move bodies between impulses.
struct Motion {
  Kernel begin, integrate, advance, synchronise, restagger;
};
Motion motion(const PlanSignature& s) {
  const Kernel round = Kernel::advance_round;  // the same in every scheme
  if (s.integrator == Integrator::seed)
    return {Kernel::begin_seed, s.drag ? Kernel::integrate_seed : Kernel::integrate, s.gyroscopic ? Kernel::advance_seed : round,
            Kernel::synchronise_seed, Kernel::restagger};  // one octave alone
  const Kernel advance = s.gyroscopic ? Kernel::advance : round;
  if (s.drag) return {Kernel::begin_drag, Kernel::integrate_drag, advance, Kernel::synchronise_drag, Kernel::restagger_drag};
  return {Kernel::begin, Kernel::integrate, advance, Kernel::synchronise, Kernel::restagger};
}

// what acts on trees first: the floor under what lies on them comes later (see Colouring)
void solve_on_trees(Builder& b, const PlanSignature& s, Phase phase, std::uint32_t substep) {
  if (s.tree_joints && phase == Phase::relax) b.kernel(Kernel::tree_joint_arms, phase, substep);
  if (s.tree_joints) b.kernel(s.joint_drives ? Kernel::tree_joint_solve_driven : Kernel::tree_joint_solve, phase, substep);
  if (s.tree_contacts) b.kernel(Kernel::tree_contact_solve, phase, substep);
  if (s.tree_joints || s.tree_contacts) b.kernel(Kernel::tree_flush, phase, substep);
}
// before the forces, and before the first sub-step brings velocities out of phase
void look_at_drives(Builder& b, const PlanSignature& s, Phase phase, std::uint32_t substep) {
  if (s.tree_drives) b.kernel(Kernel::tree_drive_rates, phase, substep);
  if (s.joint_drives) b.kernel(Kernel::joint_drives, phase, substep);
}
// of the poses that a sub-step begins with; forces do not change them
void look_at_inertia(Builder& b, const PlanSignature& s, std::uint32_t substep) {
  if (s.joints() || s.solves_trees() || s.contacts()) b.kernel(Kernel::inertia, Phase::biased, substep);
}
void solve_free_joints(Builder& b, const PlanSignature& s, Phase phase, std::uint32_t substep) {
  if (s.free_joints) b.kernel(s.joint_drives ? Kernel::joint_solve_driven : Kernel::joint_solve, phase, substep);
}
void solve_contacts(Builder& b, const PlanSignature& s, Phase phase, std::uint32_t substep) {
  solve_on_trees(b, s, phase, substep);
  if (s.free_contacts) b.kernel(Kernel::contact_solve, phase, substep);
}

/// A sub-step; `count`: of how many.
void substep(Builder& b, const PlanSignature& s, const Motion& with, std::uint32_t k, std::uint32_t count) {
  // pivots go on from the momentum of before; the last change of velocities is that of the last sub-step
  if (s.pivots || (k + 1 == count && s.integrator != Integrator::seed)) b.kernel(Kernel::remember, Phase::biased, k);
  if (k > 0) look_at_drives(b, s, Phase::biased, k);
  b.kernel(with.integrate, Phase::biased, k);
  if (k > 0) look_at_inertia(b, s, k);
  if (s.trees) b.kernel(Kernel::tree_prepare, k == 0 ? Phase::first : Phase::biased, k);
  if (s.tree_drives) b.kernel(Kernel::tree_drives, Phase::biased, k);
  // both warm starts come before either solve: joints that do not yet feel the contacts' load over-correct
  if (s.joints()) b.kernel(Kernel::joint_prepare, k == 0 ? Phase::first : Phase::biased, k);
  if (s.free_joints) b.kernel(Kernel::joint_warm, Phase::biased, k);
  if (s.free_contacts && s.gyroscopic) b.kernel(Kernel::contact_refresh, Phase::biased, k);
  // before what lasts of the contacts acts again: an impact is between velocities that bodies have
  if (s.free_contacts && s.impacts) {
    b.kernel(Kernel::contact_impact, Phase::biased, k);
    b.kernel(Kernel::contact_impact, Phase::relax, k, constants::impact_sweeps - 1);
  }
  if (s.free_contacts) b.kernel(Kernel::contact_warm, Phase::biased, k);
  if (s.tree_joints) b.kernel(Kernel::tree_joint_warm, Phase::biased, k);
  if (s.tree_contacts) b.kernel(Kernel::tree_contact_warm, Phase::biased, k);
  if (s.tree_joints || s.tree_contacts) b.kernel(Kernel::tree_collect, Phase::biased, k);
  if (s.contacts() && s.rolling) b.kernel(Kernel::contact_rolling, Phase::biased, k);
  solve_free_joints(b, s, Phase::biased, k);
  if (s.solves_trees()) b.kernel(s.tree_drives ? Kernel::tree_solve_driven : Kernel::tree_solve, Phase::biased, k);
  if (s.tree_joints || s.tree_contacts) b.kernel(Kernel::tree_respond, Phase::biased, k);
  if (s.tree_joints) b.kernel(Kernel::tree_answer, Phase::biased, k);
  if (s.tree_joints) b.kernel(s.joint_drives ? Kernel::tree_joint_mass_driven : Kernel::tree_joint_mass, Phase::biased, k);
  if (s.tree_contacts) b.kernel(Kernel::tree_contact_prepare, Phase::biased, k);
  solve_contacts(b, s, Phase::biased, k);
  if (s.solves_trees()) b.kernel(Kernel::tree_again, Phase::biased, k);
  if (s.pivots) b.kernel(Kernel::pivot_turn, Phase::biased, k);
  if (!s.pivots_alone) b.kernel(with.advance, Phase::biased, k);
  if (s.pivots) b.kernel(Kernel::pivot_settle, Phase::biased, k);
  if (s.solves_trees()) b.kernel(Kernel::tree_relax, Phase::relax, k);
  solve_free_joints(b, s, Phase::relax, k);
  if (s.free_contacts && s.gyroscopic) b.kernel(Kernel::contact_refresh, Phase::relax, k);
  if (s.contacts() && s.rolling) b.kernel(Kernel::contact_rolling, Phase::relax, k);
  solve_contacts(b, s, Phase::relax, k);
}

/// All sub-steps of the islands of an octave.
void substeps(Builder& b, const PlanSignature& s, std::uint8_t octave) {
  const Motion with = motion(s);
  const std::uint32_t count = s.substeps << octave, last = count - 1;
  b.enter(octave);
  look_at_drives(b, s, Phase::first, 0);
  b.kernel(with.begin, Phase::first, 0);
  look_at_inertia(b, s, 0);
  if (s.contacts()) b.kernel(Kernel::contact_prepare, Phase::first, 0);
  for (std::uint32_t k = 0; k < count; k++) substep(b, s, with, k, count);
  if (s.contacts() && s.restitution) b.kernel(Kernel::contact_restitution, Phase::relax, last);
  if (s.contacts()) b.kernel(Kernel::contact_store, Phase::last, last);
  b.kernel(with.synchronise, Phase::relax, last);
  if (octave == 0) return;
  // what is remembered is of the world's sub-step, whatever the octave of the next step
  b.kernel(with.restagger, Phase::last, last);
  if (s.joints()) b.kernel(Kernel::joint_keep, Phase::last, last);
  if (s.trees) b.kernel(Kernel::tree_keep, Phase::last, last);
}

}  // namespace

StepPlan make_plan(const PlanSignature& s) {
  StepPlan plan;
  plan.substeps = s.substeps;
  leave_out(s, plan);
  if (!s.bodies) return plan;
  Builder b(s, plan);
  for (std::uint8_t octave = 0; octave < octave_count; octave++)
    if (s.octaves >> octave & 1) substeps(b, s, octave);
  b.results(plan.entries.back().substep);
  return plan;
}

}  // namespace pcphys
