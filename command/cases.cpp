// pcphys accuracy and pcphys stability: the validation cases, with what they must reach.
#include "cases/runner.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "commands.h"
#include "output.h"
#include "peers/peer.h"

namespace pcphys::command {
namespace {

const char* name(Precision precision) { return precision == Precision::f64 ? "double" : "float"; }

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }
Json or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json to_json(const cases::Row& row) {
  return {{"case", row.case_name},
          {"title", row.title},
          {"variant", row.variant},
          {"backend", row.backend},
          {"precision", name(row.precision)},
          {"dt", row.dt},
          {"substeps", row.substeps},
          {"metric", row.metric},
          {"error", row.error},  // null when it is not finite
          {"must", or_null(row.must)},
          {"target", or_null(row.target)},
          {"pass", row.pass},
          {"lost", row.lost},
          {"floor", or_null(row.floor)},
          {"ns_per_body_step", row.ns_per_body_step},
          {"total_ms", row.total_ms},
          {"peer", or_null(row.peer)},
          {"order", or_null(row.order)},
          {"gl_hash", or_null(row.gl)},
          {"failure", or_null(row.failure)}};
}

/// One line of the fields of the JSON, in the same order; text in quotes.
std::string csv_line(const Json& row) {
  std::string line;
  for (const auto& [key, value] : row.items())
    line += (line.empty() ? "" : ",") + (value.is_null() ? "" : value.dump());
  return line + "\n";
}

std::string csv_head(const Json& row) {
  std::string line;
  for (const auto& [key, value] : row.items()) line += (line.empty() ? "" : ",") + key;
  return line + "\n";
}

std::string step_text(double dt) {
  char text[32];
  const double inverse = std::round(1 / dt);
  if (dt < 0.05 && dt > 5e-4 && std::fabs(inverse * dt - 1) < 1e-9)
    std::snprintf(text, sizeof text, "1/%.0f", inverse);
  else
    std::snprintf(text, sizeof text, "%g", dt);
  return text;
}

void print(std::span<const cases::Row> rows) {
  for (const cases::Row& row : rows) {
    std::printf("%-4s %-18s %-10s %-6s %-6s n=%-2u %-40s %10.3g", row.case_name.c_str(), row.variant.c_str(),
                row.peer.empty() ? row.backend.c_str() : row.peer.c_str(), name(row.precision),
                step_text(row.dt).c_str(), row.substeps, row.metric.c_str(), row.error);
    if (row.must)
      std::printf("  must %9.2g", *row.must);
    else
      std::printf("  %14s", "");
    std::printf("  %-6s %8.0f ns", row.must || !row.pass ? (row.pass ? "ok" : "MISSED") : "", row.ns_per_body_step);
    if (!row.gl.empty()) std::printf("  gl %s", row.gl.c_str());
    std::printf("%s%s\n", row.failure.empty() ? "" : "  ", row.failure.c_str());
  }
  std::fflush(stdout);
}

Result<std::vector<std::string>> peers_to_run(const CaseOptions& options) {
  if (auto status = check_budget(options.budget); !status) return status.error();
  return found_peers(options.peers);
}

int list_cases(const std::string& groups) {
  for (const cases::Case& c : cases::list()) {
    if (groups.find(c.group()) == std::string::npos) continue;
    std::string variants;
    for (const cases::Variant& variant : c.variants) variants += (variants.empty() ? "" : ", ") + variant.name;
    std::printf("%-4s %s: %s\n", c.name.c_str(), c.title.c_str(), variants.c_str());
  }
  return exit_ok;
}

}  // namespace

int run_cases(const CaseOptions& options, const char* command, const std::string& groups) {
  if (options.list) return list_cases(groups);
  const auto selection = resolve(options, groups);
  if (!selection) return fail(selection.error());
  if (auto status = cases::check(*selection); !status) return fail(status.error());
  const auto peer_list = peers_to_run(options);
  if (!peer_list) return fail(peer_list.error());
  auto files = ResultFiles::open(options.json, options.csv);
  if (!files) return fail(files.error());

  const std::unique_ptr<cases::Engine> own = cases::make_pcphys(Place::cpu);
  std::vector<std::unique_ptr<cases::Engine>> others;
  std::vector<cases::Engine*> engines{own.get()};
  for (const std::string& name : *peer_list) {
    others.push_back(cases::make_peer(name, options.budget));
    engines.push_back(others.back().get());
  }
  std::vector<cases::Row> rows;
  {
    Progress progress(command, cases::count_trials(*selection, engines), "trial");
    rows = cases::run(
        *selection, engines,
        [&](std::span<const cases::Row> found) {
          if (files->printed()) print(found);
        },
        [&](std::size_t done) { progress.show(done); });
  }

  Json json = Json::array();
  std::string csv;
  for (const cases::Row& row : rows) {
    json.push_back(to_json(row));
    if (csv.empty()) csv = csv_head(json.back());
    csv += csv_line(json.back());
  }
  if (auto status = files->write(json, csv); !status) return fail(status.error());
  const auto is_own = [](const cases::Row& row) { return row.peer.empty(); };
  const auto missed =
      std::count_if(rows.begin(), rows.end(), [&](const cases::Row& row) { return is_own(row) && !row.pass; });
  if (missed == 0) return exit_ok;
  std::cerr << "pcphys: " << missed << " of " << std::count_if(rows.begin(), rows.end(), is_own)
            << " rows miss what they must reach.\n";
  return exit_missed;
}

}  // namespace pcphys::command
