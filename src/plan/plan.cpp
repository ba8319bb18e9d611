#include "plan/plan.h"

#include <algorithm>

#include "pcphys/constants.h"
#include "plan/fourth_order.h"
#include "plan/island_class.h"
#include "plan/left_out.h"
#include "plan/own_kernels.h"
#include "plan/plan_builder.h"

namespace pcphys {
namespace {

/// The kernels that move bodies between impulses.
struct Motion {
  Kernel begin, integrate, advance, synchronise, restagger;
};
Motion motion(const PlanSignature& s) {
  const Kernel round = s.rotates ? Kernel::advance_round : Kernel::advance_still;  // the same in every scheme
  if (s.integrator == Integrator::seed)
    return {Kernel::begin_seed, s.drag ? Kernel::integrate_seed : Kernel::integrate,
            s.gyroscopic ? Kernel::advance_seed : round, Kernel::synchronise_seed,
            Kernel::restagger};  // one octave alone
  const Kernel advance = s.gyroscopic ? Kernel::advance : round;
  if (s.drag)
    return {Kernel::begin_drag, Kernel::integrate_drag, advance, Kernel::synchronise_drag, Kernel::restagger_drag};
  return {Kernel::begin, Kernel::integrate, advance, Kernel::synchronise, Kernel::restagger};
}

/// The kernels of contacts that bodies answer.
struct Contacts {
  Kernel prepare, refresh, impact, recall, warm, solve, placed, restitution, touch, store;
};
Contacts contacts(const PlanSignature& s) {
  if (s.frictionless())
    return {Kernel::contact_prepare_frictionless,      Kernel::contact_refresh_frictionless,
            Kernel::contact_impact_frictionless,       Kernel::contact_recall_frictionless,
            Kernel::contact_warm_frictionless,         Kernel::contact_solve_frictionless,
            Kernel::contact_solve_placed_frictionless, Kernel::contact_restitution_frictionless,
            Kernel::contact_touch_frictionless,        Kernel::contact_store_frictionless};
  return {Kernel::contact_prepare, Kernel::contact_refresh, Kernel::contact_impact,       Kernel::contact_recall,
          Kernel::contact_warm,    Kernel::contact_solve,   Kernel::contact_solve_placed, Kernel::contact_restitution,
          Kernel::contact_touch,   Kernel::contact_store};
}

// what acts on trees first: the floor under what lies on them comes later (see Colouring)
void solve_on_trees(PlanBuilder& b, const PlanSignature& s, Phase phase, std::uint32_t substep) {
  if (s.tree_joints && phase == Phase::relax) b.kernel(Kernel::tree_joint_arms, phase, substep);
  if (s.tree_joints)
    b.kernel(s.joint_drives ? Kernel::tree_joint_solve_driven : Kernel::tree_joint_solve, phase, substep);
  if (s.tree_contacts) b.kernel(Kernel::tree_contact_solve, phase, substep);
  if (s.tree_joints || s.tree_contacts) b.kernel(Kernel::tree_flush, phase, substep);
}
// before the forces, and before the first sub-step brings velocities out of phase
void look_at_drives(PlanBuilder& b, const PlanSignature& s, Phase phase, std::uint32_t substep) {
  if (s.tree_drives) b.kernel(Kernel::tree_drive_rates, phase, substep);
  if (s.joint_drives) b.kernel(Kernel::joint_drives, phase, substep);
}
// of the poses that a sub-step begins with; forces do not change them
void look_at_inertia(PlanBuilder& b, const PlanSignature& s, std::uint32_t substep) {
  if (s.joints() || s.solves_trees() || s.contacts()) b.kernel(Kernel::inertia, Phase::biased, substep);
}
/// Which act in the sub-step, and where; in the sent phase, which of limbs that contacts
/// and joints have sent elsewhere.
void look_at_contacts(PlanBuilder& b, const PlanSignature& s, Phase phase, std::uint32_t substep) {
  if (!s.contacts()) return;
  b.collide(phase, substep);
  b.kernel(contacts(s).prepare, phase, substep);
}
void solve_free_joints(PlanBuilder& b, const PlanSignature& s, Phase phase, std::uint32_t substep) {
  if (s.free_joints) b.kernel(s.joint_drives ? Kernel::joint_solve_driven : Kernel::joint_solve, phase, substep);
}
void solve_contacts(PlanBuilder& b, const PlanSignature& s, Phase phase, std::uint32_t substep) {
  solve_on_trees(b, s, phase, substep);
  if (s.free_contacts) b.kernel(contacts(s).solve, phase, substep);
  for (unsigned visit = 1; s.free_contacts && visit < s.visits; visit++) b.kernel(contacts(s).placed, phase, substep);
}

/// What contacts remember acts on each body by a share.
void recall(PlanBuilder& b, const PlanSignature& s, std::uint32_t substep) {
  if (!s.contacts()) return;
  b.kernel(contacts(s).recall, Phase::biased, substep);
  if (s.tree_contacts) b.kernel(Kernel::tree_recall, Phase::biased, substep);
  b.kernel(Kernel::recall_share, Phase::biased, substep);
}

/// The warm starts: what contacts and joints are expected to hold.
void warm_start(PlanBuilder& b, const PlanSignature& s, std::uint32_t k, std::uint32_t count) {
  // both come before either solve: joints that do not yet feel the contacts' load over-correct
  if (s.joints()) b.kernel(Kernel::joint_prepare, k == 0 ? Phase::first : Phase::biased, k);
  if (s.free_joints) b.kernel(Kernel::joint_warm, Phase::biased, k);
  b.own(Stage::impulses, false, k, count);
  if (s.free_contacts && s.gyroscopic) b.kernel(contacts(s).refresh, Phase::biased, k);
  // before what lasts of the contacts acts again: an impact is between velocities that bodies have
  if (s.free_contacts && s.impacts) {
    b.kernel(contacts(s).impact, Phase::biased, k);
    b.kernel(contacts(s).impact, Phase::relax, k, constants::rounds - 1);
  }
  recall(b, s, k);
  if (s.free_contacts) b.kernel(contacts(s).warm, Phase::biased, k);
  if (s.tree_joints) b.kernel(Kernel::tree_joint_warm, Phase::biased, k);
  if (s.tree_contacts) b.kernel(Kernel::tree_contact_warm, Phase::biased, k);
  if (s.tree_joints || s.tree_contacts) b.kernel(Kernel::tree_collect, Phase::biased, k);
  if (s.contacts() && s.rolling) b.kernel(Kernel::contact_rolling, Phase::biased, k);
}

/// The solves with a push towards where joints and contacts should be.
void solve_biased(PlanBuilder& b, const PlanSignature& s, std::uint32_t k, std::uint32_t count) {
  solve_free_joints(b, s, Phase::biased, k);
  if (s.nets) b.kernel(Kernel::net_prepare, Phase::biased, k);
  if (s.nets) b.kernel(Kernel::net_solve, Phase::biased, k);
  if (s.solves_trees()) b.kernel(s.tree_drives ? Kernel::tree_solve_driven : Kernel::tree_solve, Phase::biased, k);
  if (s.tree_joints || s.tree_contacts) b.kernel(Kernel::tree_respond, Phase::biased, k);
  if (s.tree_joints) b.kernel(Kernel::tree_answer, Phase::biased, k);
  if (s.tree_joints)
    b.kernel(s.joint_drives ? Kernel::tree_joint_mass_driven : Kernel::tree_joint_mass, Phase::biased, k);
  if (s.tree_contacts) b.kernel(Kernel::tree_contact_prepare, Phase::biased, k);
  b.own(Stage::joints, true, k, count);
  solve_contacts(b, s, Phase::biased, k);
  if (s.tree_contacts) {
    look_at_contacts(b, s, Phase::sent, k);
    b.kernel(Kernel::tree_contact_prepare, Phase::sent, k);
    b.kernel(Kernel::tree_contact_solve, Phase::sent, k);
    b.kernel(Kernel::tree_flush, Phase::sent, k);
  }
  if (s.nets && s.contacts()) b.kernel(Kernel::net_solve, Phase::biased, k);
  if (s.tree_contacts) b.kernel(Kernel::tree_contact_push, Phase::push, k);
  if (s.tree_contacts) b.kernel(Kernel::tree_flush, Phase::push, k);
  if (s.limits_after_contacts())
    b.kernel(s.tree_drives ? Kernel::tree_limits_driven : Kernel::tree_limits, Phase::biased, k);
  if (s.solves_trees()) b.kernel(Kernel::tree_again, Phase::biased, k);
}

/// A sub-step; `count`: of how many.
void substep(PlanBuilder& b, const PlanSignature& s, const Motion& with, std::uint32_t k, std::uint32_t count) {
  if (k > 0) b.own(Stage::integrate, false, k, count);
  // pivots go on from the momentum of before; the last change of velocities is that of the last sub-step
  if (s.pivots || (k + 1 == count && s.integrator != Integrator::seed)) b.kernel(Kernel::remember, Phase::biased, k);
  if (k > 0) look_at_drives(b, s, Phase::biased, k);
  b.kernel(with.integrate, Phase::biased, k);
  if (k > 0 && s.rotates) look_at_inertia(b, s, k);
  look_at_contacts(b, s, k == 0 ? Phase::first : Phase::biased, k);
  b.own(Stage::integrate, true, k, count);
  b.own(Stage::joints, false, k, count);
  if (s.tree_contacts && k == 0) b.kernel(Kernel::push_back, Phase::first, k);
  if (s.trees) b.kernel(Kernel::tree_prepare, k == 0 ? Phase::first : Phase::biased, k);
  if (s.tree_drives) b.kernel(Kernel::tree_drives, Phase::biased, k);
  warm_start(b, s, k, count);
  solve_biased(b, s, k, count);
  if (s.pivots) b.kernel(Kernel::pivot_turn, Phase::biased, k);
  if (!s.pivots_alone) b.kernel(with.advance, Phase::biased, k);
  if (s.pivots) b.kernel(Kernel::pivot_settle, Phase::biased, k);
  if (s.nets) b.kernel(Kernel::net_settle, Phase::biased, k);
  if (s.solves_trees()) b.kernel(Kernel::tree_relax, Phase::relax, k);
  if (s.tree_contacts) b.kernel(Kernel::push_back, Phase::relax, k);
  solve_free_joints(b, s, Phase::relax, k);
  if (s.free_contacts && s.gyroscopic) b.kernel(contacts(s).refresh, Phase::relax, k);
  if (s.contacts() && s.rolling) b.kernel(Kernel::contact_rolling, Phase::relax, k);
  solve_contacts(b, s, Phase::relax, k);
  b.own(Stage::impulses, true, k, count, false);
}

/// All sub-steps of bodies in flight, which no kernel needs to look at in between.
void fly(PlanBuilder& b, const PlanSignature& s) {
  const std::uint32_t last = s.substeps - 1;
  b.enter(0);
  b.own(Stage::integrate, false, 0, s.substeps);
  const Kernel still = s.drag ? Kernel::fly_still_drag : Kernel::fly_still;
  const Kernel round = s.drag ? Kernel::fly_round_drag : Kernel::fly_round,
               any = s.drag ? Kernel::fly_drag : Kernel::fly;
  b.kernel(!s.rotates ? still : s.gyroscopic ? any : round, Phase::first, 0);
  b.own(Stage::impulses, true, last, s.substeps, true);
}

/// Where nothing moves the host's own kernels have their sub-steps all the same.
void own_alone(PlanBuilder& b, const PlanSignature& s) {
  for (std::uint32_t k = 0; k < s.substeps; k++)
    for (const Stage stage : {Stage::integrate, Stage::joints, Stage::impulses})
      for (const bool after : {false, true}) b.own(stage, after, k, s.substeps);
}

/// All sub-steps of the islands of an octave.
void substeps(PlanBuilder& b, const PlanSignature& s, std::uint8_t octave) {
  const Motion with = motion(s);
  const std::uint32_t count = s.substeps << octave, last = count - 1;
  b.enter(octave);
  b.own(Stage::integrate, false, 0, count);  // what it makes of forces is of the step's start
  look_at_drives(b, s, Phase::first, 0);
  b.kernel(with.begin, Phase::first, 0);
  look_at_inertia(b, s, 0);
  for (std::uint32_t k = 0; k < count; k++) substep(b, s, with, k, count);
  if (s.free_contacts && s.restitution) b.kernel(contacts(s).restitution, Phase::relax, last);
  if (s.contacts() && s.touches) b.kernel(contacts(s).touch, Phase::relax, last);
  if (s.contacts()) b.kernel(contacts(s).store, Phase::last, last);
  b.kernel(with.synchronise, Phase::relax, last);
  if (octave > 0) {
    // what is remembered is of the world's sub-step, whatever the octave of the next step
    b.kernel(with.restagger, Phase::last, last);
    if (s.joints()) b.kernel(Kernel::joint_keep, Phase::last, last);
    if (s.trees) b.kernel(Kernel::tree_keep, Phase::last, last);
  }
  b.own(Stage::impulses, true, last, count, true);
}

/// All sub-steps of the islands of an octave that move in fourth order: joint trees alone,
/// and nothing else acts on them.
void smooth_substeps(PlanBuilder& b, const PlanSignature& s, unsigned octave) {
  const std::uint32_t count = s.substeps << octave, last = count - 1;
  b.enter(std::uint8_t(octave_count + octave));
  b.kernel(Kernel::smooth_prepare, Phase::biased, 0);
  for (std::uint32_t k = 0; k < count; k++) b.kernel(Kernel::smooth_step, k == 0 ? Phase::first : Phase::biased, k);
  if (octave == 0) return;
  b.kernel(motion(s).restagger, Phase::last, last);
  b.kernel(Kernel::tree_keep, Phase::last, last);
}

/// Who is in which island: rounds of label propagation until no label falls.
void label_islands(PlanBuilder& b, const StepPlan& plan) {
  const std::uint32_t last = plan.entries.empty() ? 0 : plan.entries.back().substep;
  b.enter(0);
  b.kernel(Kernel::island_start, Phase::last, last);
  b.kernel(Kernel::island_join, Phase::last, last);
  b.kernel(Kernel::island_join, Phase::last, last, constants::most_island_rounds);
  b.bring_home(Buffer::island_labels);
}

}  // namespace

std::span<const Access> accesses(const PlanEntry& entry) {
  if (entry.kind == PlanEntry::Kind::collide) return collide_accesses;
  return entry.own ? std::span<const Access>(entry.own->accesses) : schema(entry.kernel).accesses;
}
Stage stage(const PlanEntry& entry) { return entry.own ? entry.own->stage : schema(entry.kernel).stage; }

bool in_flight(const PlanSignature& s, OwnKernels::Ordered own) {
  const bool alone = !s.trees && !s.joints() && !s.nets && !s.contacts();
  return s.bodies && alone && s.octaves == 1 && s.integrator == Integrator::verlet &&
         std::ranges::all_of(own, [](const auto& k) {
           return k->form == OwnKernel::Form::reduction ||
                  (k->once_a_step && (k->after ? k->stage == Stage::impulses : k->stage == Stage::integrate));
         });
}

StepPlan make_plan(const PlanSignature& s, OwnKernels::Ordered own) {
  StepPlan plan;
  plan.substeps = s.substeps;
  plan.own.assign(own.begin(), own.end());
  plan.flight = in_flight(s, own);
  leave_out(s, own, plan);
  if (!s.bodies && own.empty() && !s.islands) return plan;
  PlanBuilder b(s, own, plan);
  if (!s.bodies) own_alone(b, s);
  if (plan.flight) fly(b, s);
  for (std::uint8_t octave = 0; s.bodies && !plan.flight && octave < octave_count; octave++)
    if (s.octaves >> octave & 1) substeps(b, s, octave);
  for (unsigned octave = 0; s.bodies && octave < octave_count; octave++)
    if (s.octaves >> (octave_count + octave) & 1) smooth_substeps(b, s, octave);
  b.totals();
  if (s.islands) label_islands(b, plan);
  if (!plan.entries.empty()) b.results(plan.entries.back().substep);
  return plan;
}

}  // namespace pcphys
