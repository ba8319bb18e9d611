// Calls that every public function refuses, as one table (tests/bad_arguments.cpp): which function, what is wrong, and
// the error's code. docs/errors.md is made from it.
#pragma once
#include <functional>
#include <limits>
#include <vector>

#include "support_world.h"

namespace worldtest {

/// What a refused call must leave alone; a step that was made and undone leaves scratch.
inline Fingerprint lasting(const World& world) {
  Fingerprint f = fingerprint(world);
  f.tables.clear();
  return f;
}

/// A world with something of everything in it, a step behind it, and ids of what is gone.
struct Host {
  World world;
  BodyId body, other, point, fixed, hand, gone_body;  // point: does not rotate
  JointId joint, gone_joint;
  SpringId spring, gone_spring;
  ForceId force, gone_force;
  Property<Real> fuel, gone_property;  // of bodies
  Property<Real> heat;                 // of `cells`, which has two rows
  TableId cells, gone_table;
  std::vector<std::byte> saved;
  Stepper stepper;
  Fingerprint before;  // of the world that the call is to leave as it is

  Host();
  /// From here on nothing changes the world but what is refused: calls that need more than the host has say so once
  /// they have it.
  void ready() { before = lasting(world); }
  /// During a step of the world by the stepper; its error, if it has any.
  Error within_step(const std::function<void()>& act);
};

struct BadCall {
  const char* function;
  const char* wrong;
  ErrorCode code;
  std::function<Error(Host&)> call;
  bool changes = true;  // else it may be called while a step runs
};
using BadCalls = std::vector<BadCall>;

template <class T> Error error_of(const Result<T>& result) { return result ? Error{} : result.error(); }
inline Error error_of(const StepReport& report) { return report.error; }

inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinite = std::numeric_limits<double>::infinity();

/// Of World's objects; of what bodies, joints and springs hold; of properties, tables and snapshots; of shapes alone;
/// of steps; of kernels.
void add_bad_objects(BadCalls& calls);
void add_bad_values(BadCalls& calls);
void add_bad_properties(BadCalls& calls);
void add_bad_shapes(BadCalls& calls);
void add_bad_steps(BadCalls& calls);
void add_bad_kernels(BadCalls& calls);

}  // namespace worldtest
