// Pins: no family of random scenes breaks more often than it did. Seeds 1 to N of each, the same in every run, two
// minutes in all on one core. What is recorded in tests/data/wild.csv is not what is wanted: it falls with what is
// mended, and never rises. (Six times it did, by single scenes, and by five that lose bodies of host, when others fell;
// the last time by one scene of ragdolls, and by the energy of one of joints, when six of host and three of tower fewer
// broke. Where host changes by roundings alone some 20 scenes of 320 break that did not, and as many hold that broke,
// so 1,280 are played: of fewer, 120, 320, 640 and 960, one to four were once more where of all there were less.)
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "wild/verdict.h"

using namespace pcphys;
using namespace pcphys::wild;

namespace {

struct Record {
  std::string family;
  std::uint64_t scenes = 0;
  std::uint64_t broken = 0, energy = 0, lost = 0;  // at most
};

std::vector<Record> records() {
  std::ifstream file(PCPHYS_SOURCE_DIR "/tests/data/wild.csv");
  std::vector<Record> all;
  std::string line;
  std::getline(file, line);  // the head
  while (std::getline(file, line)) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream fields(line);
    Record r;
    fields >> r.family >> r.scenes >> r.broken >> r.energy >> r.lost;
    REQUIRE(fields);
    all.push_back(r);
  }
  return all;
}

bool loses_bodies(const Verdict& verdict) {
  for (const Measure m : {Measure::lost, Measure::frozen, Measure::not_finite})
    if (verdict[m].broken()) return true;
  return false;
}

}  // namespace

TEST_CASE("no family of random scenes breaks more often than is recorded") {
  constexpr std::uint64_t replayed_every = 64;
  const std::vector<Record> all = records();
  REQUIRE(all.size() == families().size());
  for (const Record& r : all) {
    std::uint64_t broken = 0, energy = 0, lost = 0, other_bits = 0;
    for (std::uint64_t seed = 1; seed <= r.scenes; seed++) {
      const auto scene = draw(r.family, seed);
      REQUIRE(scene);
      Verdict verdict = judge(*scene, {});
      broken += verdict.broken();
      energy += verdict[Measure::energy].broken();
      lost += loses_bodies(verdict);
      if (seed % replayed_every != 0) continue;
      judge_bits(*scene, {}, false, verdict);
      other_bits += verdict[Measure::bits].broken();
    }
    MESSAGE(r.family << "," << r.scenes << "," << broken << "," << energy << "," << lost);
    CHECK(broken <= r.broken);
    CHECK(energy <= r.energy);
    CHECK(lost <= r.lost);
    CHECK(other_bits == 0);
  }
}
