// pcphys_threads: steps in several threads, and worlds in threads of their own, give the bits of one thread. Under the
// thread sanitizer (preset threads) it also says whether any two of them touch the same memory at once.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "pcphys/pcphys.h"
#include "pcphys/write_kernel.h"

#ifdef PCPHYS_WATCHED_THREADS
/// Atomics that the library of oneTBB hands from thread to thread (src/cpu/workers.cpp); where an access of ours stands
/// on top it is told. The names of inlined functions stand in full debug info alone, so this preset has it.
extern "C" const char* __tsan_default_suppressions() {
  return "race_top:std::__atomic_base\nrace_top:std::atomic<tbb::\n";
}
#endif

using namespace pcphys;

namespace {

PCPHYS_KERNEL(cool, (PC_IN(Vec3) displacement_rate, PC_INOUT(Real) heat, PC_PARAM(Real) rate), {
  Real lost = pc_length(displacement_rate) * rate;
  heat = heat - lost;
})
PCPHYS_PAIR_KERNEL(pull,
                   (PC_SELF(Vec3) position, PC_OTHER(Vec3) position_other, PC_ADD(Vec3) force, PC_PARAM(Real) strength),
                   {
                     Vec3 way = pc_sub(position_other, position);
                     precise Real square = pc_dot(way, way) + PC_REAL(1.0);
                     force = pc_scale(way, pc_div(strength, square));
                   })
PCPHYS_KERNEL(stretch, (PC_A(Vec3) position_a, PC_B(Vec3) position_b, PC_ADD_A(Vec3) force_a, PC_ADD_B(Vec3) force_b), {
  Vec3 way = pc_sub(position_b, position_a);
  force_a = pc_scale(way, PC_REAL(0.1));
  force_b = pc_negate(force_a);
})
PCPHYS_KERNEL(add_up, (PC_IN(Real) heat, PC_SUM(Real) total), { total = heat; })

template <class T> T must(Result<T> result) {
  if (!result) std::puts(result.error().message.c_str()), std::exit(1);
  return *std::move(result);
}
void must(const Status& status) {
  if (!status) std::puts(status.error().message.c_str()), std::exit(1);
}

/// Piles on a floor, more than a piece of any loop, and ragdolls that fall on them; with properties and kernels of the
/// host's own.
struct Scene {
  World world;
  Stepper stepper;

  Scene(Precision precision, std::uint32_t threads, bool own)
      : world(WorldDef{precision, {}}),
        stepper({.substeps = 2, .threads = threads, .sleep = true, .contact_events = true}) {
    add_piles();
    for (int i = 0; i < 6; i++) (void)must(world.create_ragdoll(RagdollDef::human(), {{3.0 * i, 6, 1}, {}}));
    if (own) add_kernels();
  }
  std::uint64_t run(int steps) {
    for (int i = 0; i < steps; i++)
      if (const StepReport& report = stepper.step(world, 1.0 / 60); !report) must(Status(report.error));
    return world.hash();
  }

 private:
  void add_piles() {
    BodyDef floor, body;
    floor.kind = BodyKind::fixed;
    floor.shapes = {ShapeDef::plane()};
    (void)must(world.create_body(floor));
    const Hull wedge = must(make_hull(std::array<Vec3, 6>{Vec3{-0.3, 0, -0.3}, Vec3{0.3, 0, -0.3}, Vec3{0.3, 0, 0.3},
                                                          Vec3{-0.3, 0, 0.3}, Vec3{0, 0.4, -0.3}, Vec3{0, 0.4, 0.3}}));
    const std::array<ShapeDef, 4> shapes{ShapeDef::sphere(0.3), ShapeDef::box({0.3, 0.3, 0.3}),
                                         ShapeDef::capsule(0.2, 0.2), ShapeDef::hull(wedge)};
    for (int i = 0; i < 1200; i++) {
      body.shapes = {shapes[std::size_t(i % 4)]};
      body.pose.position = {i / 3 % 20 * 0.8, 0.4 + 0.65 * (i % 3), i / 60 * 0.8};
      (void)must(world.create_body(body));
    }
  }
  void add_kernels() {
    (void)must(world.add_property<Real>("heat", 1));
    const TableId one = must(world.add_table("one", 1));
    (void)must(world.add_property<Real>("total", 0, "J", one));
    must(stepper.add_kernel(world, {.text = cool::text(), .parameters = {{"rate", 0.01}}}));
    must(stepper.add_kernel(world, {.text = pull::text(), .parameters = {{"strength", 0.5}}, .cutoff = 1.5}));
    must(stepper.add_kernel(world, {.text = stretch::text(), .over = joint_table}));
    must(stepper.add_kernel(world, {.text = add_up::text()}));
  }
};

constexpr int steps = 12;

bool same(const char* what, std::uint64_t one, std::uint64_t other) {
  std::printf("%s: %016llx, %016llx\n", what, static_cast<unsigned long long>(one),
              static_cast<unsigned long long>(other));
  return one == other;
}

bool threads_agree(Precision precision, bool own) {
  const std::uint64_t one = Scene(precision, 1, own).run(steps);
  bool good = true;
  for (const std::uint32_t threads : {2u, 4u})
    good = same("in one and in more threads", one, Scene(precision, threads, own).run(steps)) && good;
  return good;
}

/// Two hosts, each with a world and a stepper of several threads, made, stepped, saved, restored and given up at the
/// same time.
bool worlds_agree() {
  const std::uint64_t one = Scene(Precision::f32, 1, true).run(steps);
  std::array<std::uint64_t, 2> hashes{};
  std::vector<std::thread> hosts;
  for (std::size_t i = 0; i < 2; i++)
    hosts.emplace_back([&, i] {
      Scene scene(Precision::f32, std::uint32_t(i + 1), true);
      (void)scene.run(steps / 2);
      must(scene.world.restore(scene.world.snapshot()));
      hashes[i] = scene.run(steps - steps / 2);
    });
  for (std::thread& host : hosts) host.join();
  const bool first = same("alone and beside another world", one, hashes[0]);
  return same("and that one", one, hashes[1]) && first;
}

/// A world that is made in one thread and stepped in another, by one stepper.
bool world_moves_on() {
  Scene scene(Precision::f64, 2, false);
  std::uint64_t hash = 0;
  for (int half = 0; half < 2; half++) std::thread([&] { hash = scene.run(steps / 2); }).join();
  return same("in threads one after the other", Scene(Precision::f64, 1, false).run(steps), hash);
}

}  // namespace

int main() {
  bool good = true;
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const bool own : {false, true}) good = threads_agree(precision, own) && good;
  good = worlds_agree() && good;
  good = world_moves_on() && good;
  return good ? 0 : 1;
}
