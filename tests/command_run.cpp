// Pins: the contract of `pcphys run`: keys and types of the JSON, what goes to which stream, that a run says
// the same thing twice, and the other sub-commands' results.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "command_support.h"

using namespace pcphys::test;

TEST_CASE("run: the JSON has every key of the contract") {
  const Ran ran = command("run balls --count 5 --steps 30 --json -");
  REQUIRE_MESSAGE(ran.code == 0, ran.error);
  const Json json = ran.json();
  REQUIRE(json.is_object());
  for (const char* key : {"scene", "backend", "device", "precision", "hash"}) {
    CAPTURE(std::string(key));
    CHECK(json[key].is_string());
  }
  for (const char* key : {"count", "bodies", "joints", "steps", "substeps", "lanes", "threads", "transfers_bytes",
                          "contacts", "escaped", "nonfinite"}) {
    CAPTURE(std::string(key));
    CHECK(json[key].is_number_integer());
  }
  for (const char* key :
       {"dt", "median_ms", "p99_ms", "max_fps", "min_fps", "max_penetration", "mean_penetration",
        "max_joint_separation", "mean_joint_separation", "energy_start", "energy_end", "kinetic_energy_end"}) {
    CAPTURE(std::string(key));
    CHECK(json[key].is_number());
  }
  CHECK(json["scene"] == "balls");
  CHECK(json["count"] == 5);
  CHECK(json["bodies"] == 10);
  CHECK(json["steps"] == 30);
  CHECK(json["threads"] == 1);
  CHECK(json["stage_backends"] == Json{{"integrate", "cpu"}, {"joints", "cpu"}, {"impulses", "cpu"}});
  CHECK(json["stages"].is_object());
  CHECK(json["stages"].contains("integrate"));
  CHECK(json["left_out"].is_array());
  CHECK_FALSE(json["left_out"].empty());  // there are no joints
  CHECK(json["momentum"].size() == 3);
  CHECK(json["overflow"] == Json::array());
  CHECK(json["hash"].get<std::string>().size() == 18);
  CHECK(json["hash"].get<std::string>().starts_with("0x"));
  CHECK(json["median_ms"].get<double>() > 0);
  CHECK(json["max_fps"].get<double>() >= json["min_fps"].get<double>());
  CHECK(json["p99_ms"].get<double>() >= json["median_ms"].get<double>());
}

TEST_CASE("run: twice the same bits, and other bits for another seed, count, dt or precision") {
  const auto hash = [](const std::string& options) {
    const Ran ran = command("run balls --count 12 --steps 60 --hash " + options);
    CHECK_MESSAGE(ran.code == 0, ran.error);
    CHECK(ran.out.size() == 19);
    return ran.out;
  };
  const std::string first = hash("");
  CHECK(hash("") == first);
  CHECK(hash("--seed 12345") == first);
  CHECK(hash("--lanes 1") == first);
  CHECK(hash("--warmup 10 --timings off") == first);
  CHECK(hash("--dt 0.016666666666666666") == first);
  CHECK(hash("--seed 5") != first);
  CHECK(hash("--dt 1/120") != first);
  CHECK(hash("--substeps 3") != first);
  CHECK(hash("--precision double") != first);
}

TEST_CASE("run: all places of all stages end in the same bits") {
  if (!has_gl()) {
    MESSAGE("no OpenGL here");
    return;
  }
  const auto hash = [](const std::string& options) {
    const Ran ran = command("run ragdolls --count 1 --steps 40 --hash " + options);
    CHECK_MESSAGE(ran.code == 0, ran.error);
    return ran.out;
  };
  const std::string cpu = hash("--backend cpu");
  CHECK(hash("--backend gl") == cpu);
  CHECK(hash("--integrate gl") == cpu);
  CHECK(hash("--joints gl") == cpu);
  CHECK(hash("--backend gl --impulses cpu") == cpu);
  const Json json = command("run balls --count 2 --steps 3 --backend gl --joints cpu --json -").json();
  CHECK(json["backend"] == "mixed");
  CHECK(json["stage_backends"]["joints"] == "cpu");
  CHECK(json["stage_backends"]["impulses"] == "gl");
  CHECK(json["transfers_bytes"].get<long>() > 0);
  CHECK(json["transfers_bytes"].get<long>() == json["uploads_bytes"].get<long>() + json["downloads_bytes"].get<long>());
}

