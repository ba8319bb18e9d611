// What must hold in a fuzz target; what does not ends the program, which libFuzzer takes for a finding.
#pragma once
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

#include "pcphys/result.h"

namespace fuzz {

inline void expect(bool holds, const std::string& what, int line = __builtin_LINE()) {
  if (holds) return;
  std::fprintf(stderr, "Found in line %d: %s\n", line, what.c_str());
  std::abort();
}
inline void expect(const pcphys::Status& status, int line = __builtin_LINE()) {
  expect(bool(status), status ? "" : "a call was refused: " + status.error().message, line);
}
template <class T> T expect(pcphys::Result<T> result, int line = __builtin_LINE()) {
  expect(bool(result), result ? "" : "a call was refused: " + result.error().message, line);
  return std::move(*result);
}

}  // namespace fuzz
