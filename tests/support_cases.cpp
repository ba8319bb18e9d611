#include "support_cases.h"

namespace physics {

Where metric(std::string start) {
  return [start](const cases::Row& row) { return row.metric.starts_with(start); };
}

std::vector<cases::Row> rows_of(const std::string& name, const Mode& mode, std::optional<double> dt, const std::string& variant) {
  const auto engine = cases::make_pcphys(mode.place, mode.lanes);
  cases::Engine* const engines[] = {engine.get()};
  cases::Selection selection;
  selection.groups = "ABC";
  selection.names = {name};
  selection.single = !mode.is_double();
  selection.twice = mode.is_double();
  selection.dt = dt;
  selection.variant = variant;
  REQUIRE(cases::check(selection));
  return cases::run(selection, engines, {}, {});
}

void check_rows(const std::vector<cases::Row>& rows, const Where& where) {
  int count = 0;
  for (const cases::Row& row : rows) {
    if (where && !where(row)) continue;
    count++;
    const std::string what = row.case_name + " " + row.variant + ", dt " + std::to_string(row.dt) + ", " +
                             std::to_string(row.substeps) + " sub-steps, " + row.metric;
    CAPTURE(what);
    CAPTURE(row.failure);
    MESSAGE(what << ": " << row.error << " (must " << row.must.value_or(not_a_number) << ")");
    CHECK(row.pass);
  }
  CHECK(count > 0);
}

}  // namespace physics
