#include "sequence.h"

#include <cmath>
#include <memory>
#include <sstream>

#include "world/invariants.h"

namespace fuzz {

using namespace pcphys;

namespace {

std::vector<Twin> draw_twins(Choices& c, bool gl) {
  std::vector<Twin> twins{{.name = "one stepper, one lane"}};
  const Twin others[] = {{.name = "a new stepper each step", .lanes = 1, .fresh_every = 1},
                         {.name = "a new stepper each third step, 8 lanes", .lanes = 0, .fresh_every = 3},
                         {.name = "two steppers in turns", .lanes = 1, .steppers = 2},
                         {.name = "three steppers in turns, 4 lanes", .lanes = 4, .steppers = 3},
                         {.name = "8 lanes", .lanes = 0},
                         {.name = "two threads", .lanes = 0, .threads = 2},
                         {.name = "restored each second step", .lanes = 1, .fresh_every = 2, .restored = true}};
  for (const Twin& twin : others)
    if (c.below(3) == 1) twins.push_back(twin);
  if (twins.size() == 1) twins.push_back(others[0]);
  if (gl) twins.push_back({.name = "gl", .place = Place::gl});
  if (gl && c.below(2))
    twins.push_back({.name = "gl and cpu by turns, two steppers", .place = Place::gl, .steppers = 2, .mixed = true});
  return twins;
}

std::string difference(const Outcome& a, const Outcome& b) {
  std::ostringstream text;
  text.precision(17);
  text << name(a.code) << " and " << name(b.code);
  if (!a.message.empty() || !b.message.empty()) text << " (" << a.message << " | " << b.message << ")";
  if (a.numbers.size() != b.numbers.size())
    text << ", " << a.numbers.size() << " and " << b.numbers.size() << " numbers";
  for (std::size_t i = 0; i < std::min(a.numbers.size(), b.numbers.size()); i++)
    if (!same({ErrorCode::none, {a.numbers[i]}, {}}, {ErrorCode::none, {b.numbers[i]}, {}})) {
      text << ", number " << i << ": " << a.numbers[i] << " and " << b.numbers[i];
      break;
    }
  return text.str();
}

class Sequence {
 public:
  Sequence(Choices& choices, bool gl, Counts& counts) : choices_(choices), counts_(counts) {
    const Precision precision = choices.below(4) ? Precision::f32 : Precision::f64;
    for (Twin& twin : draw_twins(choices, gl)) {
      if (precision == Precision::f64 && twin.lanes > 4) twin.lanes = 4;
      hosts_.push_back(std::make_unique<Host>(twin, precision));
    }
  }

  Finding play() {
    const std::uint32_t rarities[] = {0, 0, 200, 30};
    choices_.set_rarity(rarities[choices_.below(4)]);
    const Theme theme = draw_theme(choices_);
    for (const Call& call : first_calls(choices_, theme))
      if (!make(call)) return found_;
    const std::uint32_t count = 20 + choices_.below(200);
    for (std::uint32_t i = 0; i < count && !choices_.over(); i++)
      if (!make(draw_call(choices_, theme, *hosts_[0]))) return found_;
    return {};
  }

 private:
  bool make(const Call& call) {
    found_.calls.push_back(call.name);
    Outcome first;
    std::uint64_t hash = 0;
    for (const auto& host : hosts_) {
      const bool leads = host == hosts_[0];
      const std::uint64_t before = leads ? host->world.hash() : 0;
      const Outcome outcome = call.make(*host);
      if (const std::string broken = broken_invariant(host->world.state()); !broken.empty())
        return fail(*host, "a broken invariant: " + broken);
      counts_.calls++;
      counts_.steps += call.steps;
      counts_.refused += outcome.code != ErrorCode::none;
      const std::uint64_t after = host->world.hash();
      if (leads) {
        first = outcome;
        hash = after;
        counts_.digest = counts_.digest * 1099511628211ull ^ hash;
        found_.calls.back() += outcome.code == ErrorCode::none ? "" : std::string(": ") + name(outcome.code);
        if (outcome.code != ErrorCode::none && !call.composite && before != after)
          return fail(*host, "a refused call changed the world");
        continue;
      }
      if (!same(first, outcome)) return fail(*host, "another answer: " + difference(first, outcome));
      if (after != hash) return fail(*host, "another hash; " + difference(hosts_[0]->read_all(), host->read_all()));
    }
    return true;
  }

  bool fail(const Host& host, const std::string& what) {
    found_.what = host.twin().name + ": " + what;
    return false;
  }

  Choices& choices_;
  Counts& counts_;
  std::vector<std::unique_ptr<Host>> hosts_;
  Finding found_;
};

}  // namespace

Finding play(Choices& choices, bool gl, Counts& counts) {
  counts.sequences++;
  return Sequence(choices, gl, counts).play();
}

}  // namespace fuzz
