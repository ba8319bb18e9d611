// Impulses of contacts between shapes that were apart in the sub-step in which they acted; and what contacts may have
// put in where one side is driven. A watcher of the library's trace of contacts.
#pragma once
#include <cstdint>
#include <vector>

#include "pcphys/types.h"
#include "step/contact_trace.h"

namespace pcphys::wild {

class Phantoms final : public ContactTrace {
 public:
  void begin(const WorldState& state) override;
  void substep(const WorldState& state, double h, std::span<const TracedContact> contacts) override;

  /// Of the step: the widest gap over which a contact pushed, as a multiple of what is allowed: a thousandth of the
  /// smaller shape, or 0.1 mm.
  double widest() const { return widest_; }
  /// What kinematic bodies may have put in through contacts, at most [J].
  double driven_work() const { return driven_work_; }
  /// The sum of all impulses of contacts [N s], friction included.
  double impulses() const { return impulses_; }
  /// How many manifolds pushed, summed over sub-steps.
  std::uint64_t pushes() const { return pushes_; }

 private:
  struct Body {
    Pose pose;
    Vec3 velocity, angular_velocity, start_velocity;
    int contacts = 0;   // of this sub-step
    double pushed = 0;  // by all of them, along their normals [m/s]
  };
  void read(const WorldState& state, std::vector<Body>& bodies) const;
  double normal_impulse(const TracedContact& contact);
  double gap_of(const WorldState& state, double h, const TracedContact& contact) const;
  void add_work(const WorldState& state, const TracedContact& contact, double normal);

  std::vector<Body> before_, now_;  // by row
  std::vector<double> struck_;      // by contact: in this step so far [N s]
  std::vector<double> normals_;     // of the traced contacts, in this sub-step [N s]
  double widest_ = 0, driven_work_ = 0, impulses_ = 0;
  std::uint64_t pushes_ = 0;
};

}  // namespace pcphys::wild
