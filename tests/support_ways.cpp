#include "support_ways.h"

#include <algorithm>

namespace worldtest {
namespace {

struct Way {
  const char* name;
  std::size_t steppers = 1;  // that step it in turns
  int fresh_every = 0;       // before each so manieth step all of them are new; 0: never
  bool restored = false;     // and the world is restored from its own snapshot
  bool changing = false;     // lanes and threads are others in each step
  bool mixed = false;        // so are the places of the stages
};
constexpr Way ways[] = {{.name = "a new stepper each fifth step", .fresh_every = 5},
                        {.name = "two steppers in turns", .steppers = 2},
                        {.name = "two steppers in turns, new each fifth step, other lanes and threads in each",
                         .steppers = 2,
                         .fresh_every = 5,
                         .changing = true},
                        {.name = "restored before each third step", .fresh_every = 3, .restored = true},
                        {.name = "places, lanes and threads that change, two steppers in turns",
                         .steppers = 2,
                         .changing = true,
                         .mixed = true}};

class Run {
 public:
  Run(const Stepped& stepped, const Way& way) : stepped_(stepped), way_(way), world_(stepped.make()) { renew(); }

  std::vector<std::uint64_t> hashes(int steps) {
    std::vector<std::uint64_t> all;
    for (step_ = 0; step_ < steps; step_++) {
      if (step_ > 0 && way_.fresh_every > 0 && step_ % way_.fresh_every == 0) renew();
      Stepper& stepper = steppers_[std::size_t(step_) % steppers_.size()];
      must(stepper.configure(settings()));
      run(world_, stepper, 1);
      all.push_back(world_.hash());
    }
    return all;
  }

 private:
  void renew() {
    if (way_.restored) must(world_.restore(world_.snapshot()));
    steppers_.clear();
    for (std::size_t i = 0; i < way_.steppers; i++) {
      steppers_.emplace_back(settings());
      if (stepped_.give) stepped_.give(steppers_.back(), world_);
    }
  }

  StepSettings settings() const {
    StepSettings s = stepped_.settings;
    s.timings = false;
    s.lanes = 1;
    if (way_.changing) {
      const std::uint32_t widths[] = {1, 4, world_.precision() == Precision::f32 ? 8u : 0u};
      s.lanes = widths[step_ % 3];
      s.threads = 1 + std::uint32_t(step_ / 2) % 2;
    }
    if (way_.mixed) {
      const Mix mix = mixes()[std::size_t(5 * step_ + 3) % 8];  // each of the eight within eight steps
      s.integrate = mix.places[0];
      s.joints = mix.places[1];
      s.impulses = mix.places[2];
    }
    return s;
  }

  const Stepped& stepped_;
  const Way& way_;
  World world_;
  std::vector<Stepper> steppers_;
  int step_ = 0;
};

}  // namespace

void check_same_ways(const Stepped& stepped, int steps, int steps_on_gl) {
  require_gl();
  const auto wanted = Run(stepped, {.name = "one stepper"}).hashes(steps);
  for (const Way& way : ways) {
    const int count = way.mixed ? steps_on_gl : steps;
    const auto found = Run(stepped, way).hashes(count);
    const auto first = std::mismatch(found.begin(), found.end(), wanted.begin()).first - found.begin();
    INFO(way.name << ": the same for " << first << " steps");
    CHECK(first == count);
  }
}

}  // namespace worldtest
