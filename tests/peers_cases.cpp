// Pins: the validation cases run in peers, with the errors that these engines are known to have, and a case that an
// engine has no equal of fails with the reason instead of an error that means nothing.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "cases/runner.h"
#include "peers/peer.h"

using namespace pcphys;

namespace {

/// Rows of one case at one step length in one peer; none when it was not found.
std::vector<cases::Row> rows_of(const char* peer, const char* name, const char* variant, double dt,
                                double budget = 10) {
  const auto engine = cases::make_peer(peer, budget);
  if (!engine) return {};
  cases::Engine* const engines[] = {engine.get()};
  cases::Selection selection;
  selection.groups = "ABC";
  selection.names = {name};
  selection.variant = variant;
  selection.dt = dt;
  return cases::run(selection, engines, {}, {});
}

bool found(const char* peer) {
  const auto all = peers::variants();
  return std::any_of(all.begin(), all.end(), [&](const peers::Variant& v) { return v.name == peer && v.found; });
}

/// The error of a metric, with one sub-step; NaN when there is none.
double error(const std::vector<cases::Row>& rows, const char* metric) {
  for (const cases::Row& row : rows)
    if (row.metric == metric && row.substeps == 1) return row.error;
  return std::nan("");
}

}  // namespace

TEST_CASE("peers in cases: the pendulum's errors are those that are published for the engines") {
  // validation set, A7, 90 degrees: largest error of the position over 10 s [m]
  struct Known {
    const char* peer;
    double dt, error;
  };
  for (const Known& known :
       {Known{"ode", 1.0 / 60, 0.53}, Known{"ode-dantzig", 1.0 / 240, 1.3e-2}, Known{"mujoco", 1.0 / 60, 2.3e-2},
        Known{"mujoco", 1.0 / 240, 5.6e-3}, Known{"mujoco-rk4", 1.0 / 60, 8e-7}, Known{"mujoco-rk4", 1.0 / 240, 6e-9},
        Known{"bullet", 1.0 / 240, 1.3e-2}}) {
    if (!found(known.peer)) continue;
    CAPTURE(known.peer);
    CAPTURE(known.dt);
    const auto rows = rows_of(known.peer, "A7", "90 deg", known.dt);
    REQUIRE_FALSE(rows.empty());
    for (const cases::Row& row : rows) {
      CHECK(row.peer == known.peer);
      CHECK(row.failure.empty());
      CHECK(row.ns_per_body_step > 0);
      CHECK((row.precision == Precision::f32) == (std::string(known.peer) == "bullet"));
    }
    CHECK(error(rows, "position [m]") == doctest::Approx(known.error).epsilon(0.15));
  }
}

TEST_CASE("peers in cases: a trial fails with its reason where the engine has no equal, or takes too long") {
  if (!found("mujoco")) return;
  const auto bouncing = rows_of("mujoco", "A11", "", 1.0 / 240);
  REQUIRE_FALSE(bouncing.empty());
  CHECK(std::any_of(bouncing.begin(), bouncing.end(), [](const cases::Row& row) {
    return row.failure.find("restitution") != std::string::npos && std::isnan(row.error) && !row.pass;
  }));
  const auto slow = rows_of("mujoco", "A7", "90 deg", 1.0 / 1200, 1e-9);
  REQUIRE_FALSE(slow.empty());
  CHECK(slow[0].failure.find("budget") != std::string::npos);
  CHECK(cases::make_peer("havok", 1) == nullptr);
}
