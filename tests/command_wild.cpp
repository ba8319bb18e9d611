// Pins: the contract of `pcphys wild`: named one-line errors, exit code 1 where a scene is broken and 0 where none is,
// every key of the JSON, and that a seed is the same scene each time.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "command_support.h"

using namespace pcphys::test;

namespace {

const Refused cases[] = {
    {"wild meadow", 2, "no family 'meadow'; choose of encounter, "},
    {"wild encounter --seed many", 2, "many"},
    {"wild encounter --seed 1.5", 2, "1.5"},
    {"wild encounter --seed -1", 2, "--seed is -1"},
    {"wild encounter --count 0", 2, "--count is 0"},
    {"wild encounter --count few", 2, "few"},
    {"wild encounter --budget 0", 2, "--budget is 0"},
    {"wild encounter --budget -3", 2, "give seconds above 0"},
    {"wild encounter --budget soon", 2, "soon"},
    {"wild encounter --budget nan", 2, "give seconds above 0"},
    {"wild encounter --budget inf", 2, "give seconds above 0"},
    {"wild encounter --budget 1e300", 2, "--budget is 1e+300"},
    {"wild encounter --precision half", 2, "float, double, both"},
    {"wild encounter --backend cuda", 2, "cpu, gl"},
    {"wild encounter --lanes 3", 2, "auto, 1, 4, 8"},
    {"wild encounter --lanes 8 --precision both", 2, "1 and 4 lanes"},
    {"wild encounter --threads 257", 2, "--threads is 257"},
    {"wild encounter --bits -1", 2, "--bits is -1"},
    {"wild encounter --peers havok", 2, "no peer 'havok'"},
    {"wild encounter --seed 1 --shrink --json -", 2, "asked for by --json and by --shrink;"},
    {"wild encounter --seed 1 --json - --csv -", 2, "--json and by --csv"},
    {"wild encounter --seed 1 --json /no/such/folder/a.json", 1, "folder that exists"},
    {"wild encounter --seed 1 --shrink-to /no/such/folder/a.cpp", 1, "folder that exists"},
};

const Json& measure(const Json& summary, const std::string& name) {
  static const Json none;
  for (const Json& m : summary["measures"])
    if (m["measure"] == name) return m;
  return none;
}

}  // namespace

TEST_CASE("wild: errors are one line with the right code, and nothing on standard output") { check_refused(cases); }

TEST_CASE("wild: every key of the contract") {
  const Ran ran = command("wild encounter passing --count 20 --precision both --json -");
  const Json json = ran.json();
  REQUIRE_MESSAGE(json.is_object(), ran.error);
  for (const char* key : {"version", "options", "measures", "families", "peers"}) {
    CAPTURE(std::string(key));
    CHECK(json.contains(key));
  }
  REQUIRE(json["summaries"].size() == 4);  // two families in two precisions
  bool broken = false;
  for (const Json& summary : json["summaries"]) {
    for (const char* key : {"engine", "family", "precision", "runs", "broken", "failed", "refused", "why_refused",
                            "steps", "body_steps", "seconds", "ns_per_body_step", "worst", "broken_scenes"}) {
      CAPTURE(std::string(key));
      CHECK(summary.contains(key));
    }
    CHECK(summary["engine"] == "pcphys");
    CHECK(summary["runs"] == 20);
    CHECK(summary["broken_scenes"].size() == std::min<std::size_t>(summary["broken"].get<std::size_t>(), 20));
    broken = broken || summary["broken"].get<int>() > 0;
    const Json& energy = measure(summary, "energy");
    for (const char* key : {"runs", "broken", "most_broken", "median", "p99", "p999", "worst", "least_bound",
                            "largest_bound", "seed", "step"}) {
      CAPTURE(std::string(key));
      CHECK(energy.contains(key));
    }
    CHECK(measure(summary, "bits")["runs"] == 1);  // seed 16 of 1 to 20
    CHECK(measure(summary, "bits")["worst"] == 0);
    for (const Json& scene : summary["broken_scenes"])
      CHECK(scene["replay"].get<std::string>().starts_with("pcphys wild " + summary["family"].get<std::string>() +
                                                           " --seed "));
  }
  CHECK(ran.code == (broken ? 1 : 0));
}

TEST_CASE("wild: one seed is the same scene each time, and its exit code says whether it holds") {
  for (const char* arguments : {"wild encounter --seed 1", "wild passing --seed 1 --precision double"}) {
    CAPTURE(std::string(arguments));
    const Ran first = command(arguments), second = command(arguments);
    CHECK(first.out == second.out);
    CHECK(first.code == second.code);
    CHECK(first.code == (first.out.find("BROKEN") != std::string::npos ? 1 : 0));
    for (const char* name : {"energy", "lost", "frozen", "not_finite", "bits"}) {
      CAPTURE(std::string(name));
      CHECK(first.out.find(std::string("  ") + name + " ") != std::string::npos);
    }
  }
}

TEST_CASE("wild: a seed of a longer run is the scene that --seed plays") {
  const Json run = command("wild encounter --seed 5 --count 4 --bits 0 --json -").json();
  REQUIRE(run["summaries"].size() == 1);
  const Json most = measure(run["summaries"][0], "energy");
  const Json single = command("wild encounter --seed " + std::to_string(most["seed"].get<int>()) + " --json -").json();
  CHECK(measure(single["summaries"][0], "energy")["worst"] == most["worst"]);
}

TEST_CASE("wild: for people, as CSV, the list, and nothing to shrink") {
  const Ran text = command("wild encounter --count 3");
  CHECK(text.out.find("99.9 %") != std::string::npos);
  const Ran csv = command("wild encounter --count 3 --csv -");
  CHECK(csv.out.starts_with("engine,family,precision,measure,runs,broken,"));
  const Ran list = command("wild --list");
  CHECK(list.code == 0);
  for (const char* name : {"encounter", "passing", "floor", "pile", "tower", "joints", "springs", "ragdolls", "host"}) {
    CAPTURE(std::string(name));
    CHECK(list.out.find(name) != std::string::npos);
  }
  const Ran shrunk = command("wild encounter --seed 1 --shrink");
  if (shrunk.code == 0) CHECK(shrunk.error.find("nothing broke") != std::string::npos);
  if (shrunk.code == 1) CHECK(shrunk.out.find("#include \"pcphys/pcphys.h\"") != std::string::npos);
}
