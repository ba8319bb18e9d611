#include "support_cases.h"

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

namespace physics {
namespace {

/// Rows that miss their bound, and may: tests/data/missed.csv, with the figure that they may not exceed. The fields
/// that say which row it is, as they stand there.
std::map<std::string, double> rows_that_miss() {
  std::ifstream file(PCPHYS_SOURCE_DIR "/tests/data/missed.csv");
  std::map<std::string, double> figures;
  std::string line;
  std::getline(file, line);  // the head
  while (std::getline(file, line)) {
    std::size_t end = 0;
    for (int field = 0; field < 6; field++) end = line.find(';', end) + 1;
    REQUIRE(end > 0);
    figures[line.substr(0, end - 1)] = std::stod(line.substr(end));
  }
  return figures;
}
std::string fields_of(const cases::Row& row) {
  std::ostringstream text;
  text << row.case_name << ';' << row.variant << ';' << (row.precision == Precision::f64 ? "double" : "float") << ';'
       << row.dt << ';' << row.substeps << ';' << row.metric;
  return text.str();
}

}  // namespace

Where metric(std::string start) {
  return [start](const cases::Row& row) { return row.metric.starts_with(start); };
}

std::vector<cases::Row> rows_of(const std::string& name, const Mode& mode, std::optional<double> dt,
                                const std::string& variant) {
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
  static const std::map<std::string, double> missing = rows_that_miss();
  int count = 0;
  for (const cases::Row& row : rows) {
    if (where && !where(row)) continue;
    count++;
    const std::string what = row.case_name + " " + row.variant + ", dt " + std::to_string(row.dt) + ", " +
                             std::to_string(row.substeps) + " sub-steps, " + row.metric;
    CAPTURE(what);
    CAPTURE(row.failure);
    MESSAGE(what << ": " << row.error << " (must " << row.must.value_or(not_a_number) << ")");
    const auto listed = missing.find(fields_of(row));
    if (listed == missing.end()) {
      CHECK_MESSAGE(row.pass, fields_of(row), ";", row.error);
      continue;
    }
    CHECK_MESSAGE(!row.pass, "It holds its bound: take it off tests/data/missed.csv.");
    CHECK_MESSAGE(row.error <= listed->second, "It misses by more than tests/data/missed.csv says.");
  }
  CHECK(count > 0);
}

}  // namespace physics
