// Pins islands: label propagation, run on the CPU's kernels with threads, on GL and on a device that visits edges in
// any order, gives exactly the labels of the union-find; a world whose islands a device finds falls asleep and wakes
// with the same bits; the plan says where, with which bytes, and when it is left out.
#include <algorithm>
#include <numeric>
#include <random>

#include "cpu/workers.h"
#include "plan/islands.h"
#include "plan/plan.h"
#include "step/backend.h"
#include "step/island_lists.h"
#include "support_sleep.h"
#include "world/state.h"

using namespace worldtest;

namespace {

using Edges = std::vector<std::array<std::uint32_t, 2>>;

/// So many bodies, whose contacts a test writes itself.
World bodies(std::uint32_t count) {
  World world;
  for (std::uint32_t i = 0; i < count; i++) (void)must(world.create_body(ball({})));
  return world;
}

/// Bodies numbered at random, since a chain in order is easy.
std::vector<std::uint32_t> shuffled(std::uint32_t count, std::mt19937& lots) {
  std::vector<std::uint32_t> rows(count);
  std::iota(rows.begin(), rows.end(), 1u);
  std::ranges::shuffle(rows, lots);
  return rows;
}
Edges chain(const std::vector<std::uint32_t>& rows) {
  Edges edges;
  for (std::size_t i = 0; i + 1 < rows.size(); i++) edges.push_back({rows[i], rows[i + 1]});
  return edges;
}
/// Each body is joined to one before it in the list, or to none: trees of all depths.
Edges forest(const std::vector<std::uint32_t>& rows, std::mt19937& lots) {
  Edges edges;
  for (std::uint32_t i = 1; i < rows.size(); i++)
    if (lots() % 50 != 0) edges.push_back({rows[i], rows[lots() % i]});
  return edges;
}
Edges random_pairs(std::uint32_t count, std::size_t wanted, std::mt19937& lots) {
  Edges edges;
  for (std::size_t i = 0; i < wanted; i++)
    edges.push_back({1 + std::uint32_t(lots() % count), 1 + std::uint32_t(lots() % count)});
  return edges;
}

std::vector<std::pair<std::string, Edges>> graphs(std::uint32_t count) {
  std::mt19937 lots(count);
  std::vector<std::uint32_t> rows(count);
  std::iota(rows.begin(), rows.end(), 1u);
  std::vector<std::pair<std::string, Edges>> all{{"a chain in order", chain(rows)}};
  std::ranges::reverse(rows);
  all.emplace_back("a chain from the end", chain(rows));
  // 1, n, 2, n - 1, ...: neighbours are far apart in number
  for (std::uint32_t i = 0; i < count; i++) rows[i] = i % 2 == 0 ? 1 + i / 2 : count - i / 2;
  all.emplace_back("a chain to and fro", chain(rows));
  for (int i = 0; i < 3; i++) all.emplace_back("a chain in any order", chain(shuffled(count, lots)));
  all.emplace_back("a forest", forest(shuffled(count, lots), lots));
  for (const double share : {0.2, 0.5, 1.0, 3.0})
    all.emplace_back("pairs at random", random_pairs(count, std::size_t(share * count), lots));
  for (auto& [name, edges] : all) std::ranges::shuffle(edges, lots);
  return all;
}

/// Rounds until nothing falls.
int label(Backend& backend, IslandLists& lists) {
  std::vector<std::uint32_t>&ends = lists.ends(), &labels = lists.labels_to_fill();
  must(backend.attach(Buffer::island_ends, ends.data(), ends.size() * 4));
  must(backend.attach(Buffer::island_labels, labels.data(), labels.size() * 4));
  const std::vector<std::byte> info(4096);
  must(backend.set_infos(info.data(), 1));
  must(backend.upload(Buffer::island_ends));
  const std::uint32_t lanes = backend.width();
  const KernelRun start{Kernel::island_start, false, 0, lanes, lists.rows()},
      join{Kernel::island_join, true, 0, lanes, lists.edges()};
  must(backend.run({&start, 1}));
  int rounds = 0;
  do {
    must(backend.run({&join, 1}));
    rounds++;
  } while (must(backend.take_flag(Buffer::island_labels, 0)));
  must(backend.download(Buffer::island_labels));
  must(backend.finish());
  return rounds;
}

/// The rounds where all edges are looked at before any label falls, which no device does worse.
int rounds_at_once(const Edges& edges, std::uint32_t count) {
  std::vector<std::uint32_t> before(count + 1), after(count + 1);
  std::iota(after.begin(), after.end(), 0u);
  int rounds = 0;
  for (; before != after; rounds++) {
    before = after;
    for (const auto& [a, b] : edges) {
      const std::uint32_t lowest = std::min(before[before[a]], before[before[b]]);
      for (const std::uint32_t row : {a, b, before[a], before[b]}) after[row] = std::min(after[row], lowest);
    }
  }
  return rounds;
}

/// The most rounds of all graphs.
int check_labels(Backend& backend, std::uint32_t count) {
  World world = bodies(count);
  WorldState& state = world.state();
  int most = 0;
  for (const auto& graph : graphs(count)) {
    const auto& edges = graph.second;
    INFO(graph.first << ", " << count << " bodies");
    state.contacts.ends = edges;
    Islands islands;
    islands.build(state);
    IslandLists lists;
    lists.list(state);
    if (lists.known()) continue;  // nobody touches anybody
    const int rounds = label(backend, lists);
    CHECK(lists.take());
    most = std::max(most, rounds);
    std::uint32_t different = 0;
    for (std::uint32_t row = 1; row <= count; row++) different += lists.labels()[row] != islands.root(row);
    CHECK(different == 0);
  }
  state.contacts.ends.assign(1, {0, 0});  // the world is whole again
  return most;
}

constexpr std::uint32_t counts[] = {1, 2, 3, 10, 100, 1000, 10000};

struct Told {
  std::uint64_t hash;
  std::uint32_t asleep, islands, fell, woke;
  friend bool operator==(const Told&, const Told&) = default;
};

/// Towers with a joint, a chain and a shot that wakes one of them, asleep and awake.
std::vector<Told> nap(StepSettings settings, Precision precision, int steps) {
  Towers t(3, precision);
  (void)add_chain(t.world, {40, 5, 0}, 3, false, {});
  BodyDef shot = ball({-7, 2.5, 0}, 0.2);
  shot.velocity = {8, 1, 0};
  (void)must(t.world.create_body(shot));
  settings = sleepy(settings);
  settings.sleep_time = 0.15;
  Stepper stepper(settings);
  std::vector<Told> told;
  for (int i = 0; i < steps; i++) {
    const StepReport& report = stepper.step(t.world, frame);
    REQUIRE_MESSAGE(bool(report), report.error.message);
    told.push_back({t.world.hash(), report.asleep, report.islands_asleep, report.fell_asleep, report.woke});
  }
  return told;
}

}  // namespace

