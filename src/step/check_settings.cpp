#include "step/check_settings.h"

#include <cmath>
#include <string>

#include "collision/hook.h"
#include "cpu/workers.h"
#include "pcphys/constants.h"
#include "plan/octaves.h"
#include "world/validate.h"

namespace pcphys {

Status check_settings(const StepSettings& s) {
  if (s.substeps < 1 || s.substeps > most_substeps)
    return Error{ErrorCode::bad_time_step,
                 "The number of sub-steps is " + std::to_string(s.substeps) + "; it must lie between 1 and 1000."};
  if (s.order != 2 && s.order != 4)
    return Error{ErrorCode::bad_argument,
                 "The order is " + std::to_string(s.order) + "; it must be 2, or 4 for joint trees."};
  if (s.order == 4 && s.integrator == Integrator::seed)
    return Error{ErrorCode::bad_argument,
                 "The original's scheme (seed) is of first order; use the order 2 with it, or verlet."};
  for (const Place place : {s.integrate, s.joints, s.impulses, s.islands})
    if (place > Place::gl)
      return Error{ErrorCode::bad_argument, "A stage is put on no known place; use Place::cpu or gl."};
  if (s.integrator > Integrator::seed)
    return Error{ErrorCode::bad_argument, "The integrator is none that there is; use Integrator::verlet or seed."};
  if (s.narrow > NarrowPhase::fcl)
    return Error{ErrorCode::bad_argument, "The narrow phase is none that there is; use NarrowPhase::native or fcl."};
  if (Status ok = Workers::check(s.threads); !ok) return ok;
  if (s.refinement < 1 || s.refinement > most_substeps)
    return Error{ErrorCode::bad_argument, "The refinement of islands is " + std::to_string(s.refinement) +
                                              "; it must lie between 1 (never) and 1000."};
  for (double x : {s.push_speed, s.restitution_threshold, s.contact_margin})
    if (!std::isfinite(x) || x < 0)
      return Error{ErrorCode::bad_argument,
                   "Push speed, restitution threshold and contact margin must be finite and not below zero."};
  if (!std::isfinite(s.hit_speed) || s.hit_speed < 0)
    return Error{ErrorCode::bad_argument,
                 "The speed of hits is " + number(s.hit_speed) + " m/s; it must be finite and not below zero."};
  for (double x : {s.sleep_speed, s.sleep_spin, s.sleep_time})
    if (!std::isfinite(x) || x < 0 || s.sleep_time == 0)
      return Error{
          ErrorCode::bad_argument,
          "Speed and spin below which islands sleep must be finite and not below zero, the time after which they do "
          "finite and above zero."};
  if (s.lanes != 0 && s.lanes != 1 && s.lanes != 4 && s.lanes != 8)
    return Error{ErrorCode::unavailable,
                 "There are no kernels of " + std::to_string(s.lanes) +
                     " lanes; use 1, 4, 8 (float only), or 0 for the widest that the processor has."};
  if (s.narrow == NarrowPhase::fcl && !fcl_hook())
    return Error{
        ErrorCode::unavailable,
        "FCL is not in use: link pcphys::fcl and call pcphys::use_fcl() (libfcl-dev, a build with it), or use the "
        "native narrow phase."};
  return {};
}

Status check_dt(double dt) {
  if (dt >= constants::shortest_step && dt <= constants::longest_step) return {};
  if (std::isfinite(dt) && dt > 0)
    return Error{ErrorCode::bad_time_step, "The time step is " + number(dt) + " s; it must lie between " +
                                               number(constants::shortest_step) + " and " +
                                               number(constants::longest_step) + " s. The world is as it was."};
  return Error{ErrorCode::bad_time_step, "The time step is " + std::to_string(dt) +
                                             " s; it must be finite and above zero. The world is as it was."};
}

}  // namespace pcphys
