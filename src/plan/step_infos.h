// The blocks of coefficients that a step's kernels read, filled anew only where what they follow from has changed.
#pragma once
#include <cstdint>

#include "plan/infos.h"
#include "plan/island_class.h"

namespace pcphys {

class StepInfos {
 public:
  /// Those of all octaves, of `precision`: InfoOf<float> or InfoOf<double>, phase_count of each octave. `octaves`:
  /// those in use, as bits.
  const void* fill(Precision precision, const InfoInputs& from, std::uint32_t octaves) {
    if (precision != precision_ || !(from == from_)) {
      filled_ = 0;
      from_ = from;
      precision_ = precision;
    }
    const bool single = precision == Precision::f32;
    if (const std::uint32_t due = octaves & ~filled_) single ? fill(due, singles_) : fill(due, doubles_);
    filled_ |= octaves;
    return single ? static_cast<const void*>(singles_) : doubles_;
  }

 private:
  template <class Scalar> void fill(std::uint32_t due, InfoOf<Scalar> (&infos)[octave_count][phase_count]) {
    for (unsigned octave = 0; octave < octave_count; octave++)
      if (due >> octave & 1) fill_infos(from_, infos[octave], octave);
  }

  InfoInputs from_;  // of those that are filled
  Precision precision_ = Precision::f32;
  std::uint32_t filled_ = 0;  // octaves, as bits
  InfoOf<float> singles_[octave_count][phase_count];
  InfoOf<double> doubles_[octave_count][phase_count];
};

}  // namespace pcphys
