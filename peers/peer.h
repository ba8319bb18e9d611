// Other engines beside pcphys: the same bodies and joints, read from a world, behind one small interface.
// What differs between them and pcphys is said by `Peer::untranslated`, and in docs/compare.md.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pcphys/result.h"
#include "pcphys/world.h"

namespace pcphys::peers {

/// An engine with one of its solvers or integrators.
struct Variant {
  std::string_view name;       // "ode-dantzig"
  std::string_view engine;     // "ODE"
  std::string_view solver;     // in words
  std::string_view package;    // of Debian, that brings it
  std::string_view precision;  // "float" or "double"
  bool found = false;          // when pcphys was built
  std::string version;         // empty when it was not found
};

/// All that pcphys knows, those that were not found too, in the order in which tables show them.
std::span<const Variant> variants();

struct Options {
  int substeps = 0;    // of equal length in each step; 0: as many as keep to the engine's own default step
  int iterations = 0;  // of its solver in each sub-step; 0: the engine's own default
  /// Approach speeds below it do not bounce [m/s]; where absent, the engine's default.
  std::optional<double> restitution_threshold;
  bool sleep = false;  // whether bodies may, by the engine's own thresholds; Bullet alone
};

/// Body i of a peer is the i-th of those that it was made of. Nothing sleeps unless Options::sleep.
class Peer {
 public:
  virtual ~Peer() = default;

  /// Moves on by dt [s]. An engine that cannot go on says so; one that gives nonsense shows it in its poses.
  virtual Status step(double dt) = 0;
  /// How many sub-steps a step of dt [s] has.
  virtual int substeps(double dt) const = 0;
  /// Of the solver in a sub-step; 0 where there are none.
  virtual int iterations() const = 0;

  virtual Pose pose(std::size_t body) const = 0;
  /// Of the centre of mass, as the engine keeps it [m/s].
  virtual Vec3 velocity(std::size_t body) const = 0;
  /// World axes [rad/s].
  virtual Vec3 angular_velocity(std::size_t body) const = 0;
  /// As the engine has it, which is not always what it was given.
  virtual MassProperties mass_properties(std::size_t body) const = 0;

  /// In place of what acted before. Errors: unavailable where the engine cannot, as for the next two.
  virtual Status set_wrench(std::size_t body, const Wrench& wrench);
  virtual Status set_gravity(Vec3 gravity);
  /// Of the centre of mass, and about it; world axes.
  virtual Status set_velocity(std::size_t body, Vec3 velocity, Vec3 angular_velocity);

  /// Points in contact, and the deepest overlap among them [m], of the last sub-step, as the engine sees them.
  virtual std::size_t contacts() const = 0;
  virtual std::optional<double> deepest() const = 0;
  /// How often the engine gave up by itself: state set back to the start, or constraints dropped for want of room.
  virtual std::uint64_t failures() const { return 0; }

  /// What of the world the engine has no equal of, a sentence each.
  const std::vector<std::string>& untranslated() const { return untranslated_; }

 protected:
  std::vector<std::string> untranslated_;
};

/// The bodies of a world, in this order, with all its joints, gravity, drag and constant forces.
/// Errors: unknown_name; unavailable when the engine was not found, or for what it cannot hold at all.
Result<std::unique_ptr<Peer>> make(std::string_view variant, const World& world, std::span<const BodyId> bodies,
                                   const Options& options = {});

}  // namespace pcphys::peers
