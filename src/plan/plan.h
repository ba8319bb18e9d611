// Builds the step plan from what a world needs.
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "pcphys/plan.h"
#include "plan/own_kernels.h"
#include "world/schema.h"

namespace pcphys {

/// Everything a plan depends on.
struct PlanSignature {
  std::uint32_t substeps = 4;
  std::uint32_t octaves = 1;       // bit k: some island is of class k (plan/island_class.h)
  std::uint32_t order = 2;         // StepSettings::order
  std::uint32_t second_order = 0;  // of order 4, why some trees are not: bits by SecondOrder
  Integrator integrator = Integrator::verlet;
  bool resident = false;  // StepSettings::resident
  bool sleep = false;     // and what else it asks for
  bool contact_events = false;
  bool body_events = false;
  std::array<Place, stage_count> places{};  // by Stage
  bool bodies = false;                      // some move
  bool sleepers = false;                    // some sleep
  bool drag = false;                        // of some body
  bool rotates = true;                      // some body does (BodyDef::rotates)
  bool gyroscopic = false;                  // some body has unequal moments
  bool trees = false;                       // joints that stand in a tree
  bool pivots = false;                      // trees of one body that turns about its pin
  bool pivots_alone = false;                // and no other body moves
  bool pivots_bare = false;                 // every tree is one, and no limit, motor or spring acts on it
  bool free_joints = false;                 // joints that close a loop, of bodies whose trees do not answer
  bool tree_joints = false;                 // and of bodies whose trees do
  bool tree_drives = false;                 // motors or springs of joints that stand in a tree
  bool tree_limits = false;                 // limits of their angles
  bool joint_drives = false;                // of others, or springs between two points
  bool nets = false;                        // springs between points of bodies that no pin holds
  bool shapes = false;                      // some pair could ever touch
  bool free_contacts = false;               // some do in this step, of bodies that stand in no tree
  bool tree_contacts = false;               // and of bodies that do
  bool friction = false;                    // some contact resists sliding, rolling or turning
  bool restitution = false;                 // some contact bounces
  unsigned visits = 1;                      // in a pass; more while some body that was just placed settles
  bool impacts = false;                     // or is between shapes that meet in flight
  bool rolling = false;                     // some contact resists rolling, or turning about its normal
  bool touches = false;                     // the host asks for events of contacts, and there are contacts
  bool islands = false;                     // a device is to say who is in which island
  bool islands_known = false;               // or has said it
  bool joints() const { return free_joints || tree_joints; }
  bool contacts() const { return free_contacts || tree_contacts; }
  /// Nothing that touches has friction, and no tree answers it: rows end where those of friction would begin.
  bool frictionless() const { return free_contacts && !tree_contacts && !friction; }
  /// Pins of pivots that nothing else acts on have nothing to solve.
  bool solves_trees() const { return trees && (!pivots_bare || tree_contacts || tree_joints); }
  /// Contacts and loops may turn joints of trees over their limits.
  bool limits_after_contacts() const { return tree_limits && (tree_contacts || tree_joints); }
  friend bool operator==(const PlanSignature&, const PlanSignature&) = default;
};

/// Whether each body moves by itself: nothing holds or meets it, and no kernel of the host's own looks
/// at it between sub-steps.
bool in_flight(const PlanSignature& signature, OwnKernels::Ordered own);

/// `own`: kernels of the host's own, in the order in which those of one moment run.
StepPlan make_plan(const PlanSignature& signature, OwnKernels::Ordered own = {});

/// Of a kernel, the library's or the host's own.
std::span<const Access> accesses(const PlanEntry& entry);
Stage stage(const PlanEntry& entry);

}  // namespace pcphys