TEST_CASE("run: files, and nothing beside JSON on standard output") {
  Folder folder;
  const std::string json = folder.file("run.json"), csv = folder.file("run.csv");
  const Ran ran = command("run stack --count 2 --steps 12 --poses --json " + json + " --csv " + csv);
  REQUIRE_MESSAGE(ran.code == 0, ran.error);
  CHECK(ran.out.empty());
  CHECK(ran.error.empty());
  const Json result = Json::parse(read_file(json), nullptr, false);
  REQUIRE(result.is_object());
  CHECK(result["bodies_final"].size() == 3);
  CHECK(result["bodies_final"][1]["shape"] == "box");
  CHECK(result["fallen"] == 0);
  const std::string rows = read_file(csv);
  CHECK(rows.starts_with("step,time,ms,"));
  CHECK(std::count(rows.begin(), rows.end(), '\n') == 13);
  const auto columns = std::count(rows.begin(), rows.begin() + std::ptrdiff_t(rows.find('\n')), ',');
  CHECK(std::count(rows.begin(), rows.end(), ',') == 13 * columns);
}

TEST_CASE("run: events, a line of JSON each, the same on GL") {
  const std::string scene = "run balls --count 5 --steps 60 --events -";
  const Ran ran = command(scene);
  REQUIRE_MESSAGE(ran.code == 0, ran.error);
  std::istringstream lines(ran.out);
  std::map<std::string, int> counts;
  for (std::string line; std::getline(lines, line);) {
    const Json event = Json::parse(line, nullptr, false);
    REQUIRE_MESSAGE(event.is_object(), line);
    const std::string kind = event["event"];
    counts[kind]++;
    CHECK(event["step"].is_number_integer());
    CHECK(event["bodies"].is_array());
    if (kind == "hit") CHECK(event["speed"].get<double>() >= 1);
    if (kind == "hit" || kind == "begun") CHECK(event["point"].size() == 3);
  }
  CHECK(counts["moved"] == 60);
  CHECK(counts["begun"] > 0);
  CHECK(counts["ended"] > 0);
  CHECK(counts["hit"] > 0);
  if (has_gl()) CHECK(command(scene + " --backend gl").out == ran.out);
  CHECK(command(scene + " --hash").code == 2);
}

TEST_CASE("run: a table for people when no JSON is asked for") {
  const Ran ran = command("run chain --count 3 --steps 10");
  REQUIRE_MESSAGE(ran.code == 0, ran.error);
  for (const char* word : {"chain 3", "device", "median", "left out", "joints", "energy", "hash"}) {
    CAPTURE(std::string(word));
    CHECK(ran.out.find(word) != std::string::npos);
  }
}

TEST_CASE("run: every scene ends sound after a few steps") {
  const Json list = command("scenes --json -").json();
  REQUIRE(list.size() >= 9);
  for (const Json& scene : list) {
    const std::string name = scene["name"];
    CAPTURE(name);
    const Ran ran = command("run " + name + " --count 3 --steps 20 --json -");
    CHECK_MESSAGE(ran.code == 0, ran.error);
    CHECK(ran.json()["nonfinite"] == 0);
  }
}