TEST_CASE("islands: label propagation gives the labels of the union-find, on the CPU with threads") {
  const Workers workers(3);
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const auto backend = must(make_cpu_backend(precision, 0, &workers));
    for (const std::uint32_t count : counts) CHECK(check_labels(*backend, count) <= 20);
  }
}

TEST_CASE("islands: label propagation gives the labels of the union-find, on GL") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const auto backend = must(make_gl_backend(precision, -1, false));
    for (const std::uint32_t count : counts) {
      const int rounds = check_labels(*backend, count);
      MESSAGE(count << " bodies: at most " << rounds << " rounds");
      CHECK(rounds <= 20);
    }
  }
}

TEST_CASE("islands: rounds grow as the logarithm of the longest chain") {
  int digits = 1;
  for (const std::uint32_t count : {10u, 100u, 1000u, 10000u, 100000u, 1000000u}) {
    int most = 0;
    for (const auto& [name, edges] : graphs(count)) most = std::max(most, rounds_at_once(edges, count));
    MESSAGE(count << " bodies: at most " << most << " rounds where all edges are looked at at once");
    CHECK(most <= 3 + 4 * digits++);
  }
}

TEST_CASE("islands: fixed bodies join nobody, and joints count") {
  World world = bodies(4);
  const BodyId floor = must(world.create_body(fixed_box({0, 0, 0}, {1, 1, 1})));
  const std::vector<BodyId> all = world.bodies();
  (void)must(world.create_joint(pin(all[1], {}, all[3], {})));
  const std::uint32_t fixed = world.state().body_ids.row(floor.index);
  world.state().contacts.ends = {{0, 0}, {1, fixed}, {2, fixed}, {1, 3}};
  IslandLists lists;
  lists.list(world.state());
  CHECK(lists.ends() == std::vector<std::uint32_t>{1, 3, 2, 4});
  CHECK_FALSE(lists.known());
  world.state().contacts.ends.assign(1, {0, 0});  // the world is whole again, for a call
  must(world.destroy(world.joints()[0]));
  world.state().contacts.ends = {{0, 0}, {1, fixed}};
  lists.list(world.state());
  CHECK(lists.known());  // each alone
  world.state().contacts.ends.assign(1, {0, 0});
}

