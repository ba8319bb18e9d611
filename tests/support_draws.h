// Numbers and vectors drawn at random, the same on every machine.
#pragma once
#include <random>
#include <utility>

#include "pcphys/types.h"

namespace worldtest {

/// A number between two, and a vector of up to so much along each axis.
inline auto draws_of(std::mt19937& dice) {
  const auto between = [&dice](double low, double high) { return low + (high - low) * (double(dice()) / 4294967296.0); };
  const auto vector = [between](double most) {
    const double x = between(-most, most), y = between(-most, most), z = between(-most, most);
    return pcphys::Vec3{x, y, z};
  };
  return std::pair(between, vector);
}

}  // namespace worldtest
