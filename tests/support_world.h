// What the tests of world, plan, step, parity and golden hashes share: scenes, runs, mixes of places.
#pragma once
#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pcphys/pcphys.h"
#include "scenes/scene.h"

namespace worldtest {
using namespace pcphys;

inline constexpr double frame = 1.0 / 60;  // [s]

/// A world with a scene in it.
struct SceneWorld {
  World world;
  scenes::Scene scene;
};
SceneWorld scene_world(std::string_view name, int count, Precision precision = Precision::f32);

/// All eight ways to put the three stages on two places, the one that is all cpu first.
struct Mix {
  std::array<Place, 3> places;  // integrate, joints, impulses
  StepSettings settings() const;
  std::string text() const;
};
std::vector<Mix> mixes();

StepSettings lanes(std::uint32_t lanes);

/// Hashes after each of so many steps of a world made for these settings.
using HashesOf = std::function<std::vector<std::uint64_t>(const StepSettings& settings, int steps)>;
/// Checks that they are the same in all lanes and in threads, and the first few of them on GL and in all mixes.
void check_same_bits(const HashesOf& hashes_of, int steps, int steps_on_gl);

/// Takes the steps; a refused one fails the test with its sentence.
void run(World& world, Stepper& stepper, int steps, double dt = frame);
/// Takes the steps as above; the world's hash after each.
std::vector<std::uint64_t> hash_each_step(World& world, Stepper& stepper, int steps, double dt = frame);
/// How often a plan has this kernel.
int runs(const StepPlan& plan, std::string_view kernel);
/// One step; its error where it was refused.
Status step_status(Stepper& stepper, World& world, double dt = frame);
/// A test must not pass because there was nothing to test: llvmpipe comes with the scripts.
void require_gl();

/// Checks that a kernel whose GLSL is wrong in that line is refused on GL, with the host's own file and line, and that
/// steps go on.
void check_glsl_error(World& world, const KernelDef& def, int line);

/// A ball at a place.
BodyDef ball(Vec3 position, double radius = 0.5);
BodyDef fixed_box(Vec3 position, Vec3 half_extents);
/// A bar along z, 0.4 m by default, and a pin between two bodies.
BodyDef link_at(Vec3 position, double length = 0.4);
JointDef pin(BodyId a, Vec3 at_a, BodyId b, Vec3 at_b);
/// Links along z below `top`, on a pin there unless `free`; they spin, so that the chain moves in three dimensions.
std::vector<BodyId> add_chain(World& world, Vec3 top, int count, bool free = false, Vec3 spin = {1.5, -1, 0.7},
                              bool touching = false);
/// Chains of several shapes and spins, hanging and free; one of them meets a floor.
World chains_world(Precision precision);
/// A roof of six links with a heavy ridge, just above level: it falls through, and snaps straight within a step.
World roof_world(Precision precision);
/// Balls and boxes in one place: more colours of contacts than a word has bits, and thousands of dispatches a step.
World crowd_world(Precision precision);
/// The id of an object of another world, made by the same calls, in this one.
template <class Id> Id as_in(const World& world, Id id) { return {id.index, id.generation, world.ground().world}; }
template <class T> T must(Result<T> result) {
  if (!result) FAIL("refused: " << result.error().message);
  return std::move(*result);
}
inline void must(const Status& status) {
  if (!status) FAIL("refused: " << status.error().message);
}

/// What a refused call must leave alone: hash, counts, ids, snapshot, and the bytes of every property.
struct Fingerprint {
  std::uint64_t hash = 0;
  std::vector<BodyId> bodies;
  std::vector<JointId> joints;
  std::vector<std::byte> snapshot, tables;
  Vec3 gravity;
  friend bool operator==(const Fingerprint&, const Fingerprint&) = default;
};
Fingerprint fingerprint(const World& world);

/// Checks the error's code and message, and that the world is what it was.
#define CHECK_REFUSED(world, call, expected_code, words)                                                         \
  do {                                                                                                           \
    const auto before_call = worldtest::fingerprint(world);                                                      \
    const auto answer = (call);                                                                                  \
    worldtest::check_refused(bool(answer), answer ? Error{} : answer.error(), expected_code, words);             \
    CHECK_MESSAGE((worldtest::fingerprint(world) == before_call), "the refused call changed the world: " #call); \
  } while (false)
void check_refused(bool went_through, const Error& error, ErrorCode code, std::string_view words);

/// Pose and velocities of one body, to compare bit by bit.
struct BodyState {
  Pose pose;
  Vec3 velocity, angular_velocity;
  friend bool operator==(const BodyState&, const BodyState&) = default;
};
std::vector<BodyState> states(const World& world, const std::vector<BodyId>& bodies);

}  // namespace worldtest
