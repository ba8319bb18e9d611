// Smaller and simpler scenes than a given one, for `shrink` to try.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "wild/play.h"
#include "wild/scene.h"

namespace pcphys::wild {

using OnObject = std::function<void(Object, int)>;
/// Tells what the call makes.
void each_made(const Call& call, const OnObject& tell);
/// Tells which objects the call names, besides those it makes; the ground is none.
void each_named(const Call& call, const OnObject& tell);

/// The scene without the calls that are marked, and without those that name what is then never made. Steps that then
/// follow each other at one dt are one call.
Scene without(const Scene& scene, const std::vector<bool>& out);

std::uint64_t count_steps(const Scene& scene);
/// Ends after so many steps.
Scene cut(const Scene& scene, std::uint64_t steps);

/// Begins with the state after `steps` of its first steps. None where the calls before these do more than make bodies,
/// joints, springs and forces one by one, where the library refused one, and where joints are apart by then.
std::optional<Scene> later_start(const Scene& scene, const PlayOptions& options, int steps);

/// Of the bodies as they stand at the start [m].
double deepest_overlap(const Scene& scene);

enum class Changes : std::uint8_t {
  place,    // or shape of a body: it may then overlap others at the start
  motion,   // and what acts on it
  surface,  // and nothing that matters to what touches nothing
};
/// A simpler form of a call.
struct Simplification {
  Changes changes;
  /// False where the call has that form already, or is of another kind.
  bool (*apply)(Call& call);
};
std::span<const Simplification> simplifications();

/// Without one corner of the hull that is this body's one shape. None where something else names the body, since its
/// frame moves, and where make_hull makes nothing of the other corners.
std::optional<Scene> without_corner(const Scene& scene, std::size_t call, std::size_t corner);

}  // namespace pcphys::wild
