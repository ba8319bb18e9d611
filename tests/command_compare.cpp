// Pins: `pcphys compare` measures pcphys and every peer in the same scene by the same code, its JSON has the keys of
// docs/command.md, and what is missing or gave up is named.
#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "command_support.h"
#include "peers/peer.h"

using namespace pcphys::test;

namespace {

const Json* row_of(const Json& report, const std::string& scene, const std::string& engine) {
  for (const Json& row : report["rows"])
    if (row["scene"] == scene && row["engine"] == engine) return &row;
  return nullptr;
}

}  // namespace

TEST_CASE("compare: the JSON has every key of the contract, and a row for each engine") {
  const Ran ran = command("compare stack:3 chain:4 --steps 40 --json -");
  REQUIRE_MESSAGE(ran.code == 0, ran.error);
  const Json report = ran.json();
  for (const char* key : {"steps", "dt", "substeps", "precision", "backend", "peers", "rows"})
    CHECK(report.contains(key));
  CHECK(report["peers"].size() == pcphys::peers::variants().size());
  CHECK(report["rows"].size() == 10);  // pcphys, bullet, ode, ode-dantzig, mujoco
  for (const char* scene : {"stack", "chain"}) {
    CAPTURE(scene);
    const Json* own = row_of(report, scene, "pcphys");
    REQUIRE(own);
    for (const char* key : {"count",
                            "ratio",
                            "bodies",
                            "joints",
                            "version",
                            "solver",
                            "substeps",
                            "iterations",
                            "problem",
                            "untranslated",
                            "steps",
                            "dt",
                            "clock",
                            "median_ms",
                            "p99_ms",
                            "time_ratio",
                            "max_penetration",
                            "mean_penetration",
                            "peak_penetration",
                            "max_joint_separation",
                            "mean_joint_separation",
                            "peak_joint_separation",
                            "limit_excess_degrees",
                            "peak_limit_excess_degrees",
                            "cone_excess_degrees",
                            "peak_cone_excess_degrees",
                            "energy_start",
                            "energy_end",
                            "energy_max",
                            "drift",
                            "fallen",
                            "stands",
                            "escaped",
                            "escaped_over_rim",
                            "nonfinite",
                            "contact_points",
                            "engine_penetration",
                            "failures"}) {
      CAPTURE(key);
      CHECK(own->contains(key));
    }
    CHECK((*own)["time_ratio"] == 1);
    CHECK((*own)["stands"] == (std::string(scene) == "stack" ? Json(true) : Json(nullptr)));
  }
  for (const pcphys::peers::Variant& variant : pcphys::peers::variants()) {
    const Json* row = row_of(report, "stack", std::string(variant.name));
    if (variant.name == "mujoco-rk4") {
      CHECK(row == nullptr);  // only where it is asked for
      continue;
    }
    REQUIRE(row);
    CHECK((*row)["problem"].is_null() == variant.found);  // a missing engine has a row that says so
    if (variant.found) {
      CHECK((*row)["steps"] == 40);
      CHECK((*row)["time_ratio"].get<double>() > 0);
      CHECK((*row)["contact_points"].get<int>() >= 9);
      CHECK((*row)["stands"] == true);
    }
  }
}

TEST_CASE("compare: pcphys's row says what `run` says") {
  const Json compared = command("compare ragdolls --count 1 --steps 60 --peers none --json -").json()["rows"][0];
  const Json ran = command("run ragdolls --count 1 --steps 60 --json -").json();
  for (const char* key : {"max_penetration", "mean_penetration", "max_joint_separation", "limit_excess_degrees",
                          "energy_start", "energy_end", "nonfinite", "escaped"}) {
    CAPTURE(key);
    CHECK(compared[key].get<double>() == doctest::Approx(ran[key].get<double>()).epsilon(1e-6));
  }
}

TEST_CASE("compare: a table for people, a CSV, and peers that stop or are refused") {
  const Ran text = command("compare heavy --steps 20");
  CHECK(text.code == 0);
  for (const char* word : {"heavy 2", "pcphys", "bullet", "ode-dantzig", "mujoco", "ms a step", "stands"}) {
    CAPTURE(word);
    CHECK(text.out.find(word) != std::string::npos);
  }
  const Ran csv = command("compare heavy:2 stack:2 --steps 10 --peers ode,bullet --csv -");
  CHECK(csv.code == 0);
  CHECK(csv.out.starts_with("scene,count,"));
  CHECK(std::count(csv.out.begin(), csv.out.end(), '\n') == 7);
  const auto variants = pcphys::peers::variants();
  const bool ode =
      std::any_of(variants.begin(), variants.end(), [](const auto& v) { return v.name == "ode" && v.found; });
  if (!ode) return;
  const Json stopped = command("compare stack:3 --steps 60 --peers ode --budget 1e-9 --json -").json()["rows"][1];
  CHECK(stopped["problem"].get<std::string>().find("--budget") != std::string::npos);
  CHECK(stopped["steps"] == 1);
  const Json refused = command("compare pyramid:30 --steps 1 --peers ode-dantzig --json -").json()["rows"][1];
  CHECK(refused["problem"].get<std::string>().find("cube") != std::string::npos);
  CHECK_FALSE(refused.contains("median_ms"));
}

TEST_CASE("doctor names each peer, found or missing with its package") {
  const Json doctor = command("doctor --json -").json();
  std::set<std::string> missing;
  for (const Json& item : doctor["missing"]) missing.insert(item["package"].get<std::string>());
  for (const pcphys::peers::Variant& variant : pcphys::peers::variants()) {
    const Json& version = doctor["peers"][std::string(variant.engine)];
    CHECK(version.is_null() != variant.found);
    CHECK(missing.contains(std::string(variant.package)) != variant.found);
  }
}
