// The cases of cases/ as tests: rows of the runner, each held to its bound.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cases/runner.h"
#include "support_physics.h"

namespace physics {

/// Which of a case's rows a test pins.
using Where = std::function<bool(const cases::Row&)>;

/// The metric starts with this.
Where metric(std::string start);

/// Runs a case in this mode, over its step lengths or one of them; of its variants those that start with `variant`.
std::vector<cases::Row> rows_of(const std::string& name, const Mode& mode, std::optional<double> dt = {},
                                const std::string& variant = {});
/// Every row passes, but for those of tests/data/missed.csv, which miss by no more than is said there; there is at
/// least one.
void check_rows(const std::vector<cases::Row>& rows, const Where& where = {});

}  // namespace physics
