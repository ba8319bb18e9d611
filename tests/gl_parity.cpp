// Pins the contract of the whole library, kernel by kernel: the same text gives the same bits as scalar C++,
// as SIMD lanes and as GLSL, in float and double. Covered: static and kinematic bodies, padding slots,
// zero vectors, colours, trees of several shapes (free, and hanging from what is fixed), locked and infinite
// limits, contacts and joints of trees with themselves, each other and the rest, many turns, small and large values.
// On a device that cannot round exactly (see `pcphys doctor`) parity is not promised, and this test says so.
#include "gl_parity.h"

#include <utility>

#include "pcphys/device.h"

namespace {
using namespace parity;

/// A sub-step and what stands around it, in the order of a step; the same kernel runs in both phases.
struct Call {
  Kernel kernel;
  std::size_t info;
};
constexpr Call step_calls[] = {
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
constexpr Call last_calls[] = {
    {Kernel::contact_restitution, 1}, {Kernel::contact_touch, 1}, {Kernel::contact_store, 1}, {Kernel::synchronise, 1},
    {Kernel::restagger, 1},           {Kernel::joint_keep, 1},    {Kernel::tree_keep, 1}};
constexpr Call drag_calls[] = {{Kernel::begin_drag, 0},    {Kernel::integrate_drag, 0},   {Kernel::remember, 0},
                               {Kernel::advance_round, 0}, {Kernel::synchronise_drag, 1}, {Kernel::restagger_drag, 1}};
constexpr Call seed_calls[] = {
    {Kernel::begin_seed, 0}, {Kernel::integrate_seed, 0}, {Kernel::advance_seed, 0}, {Kernel::synchronise_seed, 1}};

constexpr Call flight_calls[] = {
    {Kernel::fly, 0},       {Kernel::fly_round, 0},      {Kernel::fly_drag, 0},     {Kernel::fly_round_drag, 0},
    {Kernel::fly_still, 0}, {Kernel::fly_still_drag, 0}, {Kernel::advance_still, 0}};

constexpr Call frictionless_calls[] = {{Kernel::inertia, 0},
                                       {Kernel::contact_prepare_frictionless, 0},
                                       {Kernel::contact_refresh_frictionless, 0},
                                       {Kernel::contact_impact_frictionless, 0},
                                       {Kernel::contact_warm_frictionless, 0},
                                       {Kernel::contact_solve_frictionless, 0},
                                       {Kernel::contact_solve_placed_frictionless, 0},
                                       {Kernel::contact_refresh_frictionless, 1},
                                       {Kernel::contact_solve_frictionless, 1},
                                       {Kernel::contact_restitution_frictionless, 1},
                                       {Kernel::contact_touch_frictionless, 1},
                                       {Kernel::contact_store_frictionless, 1}};

constexpr Call smooth_calls[] = {{Kernel::smooth_prepare, 0}, {Kernel::smooth_step, 0}, {Kernel::smooth_step, 0}};

/// The kernel that stands in where joints have motors or springs.
Kernel driven(Kernel kernel) {
  if (kernel == Kernel::tree_solve) return Kernel::tree_solve_driven;
  if (kernel == Kernel::tree_joint_mass) return Kernel::tree_joint_mass_driven;
  if (kernel == Kernel::tree_joint_solve) return Kernel::tree_joint_solve_driven;
  return kernel == Kernel::joint_solve ? Kernel::joint_solve_driven : kernel;
}

bool closes_loops(Kernel kernel) { return schema(kernel).domain == Domain::tree_joint; }

/// The sub-steps but the last with motors and springs.
std::vector<Call> calls(int sub_steps) {
  std::vector<Call> all;
  for (int i = 0; i < sub_steps; i++)
    for (const Call& call : step_calls) all.push_back({i + 1 < sub_steps ? driven(call.kernel) : call.kernel, call.info});
  all.insert(all.end(), std::begin(last_calls), std::end(last_calls));
  all.insert(all.end(), std::begin(drag_calls), std::end(drag_calls));
  all.insert(all.end(), std::begin(seed_calls), std::end(seed_calls));
  return all;
}

/// What runs one after the other: of second order, and from the start of fourth where trees turn by no more than it is for.
std::vector<std::vector<Call>> sequences(const Mood& mood) {
  std::vector<std::vector<Call>> all{calls(3),
                                     {std::begin(flight_calls), std::end(flight_calls)},
                                     {std::begin(frictionless_calls), std::end(frictionless_calls)}};
  if (mood.tree_spin < 50) all.emplace_back(std::begin(smooth_calls), std::end(smooth_calls));
  return all;
}

template <class Scalar> State<Scalar> made(const Mood& mood) {
  State<Scalar> state = Maker<Scalar>(8, mood).make();
  state.reals[std::size_t(Buffer::contact_reach)].resize(lay_out_reach(state, 1).size * schema(Buffer::contact_reach).reals);
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

template <class Scalar> void compare_gl(Precision precision, const CpuKernels& reference) {
  const GlReport report = probe_gl(-1);
  MESSAGE("device: " << report.renderer << ", " << report.version);
  REQUIRE_MESSAGE((precision == Precision::f64 ? report.f64 : report.f32).parity(), "this device promises no parity");
  const std::unique_ptr<Backend> gl = require_gl(precision);
  const auto with = [&](GlTeam wanted) {
    const GlTeam before = std::exchange(gl_team(), wanted);
    std::unique_ptr<Backend> made = require_gl(precision);
    gl_team() = before;
    return made;
  };
  const std::unique_ptr<Backend> alone = with({1}), shared = with({32}), scattered = with({32, true});
  const auto compare_trees = [&](Backend& at, const char* what) {
    compare<Scalar>(reference, what, [&](Kernel kernel, std::size_t info, State<Scalar>& state) {
      if (of_trees(schema(kernel).domain))
        run_gl(at, 1, kernel, info, state);
      else
        run_cpu(reference, kernel, info, state);
    });
  };
  compare<Scalar>(reference, "GL",
                  [&](Kernel kernel, std::size_t info, State<Scalar>& state) { run_gl(*gl, gl->width(), kernel, info, state); });
  // as trees of few of a shape stand: trees of several shapes side by side in one work group, and one shared by a group; what a barrier
  // parts is the same in both precisions
  compare_trees(*alone, "GL, a tree a block");
  compare_trees(*shared, "GL, a tree a work group");
  if (precision == Precision::f32) compare_trees(*scattered, "GL, a tree a work group in another order");
}

template <class Scalar> void compare_lanes(const CpuKernels& reference, const CpuKernels& lanes) {
  const std::string what = std::to_string(lanes.lanes) + " lanes";
  compare<Scalar>(reference, what.c_str(),
                  [&](Kernel kernel, std::size_t info, State<Scalar>& state) { run_cpu(lanes, kernel, info, state); });
}

}  // namespace

TEST_CASE("GL equals scalar float, kernel by kernel") { compare_gl<float>(Precision::f32, cpu_kernels_f1); }
TEST_CASE("GL equals scalar double, kernel by kernel") { compare_gl<double>(Precision::f64, cpu_kernels_d1); }

#ifdef PCPHYS_HAVE_X86_LANES
TEST_CASE("four lanes of float equal scalar") { compare_lanes<float>(cpu_kernels_f1, cpu_kernels_f4); }
TEST_CASE("eight lanes of float equal scalar") {
  if (__builtin_cpu_supports("avx2")) compare_lanes<float>(cpu_kernels_f1, cpu_kernels_f8);
}
TEST_CASE("eight lanes of float with AVX-512 equal scalar") {
  if (has_avx512()) compare_lanes<float>(cpu_kernels_f1, cpu_kernels_f8v);
}
TEST_CASE("four lanes of double equal scalar") {
  if (__builtin_cpu_supports("avx2")) compare_lanes<double>(cpu_kernels_d1, cpu_kernels_d4);
}
#endif

/// The comparison itself must be able to fail: the contents are neither empty nor constant, and no value
/// has left the numbers (not-a-number spreads, and compares as equal).
TEST_CASE("the contents that parity is checked on move, and stay numbers") {
  for (const Mood& mood : moods) {
    State<float> state = made<float>(mood);
    std::string first;
    for (const Call& call : calls(3)) {
      if (!mood.loops && closes_loops(call.kernel)) continue;
      const State<float> before = state;
      run_cpu(cpu_kernels_f1, call.kernel, call.info, state);
      const std::string where = std::string(schema(call.kernel).name) + ", " + mood.name;
      INFO(where);
      CHECK(differences(call.kernel, before, state, first) > 100);
      for (std::size_t b = 0; b < buffer_count; b++) {
        const std::vector<float>& reals = state.reals[b];
        // free angles of coloured joints are infinite
        const bool infinite =
            Buffer(b) == Buffer::joint_frame || Buffer(b) == Buffer::joint_solved || Buffer(b) == Buffer::joint_rows;
        const auto is_bad = [&](float x) { return infinite ? x != x : !std::isfinite(x); };
        const std::ptrdiff_t bad = std::find_if(reals.begin(), reals.end(), is_bad) - reals.begin();
        const std::ptrdiff_t row = std::max(1, int(schema(Buffer(b)).reals));
        INFO(std::string(schema(Buffer(b)).name) << " row " << bad / row << " real " << bad % row);
        CHECK(bad == std::ptrdiff_t(reals.size()));
      }
    }
  }
}
