// A host: a world, what it holds of its objects, and how it steps it. Several hosts are given the same calls; what they
// step with differs, and nothing else may.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pcphys/pcphys.h"

namespace fuzz {

/// What must change no bit.
struct Twin {
  std::string name;
  pcphys::Place place = pcphys::Place::cpu;
  std::uint32_t lanes = 1, threads = 1;
  std::uint32_t steppers = 1;     // that step it in turns
  std::uint32_t fresh_every = 0;  // before each so manieth step all of them are new; 0: never
  bool restored = false;          // and the world restored from its own snapshot, and both shrunk before each third
  bool mixed = false;             // stages are on the GPU and the CPU by turns
};

/// What a call answered: an error, or none and numbers.
struct Outcome {
  pcphys::ErrorCode code = pcphys::ErrorCode::none;
  std::vector<double> numbers;
  std::string message;
};
/// Whether both are the same, to the bit; the sign of zero is none.
bool same(const Outcome& a, const Outcome& b);
Outcome of(const pcphys::Status& status);

class Host {
 public:
  Host(const Twin& twin, pcphys::Precision precision);

  const Twin& twin() const { return twin_; }
  pcphys::World world;
  std::vector<pcphys::BodyId> bodies;  // also such as were refused or destroyed
  std::vector<pcphys::JointId> joints;
  std::vector<pcphys::SpringId> springs;
  std::vector<pcphys::ForceId> forces;
  std::vector<pcphys::Property<pcphys::Real>> properties;
  std::vector<std::byte> saved;

  /// Of a handle that was counted; beyond: of an id that names nothing.
  template <class Id> static Id at(const std::vector<Id>& ids, std::uint32_t i) {
    return i < ids.size() ? ids[i] : Id{};
  }
  pcphys::BodyId body(std::uint32_t i) const { return i == ground ? world.ground() : at(bodies, i); }
  static constexpr std::uint32_t ground = 0xffffffffu;

  Outcome configure(const pcphys::StepSettings& settings);
  Outcome step(double dt);
  /// A kernel of the host's own for all steppers.
  Outcome add_kernel(const pcphys::KernelDef& def);
  Outcome remove_kernel(const std::string& name);
  /// All that can be read of the world.
  Outcome read_all() const;

 private:
  pcphys::StepSettings placed() const;
  void renew();

  Twin twin_;
  pcphys::StepSettings settings_;
  std::vector<pcphys::Stepper> steppers_;
  std::vector<pcphys::KernelDef> kernels_;
  std::uint64_t steps_ = 0;
};

}  // namespace fuzz