TEST_CASE("islands: equal bits and equal sleepers wherever stages run and islands are found") {
  require_gl();
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const std::vector<Told> wanted = nap({}, precision, 90);
    CHECK(std::ranges::any_of(wanted, [](const Told& t) { return t.fell > 0; }));
    CHECK(std::ranges::any_of(wanted, [](const Told& t) { return t.woke > 0; }));
    CHECK(std::ranges::any_of(wanted, [](const Told& t) { return t.islands > 1; }));
    for (const Mix& mix : mixes()) {
      INFO(mix.text());
      const bool alike = mix.places[0] == mix.places[1] && mix.places[1] == mix.places[2];
      if (precision == Precision::f64 && !alike) continue;
      StepSettings settings = mix.settings();
      settings.islands = Place::gl;
      CHECK((nap(settings, precision, 90) == wanted));
    }
  }
}

TEST_CASE("islands: the plan shows where they are found, what crosses, and when they are left out") {
  require_gl();
  StepSettings settings = sleepy();
  settings.islands = Place::gl;  // and all stages on the CPU
  Towers t(2);
  must(t.stepper.configure(settings));
  const auto kernels = [&](const StepPlan& plan, std::string_view name) {
    return std::ranges::count(plan.entries, name, [](const PlanEntry& e) { return kernel_name(e); });
  };
  run(t.world, t.stepper, 1);
  const StepPlan planned = must(t.stepper.plan_for(t.world, frame));
  CHECK(kernels(planned, "island_start") == 1);
  CHECK(kernels(planned, "island_join") == 2);  // one round, and more while labels fall
  const std::string text = to_text(planned);
  const std::size_t edges = 4 + 1, rows = t.world.body_count() + 1;  // two contacts a tower, a joint; and the ground
  CHECK(text.find("upload island_ends, " + std::to_string(8 * edges) + " bytes") != std::string::npos);
  CHECK(text.find("download island_labels, " + std::to_string(4 * rows) + " bytes") != std::string::npos);
  Stepper fresh(settings);
  CHECK(fresh.step(t.world, frame).transfer_bytes == 8 * edges + 4 * rows);
  const StepReport& report = fresh.step(t.world, frame);  // contacts are the same
  CHECK(report.transfer_bytes == 0);
  CHECK(kernels(fresh.plan(), "island_join") == 0);
  CHECK(std::ranges::any_of(fresh.plan().left_out, [](const LeftOut& l) { return l.what == "islands"; }));
  settings.islands = Place::cpu;
  must(fresh.configure(settings));
  run(t.world, fresh, 1);
  CHECK(std::ranges::none_of(fresh.plan().left_out, [](const LeftOut& l) { return l.what == "islands"; }));
  CHECK(kernels(must(fresh.plan_for(t.world, frame)), "island_start") == 0);
}

TEST_CASE("islands: they may be found elsewhere from one step to the next") {
  require_gl();
  Towers here, there;
  StepSettings settings = sleepy();
  for (int i = 0; i < 60; i++) {
    settings.islands = i / 7 % 2 == 0 ? Place::gl : Place::cpu;
    settings.sleep = i / 20 % 2 == 0 || i > 50;
    StepSettings plain = settings;
    plain.islands = Place::cpu;
    must(there.stepper.configure(settings));
    must(here.stepper.configure(plain));
    run(here.world, here.stepper, 1);
    run(there.world, there.stepper, 1);
    REQUIRE(here.world.hash() == there.world.hash());
  }
}
