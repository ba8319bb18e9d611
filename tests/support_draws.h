// Tests over random draws: what is worst of so many.
#pragma once
#include <algorithm>
#include <string_view>

#include "wild/dice.h"

namespace worldtest {
using namespace pcphys;

/// The largest of what `measure` answers for each of `count` draws from one row of dice; not below zero.
template <class Measure> double worst_of(std::string_view family, int count, Measure measure) {
  wild::Dice dice(family, 1);
  double worst = 0;
  for (int i = 0; i < count; i++) worst = std::max(worst, measure(dice));
  return worst;
}

}  // namespace worldtest
