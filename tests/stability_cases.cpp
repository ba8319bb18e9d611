// Pins what holds of the stiff and extreme cases (docs/stability.md) and is cheap: chains under loads, a tower, bodies
// in one place, degenerate shapes, bad input, crowds on lines and planes.
#include "support_cases.h"

using namespace physics;

namespace {

constexpr double fine = 1.0 / 240;

Where without(std::string start) {
  return [start = std::move(start)](const cases::Row& row) { return !row.metric.starts_with(start); };
}

}  // namespace

TEST_CASE("B1: chains of 10 links hold loads of up to 1e6 links") {
  for (const Mode& mode : precisions()) check_rows(rows_of("B1", mode, fine, "10 links"));
}

TEST_CASE("B4: a tower of 10 stands and its contact forces are the weights") {
  for (const Mode& mode : precisions()) {
    const auto rows = rows_of("B4", mode, fine, "10 cubes");
    check_rows(rows, metric("across"));
    check_rows(rows, metric("contact forces"));
  }
}

TEST_CASE("B12: strong drag ends a motion where it should, and turns nothing round") {
  for (const Mode& mode : precisions()) check_rows(rows_of("B12", mode, {}, "drag"));
}

TEST_CASE("C9: bodies in one place stay finite and repeat") {
  for (const Mode& mode : precisions())
    for (const char* variant : {"2 ", "10 "}) check_rows(rows_of("C9", mode, {}, variant));
}

TEST_CASE("C11, C12: bad input is refused or stays with its body") {
  for (const Mode& mode : precisions()) {
    check_rows(rows_of("C11", mode, {}, "shapes"));
    check_rows(rows_of("C12", mode));
  }
}

TEST_CASE("C14: 100,000 bodies on a line and a plane, pairs as by brute force") {
  for (const char* variant : {"line, sorted", "plane"})
    check_rows(rows_of("C14", Mode{Precision::f32}, {}, variant), without("broad phase"));  // no times on a shared machine
}
