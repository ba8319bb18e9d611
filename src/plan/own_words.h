// Words with which kernels of the host's own are refused.
#pragma once
#include <algorithm>
#include <functional>
#include <string>
#include <string_view>

#include "plan/own_kernels.h"

namespace pcphys {

inline std::string quoted(std::string_view text) { return "\"" + std::string(text) + "\""; }
inline Error bad(const OwnKernel& k, const std::string& what) {
  return {ErrorCode::bad_argument, "The kernel " + quoted(k.name) + " " + what};
}

template <class List, class Value, class Of = std::identity>
bool contains(const List& list, const Value& value, Of of = {}) {
  return std::ranges::find(list, value, of) != std::ranges::end(list);
}

}  // namespace pcphys
