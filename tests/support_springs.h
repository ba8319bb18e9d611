// What tests of springs share: the energy of a world with them, and random draws that are the same on every machine.
#pragma once
#include <random>
#include <utility>

#include "pcphys/world.h"

namespace worldtest {

inline double energy(const pcphys::World& world) {
  return world.kinetic_energy() + world.potential_energy() + world.spring_energy();
}

/// A number between two, and a vector of up to so much along each axis.
inline auto draws_of(std::mt19937& dice) {
  const auto between = [&dice](double low, double high) {
    return low + (high - low) * (double(dice()) / 4294967296.0);
  };
  const auto vector = [between](double most) {
    const double x = between(-most, most), y = between(-most, most), z = between(-most, most);
    return pcphys::Vec3{x, y, z};
  };
  return std::pair(between, vector);
}

}  // namespace worldtest
