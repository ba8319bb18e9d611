// Pins: `pcphys tables` runs every row of the original's Tables 1 and 2 and prints both figures.
#include <doctest/doctest.h>

#include <algorithm>

#include "command_support.h"

using namespace pcphys::test;

TEST_CASE("tables: sixteen rows, with the original's figures beside ours") {
  const Ran ran = command("tables --steps 20 --json -");
  REQUIRE_MESSAGE(ran.code == 0, ran.error);
  const Json json = ran.json();
  REQUIRE(json["rows"].size() == 16);
  double original = 0;
  for (const Json& row : json["rows"]) {
    CHECK(row["max_fps"].get<double>() >= row["min_fps"].get<double>());
    CHECK(row["min_fps"].get<double>() > row["original_max_fps"].get<double>());
    original += row["original_max_fps"].get<double>() + row["original_min_fps"].get<double>();
  }
  CHECK(original == doctest::Approx(1080.68).epsilon(1e-6));  // sum of the printed tables
  CHECK(json["rows"][6]["count"] == 60);
  CHECK(json["rows"][15]["count"] == 8);
}

TEST_CASE("tables: for people, and as CSV") {
  const Ran text = command("tables --steps 10");
  CHECK(text.code == 0);
  CHECK(text.out.find("Table 1") != std::string::npos);
  CHECK(text.out.find("Table 2") != std::string::npos);
  const Ran csv = command("tables --steps 10 --csv -");
  CHECK(csv.code == 0);
  CHECK(std::count(csv.out.begin(), csv.out.end(), '\n') == 17);
}
