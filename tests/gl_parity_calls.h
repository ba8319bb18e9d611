// The kernels of a step in their order, run by the scalar reference and by another, and compared after each.
#pragma once
#include "gl_parity.h"
#include "pcphys/device.h"

namespace parity {

/// A sub-step and what stands around it, in the order of a step; the same kernel runs in both phases.
struct Call {
  Kernel kernel;
  std::size_t info;
};
inline constexpr Call step_calls[] = {
    {Kernel::begin, 0},
    {Kernel::inertia, 0},
    {Kernel::contact_prepare, 0},
    {Kernel::tree_drive_rates, 0},
    {Kernel::joint_drives, 0},
    {Kernel::integrate, 0},
    {Kernel::tree_prepare, 0},
    {Kernel::tree_drives, 0},
    {Kernel::joint_prepare, 0},
    {Kernel::joint_warm, 0},
    {Kernel::joint_solve, 0},
    {Kernel::contact_refresh, 0},
    {Kernel::contact_recall, 0},
    {Kernel::tree_recall, 0},
    {Kernel::recall_share, 0},
    {Kernel::contact_recall, 0},  // nothing has moved since: all of it acts, and what comes after is no less a test
    {Kernel::recall_share, 0},
    {Kernel::contact_warm, 0},
    {Kernel::tree_joint_warm, 0},
    {Kernel::tree_contact_warm, 0},
    {Kernel::tree_collect, 0},
    {Kernel::tree_solve, 0},
    {Kernel::tree_respond, 0},
    {Kernel::tree_answer, 0},
    {Kernel::tree_joint_mass, 0},
    {Kernel::tree_contact_prepare, 0},
    {Kernel::tree_joint_solve, 0},
    {Kernel::tree_contact_solve, 0},
    {Kernel::tree_flush, 0},
    {Kernel::contact_solve, 0},
    {Kernel::tree_limits, 0},
    {Kernel::tree_again, 0},
    {Kernel::remember, 0},
    {Kernel::pivot_turn, 0},
    {Kernel::advance, 0},
    {Kernel::pivot_settle, 0},
    {Kernel::tree_relax, 1},
    {Kernel::contact_refresh, 1},
    {Kernel::joint_solve, 1},
    {Kernel::tree_joint_arms, 1},
    {Kernel::tree_joint_solve, 1},
    {Kernel::tree_contact_solve, 1},
    {Kernel::tree_flush, 1},
    {Kernel::contact_solve, 1},
};
inline constexpr Call last_calls[] = {
    {Kernel::contact_restitution, 1}, {Kernel::contact_touch, 1}, {Kernel::contact_store, 1}, {Kernel::synchronise, 1},
    {Kernel::restagger, 1},           {Kernel::joint_keep, 1},    {Kernel::tree_keep, 1}};
inline constexpr Call drag_calls[] = {{Kernel::begin_drag, 0},       {Kernel::integrate_drag, 0},
                                      {Kernel::remember, 0},         {Kernel::advance_round, 0},
                                      {Kernel::synchronise_drag, 1}, {Kernel::restagger_drag, 1}};
inline constexpr Call seed_calls[] = {
    {Kernel::begin_seed, 0}, {Kernel::integrate_seed, 0}, {Kernel::advance_seed, 0}, {Kernel::synchronise_seed, 1}};

inline constexpr Call flight_calls[] = {
    {Kernel::fly, 0},       {Kernel::fly_round, 0},      {Kernel::fly_drag, 0},     {Kernel::fly_round_drag, 0},
    {Kernel::fly_still, 0}, {Kernel::fly_still_drag, 0}, {Kernel::advance_still, 0}};

inline constexpr Call frictionless_calls[] = {{Kernel::inertia, 0},
                                              {Kernel::contact_prepare_frictionless, 0},
                                              {Kernel::contact_refresh_frictionless, 0},
                                              {Kernel::contact_impact_frictionless, 0},
                                              {Kernel::contact_recall_frictionless, 0},
                                              {Kernel::recall_share, 0},
                                              {Kernel::contact_recall_frictionless, 0},
                                              {Kernel::recall_share, 0},
                                              {Kernel::contact_warm_frictionless, 0},
                                              {Kernel::contact_solve_frictionless, 0},
                                              {Kernel::contact_solve_placed_frictionless, 0},
                                              {Kernel::contact_refresh_frictionless, 1},
                                              {Kernel::contact_solve_frictionless, 1},
                                              {Kernel::contact_restitution_frictionless, 1},
                                              {Kernel::contact_touch_frictionless, 1},
                                              {Kernel::contact_store_frictionless, 1}};

inline constexpr Call smooth_calls[] = {
    {Kernel::smooth_prepare, 0}, {Kernel::smooth_step, 0}, {Kernel::smooth_step, 0}};

/// The kernel that stands in where joints have motors or springs.
inline Kernel driven(Kernel kernel) {
  if (kernel == Kernel::tree_solve) return Kernel::tree_solve_driven;
  if (kernel == Kernel::tree_limits) return Kernel::tree_limits_driven;
  if (kernel == Kernel::tree_joint_mass) return Kernel::tree_joint_mass_driven;
  if (kernel == Kernel::tree_joint_solve) return Kernel::tree_joint_solve_driven;
  return kernel == Kernel::joint_solve ? Kernel::joint_solve_driven : kernel;
}

inline bool closes_loops(Kernel kernel) { return schema(kernel).domain == Domain::tree_joint; }

/// The sub-steps but the last with motors and springs.
inline std::vector<Call> calls(int sub_steps) {
  std::vector<Call> all;
  for (int i = 0; i < sub_steps; i++)
    for (const Call& call : step_calls)
      all.push_back({i + 1 < sub_steps ? driven(call.kernel) : call.kernel, call.info == 0 && i > 0 ? 2 : call.info});
  all.insert(all.end(), std::begin(last_calls), std::end(last_calls));
  all.insert(all.end(), std::begin(drag_calls), std::end(drag_calls));
  all.insert(all.end(), std::begin(seed_calls), std::end(seed_calls));
  return all;
}

/// What runs one after the other: of second order, and from the start of fourth where trees turn by no more than it is
/// for.
inline std::vector<std::vector<Call>> sequences(const Mood& mood) {
  std::vector<std::vector<Call>> all{calls(3),
                                     {std::begin(flight_calls), std::end(flight_calls)},
                                     {std::begin(frictionless_calls), std::end(frictionless_calls)}};
  if (mood.tree_spin < 50) all.emplace_back(std::begin(smooth_calls), std::end(smooth_calls));
  return all;
}

template <class Scalar> State<Scalar> made(const Mood& mood) {
  State<Scalar> state = Maker<Scalar>(8, mood).make();
  state.reals[std::size_t(Buffer::contact_reach)].resize(lay_out_reach(state, 1).size *
                                                         schema(Buffer::contact_reach).reals);
  return state;
}

/// Each kernel starts from the scalar reference's state, so a difference names the kernel that made it.
template <class Scalar, class Other> void compare(const CpuKernels& reference, const char* what, Other other) {
  for (const Mood& mood : moods)
    for (const std::vector<Call>& sequence : sequences(mood)) {
      State<Scalar> state = made<Scalar>(mood);
      for (const Call& call : sequence) {
        if (!mood.loops && closes_loops(call.kernel)) continue;
        State<Scalar> theirs = state;
        run_cpu(reference, call.kernel, call.info, state);
        other(call.kernel, call.info, theirs);
        std::string first;
        const std::size_t count = differences(call.kernel, state, theirs, first);
        const std::string where =
            std::string(what) + ", " + std::string(schema(call.kernel).name) + ", " + mood.name + ": " + first;
        INFO(where);
        CHECK(count == 0);
      }
    }
}

/// Ends the test on a device that promises no parity.
inline void require_parity(Precision precision) {
  const GlReport report = probe_gl(-1);
  MESSAGE("device: " << report.renderer << ", " << report.version);
  REQUIRE_MESSAGE((precision == Precision::f64 ? report.f64 : report.f32).parity(), "this device promises no parity");
}
template <class Scalar> void compare_gl(Precision precision, const CpuKernels& reference) {
  require_parity(precision);
  const std::unique_ptr<Backend> gl = require_gl(precision);
  compare<Scalar>(reference, "GL", [&](Kernel kernel, std::size_t info, State<Scalar>& state) {
    run_gl(*gl, gl->width(), kernel, info, state);
  });
}

}  // namespace parity
