#include "plan/left_out.h"

#include <algorithm>

#include "plan/fourth_order.h"

namespace pcphys {

void leave_out(const PlanSignature& s, OwnKernels::Ordered own, StepPlan& plan) {
  const auto out = [&](const char* what, const char* why) { plan.left_out.push_back({what, why}); };
  const bool idle = s.sleepers && !s.bodies;
  constexpr const char* all_sleep = "all bodies sleep";
  if (s.sleepers && s.bodies) out("sleeping islands", "they are at rest, and nothing has touched them");
  if (s.islands_known) out("islands", "contacts and joints are those of the step before");
  if (!s.bodies) out("integrate", idle ? all_sleep : "no body moves");
  if (s.bodies && !s.drag) out("drag", "no body has any");
  const bool seed = s.integrator == Integrator::seed;
  if (s.bodies && s.gyroscopic && seed) out("gyroscopic terms", "the original's scheme has none");
  if (s.bodies && !s.rotates) out("rotation", "no body rotates");
  if (s.bodies && !s.gyroscopic) out("gyroscopic terms", "every body has three equal moments of inertia");
  if (plan.flight) out("kernels of each sub-step", "nothing meets or holds a body: one makes all of its sub-steps");
  if (plan.flight && s.resident && s.places[std::size_t(Stage::integrate)] == Place::gl)
    out("downloads", "what a step leaves on the device comes when the host asks for it");
  if (!s.joints() && !s.trees && !s.nets)
    out("joints", idle ? all_sleep : s.sleepers ? "no body that is awake has any" : "the world has no joints");
  if (!s.joints() && s.trees) out("joint rows", "no joint closes a loop");
  if ((s.joints() || s.trees) && !s.nets && !s.tree_drives && !s.joint_drives)
    out("motors and springs", "no joint has any");
  if (s.trees && !s.pivots) out("pivots", "no body hangs on a fixed one by one pin alone");
  if (s.trees && !s.solves_trees()) out("tree solve", "every joint is a pin that one body turns about");
  if (s.trees && s.solves_trees() && !s.limits_after_contacts())
    out("limits after contacts", s.tree_limits ? "nothing touches what they hold" : "no joint of a tree has any");
  if (s.pivots_alone) out("free motion", "every body that moves turns about a pin");
  if (s.order == 4 && !s.trees) out("fourth order of joint trees", "the world has none");
  for (unsigned why = 0; why < unsigned(SecondOrder::count); why++)
    if (s.second_order >> why & 1) out(reason(SecondOrder(why))[0], reason(SecondOrder(why))[1]);
  if (!s.shapes) out("collision", "no two shapes could ever touch");
  if (s.shapes && idle) out("collision", all_sleep);
  if (!s.contacts())
    out("impulses", idle ? all_sleep : s.shapes ? "nothing touches in this step" : "no two shapes could ever touch");
  if (s.free_contacts && !s.gyroscopic) out("refreshed contacts", "every body has three equal moments of inertia");
  if (s.frictionless()) out("friction", "no contact has any");
  if (s.contacts() && !s.restitution) out("restitution", "no contact has a restitution above zero");
  if (s.contacts() && !s.rolling) out("rolling friction", "no material that touches has any");
  if (s.contacts() && !s.impacts) out("impacts", "nothing bounces, and no body flies into another");
  if (!s.sleep) out("sleeping", "the settings do not ask for it");
  if (!s.touches)
    out("events of contacts", s.contact_events ? "nothing touches in this step" : "the settings do not ask for them");
  if (!s.body_events) out("events of bodies", "the settings do not ask for them");
  if (std::ranges::all_of(own, [](const auto& k) { return k->of_library(); }))
    out("kernels of the host's own", "none was added");
}

}  // namespace pcphys
