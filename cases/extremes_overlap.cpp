// C8, C9: bodies that start inside one another, up to the very same place.
#include <algorithm>

#include "parts.h"

namespace pcphys::cases {
namespace {

// ---- C8 ------------------------------------------------------------------------------------------------

/// Speeds are those of places, since what undoes an overlap is no motion and shows in no velocity. Two that part keep
/// to the limit; what lies between others is pushed by all of them.
class Places {
 public:
  explicit Places(const Simulated& run) : before_(places(run)) {}
  /// How fast each body went in the last step [m/s].
  std::vector<Vec3> speeds(const Simulated& run, double dt) {
    std::vector<Vec3> now = places(run), way(now.size());
    for (std::size_t i = 0; i < now.size(); ++i) way[i] = (1 / dt) * (now[i] - before_[i]);
    before_ = std::move(now);
    return way;
  }

 private:
  static std::vector<Vec3> places(const Simulated& run) {
    std::vector<Vec3> all;
    for (int i = 0; i < run.bodies(); ++i) all.push_back(run.pose(i).position);
    return all;
  }
  std::vector<Vec3> before_;
};

void two_boxes(Trial& trial, double overlap) {
  Simulated& run = trial.start([=](scenes::Builder& builder) {
    add_block(builder, {0.5, 0.5, 0.5}, 1, {});
    add_block(builder, {0.5, 0.5, 0.5}, 1, {{1 - overlap, 0, 0}, {}});
  });
  const double push = StepSettings{}.push_speed;
  Worst speed;
  bool apart = false;
  Places places(run);
  for (long k = 0; k < trial.steps(2); ++k) {
    run.step(trial.dt());
    const std::vector<Vec3> way = places.speeds(run, trial.dt());
    speed.add(length(way[1] - way[0]));
    const Vec3 d = run.pose(1).position - run.pose(0).position;
    apart = std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)}) > 1 - 0.005;
  }
  trial.report("speed apart [m/s]", speed, 1.01 * push);
  trial.report("overlap after 2 s", apart ? 0 : 1, 0.0);
  trial.report("energy at the end [J]", kinetic_energy(run), 0.25 * push * push);  // half of a kg at the limit
}

void pyramid(Trial& trial) {
  const int base = 4;
  const double overlap = 0.25;
  Simulated& run = trial.start([=](scenes::Builder& builder) {
    (void)builder.world().set_gravity(down);
    builder.set_material(0.6, 0);
    add_floor(builder);
    add_pyramid(builder, {.base = base, .overlap = overlap});
  });
  const double push = StepSettings{}.push_speed;
  // each that lies on another is lifted by what the two overlap, and by what those below are
  double lifted = 0;
  for (int row = 0; row < base; ++row) lifted += (base - row) * (row + 0.5) * overlap;
  Worst speed;
  Places places(run);
  for (long k = 0; k < trial.steps(2); ++k) {
    run.step(trial.dt());
    const std::vector<Vec3> way = places.speeds(run, trial.dt());
    for (std::size_t i = 1; i < way.size(); ++i) speed.add(way[i].z);
  }
  trial.report("speed upwards [m/s]", speed, base * push);
  trial.report("overlap after 2 s [m]", deepest_contact(run.problem().world), 0.01);
  trial.report("kinetic energy at the end [J]", kinetic_energy(run), 2 * gravity * lifted + 0.5 * push * push);
  trial.report("not finite", nonfinite(run), 0.0);
}

void ten_spheres(Trial& trial) {
  Simulated& run = trial.start([](scenes::Builder& builder) {
    scenes::Random random(8);
    for (int i = 0; i < 10; ++i) {
      const double x = random.between(-0.1, 0.1), y = random.between(-0.1, 0.1), z = random.between(-0.1, 0.1);
      add_ball(builder, 0.5, 1, {x, y, z});
    }
  });
  const double push = StepSettings{}.push_speed;
  Worst speed;
  Places places(run);
  for (long k = 0; k < trial.steps(2); ++k) {
    run.step(trial.dt());
    for (const Vec3& way : places.speeds(run, trial.dt())) speed.add(length(way));
  }
  trial.report("speed [m/s]", speed, 10 * push);
  trial.report("overlap after 2 s [m]", deepest_contact(run.problem().world), 0.01);
  trial.report("kinetic energy at the end [J]", kinetic_energy(run), 10 * 0.5 * push * push);  // of each at the limit
  trial.report("not finite", nonfinite(run), 0.0);
}

// ---- C9 ------------------------------------------------------------------------------------------------

/// `count` bodies in one place, twice: they end finite, and both times in the same state.
void coincident(Trial& trial, int count, bool boxes, long steps) {
  std::uint64_t hashes[2] = {};
  Worst speed;
  double bad = 0;
  for (std::uint64_t& hash : hashes) {
    Simulated& run = trial.start([=](scenes::Builder& builder) {
      for (int i = 0; i < count; ++i) {
        if (boxes)
          add_block(builder, {0.5, 0.5, 0.5}, 1, {});
        else
          add_ball(builder, 0.5, 1, {});
      }
    });
    run.step(trial.dt(), steps);
    hash = run.hash();
    bad = std::max(bad, nonfinite(run));
    for (int i = 0; i < count; ++i) speed.add(length(run.velocity(i)));
  }
  trial.report("not finite", bad, 0.0);
  trial.report("hashes that differ", hashes[0] == hashes[1] ? 0 : 1, 0.0);
  trial.report("speed [m/s]", speed, count * StepSettings{}.push_speed);
}

}  // namespace

void add_overlaps(std::vector<Case>& cases) {
  const std::vector<double> frame{1.0 / 60};
  Case& deep = cases.emplace_back(Case{"C8", "deep overlap at the start", {}});
  for (int percent : {25, 50, 90, 99})
    deep.variants.push_back({.name = "two boxes, " + std::to_string(percent) + " %",
                             .run = [=](Trial& t) { two_boxes(t, 0.01 * percent); },
                             .steps = {1.0 / 60, 1.0 / 240},
                             .substeps = {4}});
  deep.variants.push_back({.name = "pyramid", .run = pyramid, .steps = frame, .substeps = {4}});
  deep.variants.push_back({.name = "10 spheres", .run = ten_spheres, .steps = frame, .substeps = {4}});

  Case& same = cases.emplace_back(Case{"C9", "bodies with the same pose", {}});
  for (bool boxes : {false, true})
    for (int count : {2, 10, 1000})
      same.variants.push_back({.name = std::to_string(count) + (boxes ? " boxes" : " spheres"),
                               .run = [=](Trial& t) { coincident(t, count, boxes, count == 1000 ? 3 : 120); },
                               .steps = frame,
                               .substeps = {4}});
}

}  // namespace pcphys::cases
