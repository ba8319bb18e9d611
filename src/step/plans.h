// The plans of a stepper, by what its scene needs.
#pragma once
#include <deque>
#include <utility>

#include "collision/detector.h"
#include "events/event_recorder.h"
#include "pcphys/step.h"
#include "plan/own_kernels.h"
#include "plan/plan.h"
#include "step/schedule.h"
#include "world/state.h"

namespace pcphys {

/// What the objects of `schedule` need; contacts are for the caller to say.
inline PlanSignature signature(const StepSettings& settings, const WorldState& world, const Schedule& schedule) {
  PlanSignature s;
  s.substeps = settings.substeps;
  s.integrator = settings.integrator;
  s.order = settings.order;
  s.resident = settings.resident;
  s.sleep = settings.sleep;
  s.contact_events = EventRecorder::of_contacts(settings);
  s.body_events = settings.body_events;
  s.places = {settings.integrate, settings.joints, settings.impulses};
  s.bodies = schedule.moving > 0;
  s.sleepers = world.sleepers > 0;
  s.drag = schedule.drag;
  s.rotates = schedule.rotates;
  s.gyroscopic = schedule.gyroscopic;
  s.trees = schedule.trees.forest().trees() > 0;
  s.pivots = !schedule.trees.pivots().empty();
  s.pivots_alone = s.pivots && schedule.trees.pivots().size() == schedule.moving;
  s.pivots_bare = schedule.trees.bare_pivots();
  s.free_joints = schedule.joints.any_without_trees();
  s.tree_joints = schedule.joints.any_with_trees();
  s.tree_drives = schedule.trees.drives();
  s.tree_limits = schedule.trees.limits();
  s.nets = schedule.nets.nets().count() > 0;
  s.joint_drives = schedule.trees.closing_drives();
  return s;
}

/// And what touches.
inline void add_contacts(PlanSignature& s, const Schedule& schedule, const Detector::Found& found) {
  s.free_contacts = schedule.contacts.any_without_trees();
  s.tree_contacts = schedule.contacts.any_with_trees();
  s.friction = found.friction || found.rolling;
  s.restitution = found.restitution;
  s.visits = found.placed && s.free_contacts ? constants::rounds : 1;
  s.impacts = found.impacts;
  s.rolling = found.rolling;
  s.touches = s.contact_events && s.contacts();
}

/// Those seen, few; they stay where they are.
class Plans {
 public:
  const StepPlan& find(const PlanSignature& wanted, OwnKernels::Ordered own) {
    for (const auto& [signature, plan] : plans_)
      if (signature == wanted) return plan;
    return plans_.emplace_back(wanted, make_plan(wanted, own)).second;
  }
  void clear() { plans_.clear(); }

 private:
  std::deque<std::pair<PlanSignature, StepPlan>> plans_;
};

}  // namespace pcphys
