// What pins that the host has opened do to springs as they close: bodies are drawn together by places alone, whatever
// springs pull them by.
#pragma once
#include <cstddef>
#include <vector>

#include "wild/observation.h"

namespace pcphys::wild {

class Closings {
 public:
  /// A call has left the joint open by `gap` [m].
  void opened(std::size_t joint, double gap);
  /// Of a step in which energy rose by `rise` [J]: as much of that as springs between points gained that pull at what
  /// such pins join, and at most what the way that these closed could stretch them by.
  double work(const Observation& before, const Observation& after, double rise);

 private:
  std::vector<double> left_;  // by joint: what is still to be closed [m]
};

}  // namespace pcphys::wild