TEST_CASE("plan: what is left out, and where kernels run") {
  const Json balls = command("plan balls --count 3 --json -").json();
  REQUIRE(balls.is_object());
  CHECK_FALSE(balls["left_out"].empty());
  for (const Json& item : balls["left_out"]) CHECK_FALSE(item["why"].get<std::string>().empty());
  for (const Json& entry : balls["entries"]) CHECK(entry["place"] == "cpu");
  const Json chain = command("plan chain --count 3 --json -").json();
  const bool joints = std::any_of(chain["entries"].begin(), chain["entries"].end(),
                                  [](const Json& e) { return e.value("stage", "") == "joints"; });
  CHECK(joints);
  CHECK(std::none_of(balls["entries"].begin(), balls["entries"].end(),
                     [](const Json& e) { return e.value("stage", "") == "joints"; }));
  CHECK_FALSE(command("plan balls").out.empty());
  CHECK(command("plan balls --csv -").out.starts_with("kind,place"));
  CHECK(command("plan balls --steps 30 --json -").code == 0);
  const Json gl = command("plan balls --backend gl --device 99 --json -").json();  // a plan is data: it needs no device
  CHECK(gl["entries"][0]["place"] == "gl");
  long up = 0, down = 0;
  for (const Json& entry : gl["entries"])
    if (entry.contains("bytes")) (entry["kind"] == "upload" ? up : down) += entry["bytes"].get<long>();
  CHECK(down > 0);
  CHECK(gl["uploads_bytes"] == up);
  CHECK(gl["downloads_bytes"] == down);
  CHECK(balls["uploads_bytes"] == 0);
  const std::string text = command("plan balls --backend gl --device 99").out;
  CHECK(text.find("upload pose, ") != std::string::npos);
  CHECK(text.find("transfers: up to ") != std::string::npos);
}

TEST_CASE("plan: friction, restitution and drag of all bodies, as asked, and what is left out without them") {
  const auto left_out = [](const std::string& options) {
    const Json plan = command("plan balls --count 3 --steps 60 --json - " + options).json();
    std::string all;
    for (const Json& item : plan["left_out"]) all += item["what"].get<std::string>() + ", ";
    return all;
  };
  const std::string own = left_out(""), bare = left_out("--friction 0 --restitution 0"),
                    dragged = left_out("--drag 0.25");
  CHECK(own.find(", friction,") == std::string::npos);
  CHECK(bare.find(", friction,") != std::string::npos);
  CHECK(bare.find("restitution,") != std::string::npos);
  CHECK(own.find("drag,") != std::string::npos);
  CHECK(dragged.find("drag,") == std::string::npos);
  // a ragdoll comes to rest by the damping of its joints, or by drag
  const auto moves = [](const std::string& options) {
    return command("run ragdolls --count 1 --steps 600 --json - " + options).json()["kinetic_energy_end"].get<double>();
  };
  const double damped = moves(""), dragged_doll = moves("--joint-damping 0 --drag 0.5"),
               free_doll = moves("--joint-damping 0");
  CHECK(damped < 1e-4);
  CHECK(dragged_doll < free_doll);
}

TEST_CASE("plan names the buffers of the host's own with their table, bytes and what an element is") {
  const Json plan = command("plan magnets --count 20 --steps 2 --json -").json();
  const Json& bound = plan["buffers"]["bound"];
  const auto pole = std::ranges::find_if(bound, [](const Json& b) { return b["buffer"] == "pole"; });
  REQUIRE(pole != bound.end());
  CHECK((*pole)["table"] == "body");
  CHECK((*pole)["bytes_per_row"] == 4);
  const Json& held = plan["memory"]["buffers"];
  const auto use = std::ranges::find_if(held, [](const Json& b) { return b["buffer"] == "pole"; });
  REQUIRE(use != held.end());
  CHECK((*use)["bytes"] >= 20 * 4);
  bool pairs = false;
  for (const Json& entry : plan["entries"]) pairs |= entry.contains("domain") && entry["domain"] == "pair of bodies";
  CHECK(pairs);
}

TEST_CASE("scenes, doctor, help and version answer") {
  CHECK(command("scenes").out.find("ragdolls") != std::string::npos);
  const Json doctor = command("doctor --json -").json();
  CHECK(doctor["lanes_float"][0] == 1);
  CHECK(doctor["gl"].is_array());
  CHECK(command("doctor").code == 0);
  CHECK(command("--help").code == 0);
  CHECK(command("run --help").out.find("--impulses") != std::string::npos);
  CHECK(command("--version").out.starts_with("pcphys 0."));
}
