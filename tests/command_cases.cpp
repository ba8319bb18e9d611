// Pins: the contract of `pcphys accuracy` and `stability`: rows with every key, hashes equal on gl, the selection by
// names, precision and step length, and exit codes that tell whether everything reached what it must.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>

#include "command_support.h"

using namespace pcphys::test;

TEST_CASE("accuracy: rows with every key of the contract, and exit code 0 where all pass") {
  const Ran ran = command("accuracy A2 A5 --dt 1/60 --json -");
  REQUIRE_MESSAGE(ran.code == 0, ran.error);
  const Json rows = ran.json();
  REQUIRE(rows.is_array());
  REQUIRE(rows.size() == 2 + 8);  // A2: one error; A5: two variants with two errors; two precisions each
  for (const Json& row : rows) {
    for (const char* key : {"case", "title", "variant", "backend", "precision", "metric"}) {
      CAPTURE(std::string(key));
      CHECK(row[key].is_string());
    }
    for (const char* key : {"dt", "substeps", "error", "ns_per_body_step", "total_ms"}) {
      CAPTURE(std::string(key));
      CHECK(row[key].is_number());
    }
    for (const char* key : {"must", "target", "peer", "order", "gl_hash", "failure"}) {
      CAPTURE(std::string(key));
      CHECK(row.contains(key));
    }
    CHECK(row["pass"] == true);
    CHECK(row["backend"] == "cpu");
    CHECK(row["peer"].is_null());
    CHECK(row["dt"].get<double>() == doctest::Approx(1.0 / 60));
    CHECK(row["ns_per_body_step"].get<double>() > 0);
  }
}

TEST_CASE("a row that misses its bound gives exit code 4") {
  setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere", 1);  // no row of the library's misses but where there is no GL
  const Ran ran = command("stability C17 --variant gl --precision float --json -");
  unsetenv("__EGL_VENDOR_LIBRARY_FILENAMES");
  CHECK(ran.code == 4);
  CHECK(ran.error.find("miss what they must reach") != std::string::npos);
  const Json rows = ran.json();
  CHECK(std::any_of(rows.begin(), rows.end(), [](const Json& row) { return row["pass"] == false; }));
}

TEST_CASE("accuracy: a second-order variant tells its order") {
  const Ran ran = command("accuracy A8 --precision double --json -");
  CHECK(ran.code == 0);
  const Json rows = ran.json();
  const auto order = std::find_if(rows.begin(), rows.end(),
                                  [](const Json& row) { return row["metric"] == "2 - order of position until 2 s"; });
  REQUIRE(order != rows.end());
  CHECK((*order)["order"].get<double>() > 1.9);
}

TEST_CASE("accuracy: gl ends in the same hash") {
  if (!has_gl()) {
    MESSAGE("no OpenGL here");
    return;
  }
  const Ran ran = command("accuracy A2 A8 A22 --dt 1/60 --precision float --backend gl --json -");
  const Json rows = ran.json();
  REQUIRE(rows.is_array());
  for (const Json& row : rows) CHECK(row["gl_hash"] == "equal");
}

TEST_CASE("accuracy: for people, as CSV, and the list of cases") {
  const Ran text = command("accuracy A2 --dt 1/60");
  CHECK(text.code == 0);
  CHECK(text.out.find("must") != std::string::npos);
  const Ran csv = command("accuracy A2 --dt 1/60 --precision float --csv -");
  CHECK(csv.out.starts_with("case,title,variant,backend,"));
  CHECK(std::count(csv.out.begin(), csv.out.end(), '\n') == 2);
  const Ran list = command("accuracy --list");
  CHECK(list.code == 0);
  for (int i = 1; i <= 23; i++) {
    CAPTURE(i);
    CHECK(list.out.find("A" + std::to_string(i) + " ") != std::string::npos);
  }
}
