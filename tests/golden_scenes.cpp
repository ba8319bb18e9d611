// Pins the hashes of scenes after 120 and 600 steps on the CPU (tests/data/golden.csv). They change with every
// change of physics, of what is hashed or of a scene, and with nothing else: a change that was meant to keep
// results, such as another loop, another compiler or another backend, has to pass with the table as it is.
//
// When they may be written anew: when a change of results was meant, and the tests of quality and of closed
// forms pass with it. Then
//   PCPHYS_WRITE_GOLDEN=1 ctest --test-dir build/release -R golden_scenes
// and the new table goes into the commit that changed the physics, with a sentence that says why.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "support_world.h"

using namespace worldtest;

namespace {

struct Case {
  const char* scene;
  int count;
};
constexpr Case cases[] = {{"balls", 60},    {"ragdolls", 8},    {"pyramid", 10}, {"stack", 10},
                          {"chain", 20},    {"chainswing", 20}, {"heavy", 2},    {"door", 1},
                          {"dominoes", 20}, {"hulls", 40},      {"magnets", 72}};

constexpr const char* header =
    "# Hashes of scenes on the CPU: scene,count,precision,steps,hash (steps of 1/60 s, 4 sub-steps).\n"
    "# Written by tests/golden_scenes.cpp, which says when they may be written anew:\n"
    "# PCPHYS_WRITE_GOLDEN=1 ctest --test-dir build/release -R golden_scenes\n"
    "# Start poses are computed with the C library's sine and cosine; the hashes are those of glibc.\n";

std::vector<std::string> table() {
  std::vector<std::string> rows;
  for (const Case& c : cases)
    for (const Precision precision : {Precision::f32, Precision::f64}) {
      SceneWorld s = scene_world(c.scene, c.count, precision);
      Stepper stepper(lanes(0));
      must(scenes::add_kernels(s.scene, s.world, stepper));
      int made = 0;
      for (const int steps : {120, 600}) {
        run(s.world, stepper, steps - made);
        made = steps;
        char row[96];
        std::snprintf(row, sizeof row, "%s,%d,%s,%d,%016llx", c.scene, c.count,
                      precision == Precision::f32 ? "float" : "double", steps,
                      static_cast<unsigned long long>(s.world.hash()));
        rows.push_back(row);
      }
    }
  return rows;
}

}  // namespace

TEST_CASE("golden hashes") {
  const std::string path = PCPHYS_SOURCE_DIR "/tests/data/golden.csv";
  const std::vector<std::string> wanted = table();
  if (std::getenv("PCPHYS_WRITE_GOLDEN")) {
    std::ofstream file(path, std::ios::binary);
    file << header;
    for (const std::string& row : wanted) file << row << "\n";
  }
  std::ifstream file(path);
  REQUIRE_MESSAGE(file, "there is no tests/data/golden.csv; run this test with PCPHYS_WRITE_GOLDEN=1 to write it");
  std::vector<std::string> found;
  for (std::string line; std::getline(file, line);)
    if (!line.empty() && line[0] != '#') found.push_back(line);
  REQUIRE_MESSAGE(found.size() == wanted.size(),
                  "the table has other rows than the test; write it anew with PCPHYS_WRITE_GOLDEN=1");
  for (std::size_t i = 0; i < wanted.size(); i++)
    CHECK_MESSAGE(found[i] == wanted[i],
                  "if this change of physics was meant, write the table anew with PCPHYS_WRITE_GOLDEN=1 (see "
                  "tests/golden_scenes.cpp)");
}
