#include "scenes.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <numeric>
#include <random>
#include <utility>

#include "plan/infos.h"
#include "step/processor_state.h"

namespace pcphys::architectures {
namespace {

constexpr std::size_t chain_links = 10;

/// Numbers in [0, 1) that depend on the body alone.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 1) {}
  double next() {  // S. Vigna's splitmix64
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return double((z ^ (z >> 31)) >> 40) / double(1u << 24);
  }
  double about_zero(double most) { return most * (2 * next() - 1); }
  Vec3 vector(double most) { return {about_zero(most), about_zero(most), about_zero(most)}; }

 private:
  std::uint64_t state_;
};

}  // namespace

BodyInit flying_body(std::size_t i) {
  constexpr ShapeKind kinds[] = {ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule};
  Numbers random(i);
  BodyInit body;
  body.shape = kinds[std::size_t(3 * random.next())];
  body.position = random.vector(100);
  body.velocity = random.vector(10);
  body.momentum = random.vector(0.2);
  body.mass = 1 + random.next();
  body.moments = body.shape == ShapeKind::sphere ? Vec3{0.1, 0.1, 0.1} : Vec3{0.1, 0.15, 0.2};
  body.drag = 0.25;
  body.area = 0.1 + random.next();
  return body;
}

namespace {

std::size_t group_size(SceneKind kind) {
  if (kind == SceneKind::chains) return chain_links;
  return kind == SceneKind::pairs || kind == SceneKind::ropes ? 2 : 1;
}

/// Links along x from the chain's place at the ground.
void build_chain(std::size_t chain, Design& design, Handle* made) {
  constexpr double half = 0.1;
  const Vec3 place = Numbers(chain).vector(100);
  for (std::size_t link = 0; link < chain_links; link++) {
    BodyInit body = flying_body(chain * chain_links + link);
    body.shape = ShapeKind::capsule;
    body.position = {place.x + half * double(2 * link + 1), place.y, place.z};
    body.velocity = body.momentum = {};
    body.moments = {0.002, 0.01, 0.01};
    made[link] = design.create_body(body);
    const Vec3 end{half, 0, 0}, start{-half, 0, 0};
    design.create_joint(link == 0 ? design.ground() : made[link - 1], made[link],
                        {link == 0 ? place : end, start, 0.7, 0.5});
  }
}

/// Two balls that forces press together, or that a rope holds in the wind.
void build_pair(SceneKind kind, std::size_t pair, Design& design, Handle* made) {
  constexpr double radius = 0.5, press = 20;
  const Vec3 place = Numbers(pair).vector(100);
  for (std::size_t side = 0; side < 2; side++) {
    BodyInit body = flying_body(2 * pair + side);
    body.shape = ShapeKind::sphere;
    body.moments = {0.1, 0.1, 0.1};
    body.position = {place.x + 2 * radius * double(side), place.y, place.z};
    if (kind == SceneKind::pairs) body.velocity = {}, body.force = {side == 0 ? press : -press, 0, 0};
    made[side] = design.create_body(body);
  }
  if (kind == SceneKind::pairs)
    design.create_contact(made[0], made[1], {{1, 0, 0}, {radius, 0, 0}, 0, 0.5});
  else
    design.create_rope(made[0], made[1], {1.1});
}

void build_group(SceneKind kind, std::size_t group, Design& design, Handle* made) {
  if (kind == SceneKind::chains)
    build_chain(group, design, made);
  else if (group_size(kind) == 2)
    build_pair(kind, group, design, made);
  else
    *made = design.create_body(flying_body(group));
}

}  // namespace

std::string_view name(SceneKind kind) {
  constexpr std::string_view names[] = {"flight", "chains", "pairs", "wind", "ropes"};
  return names[std::size_t(kind)];
}
std::string_view name(History history) { return history == History::fresh ? "fresh" : "churned"; }

std::vector<Handle> build(SceneKind kind, std::size_t count, History history, Design& design) {
  const std::size_t size = group_size(kind), groups = std::max<std::size_t>(1, count / size);
  std::vector<Handle> made(groups * size), others;
  std::vector<std::size_t> order(groups);
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(1);
  if (history == History::churned) {
    std::shuffle(order.begin(), order.end(), random);
    for (std::size_t i = 0; i < made.size(); i++) others.push_back(design.create_body(flying_body(i)));
    std::shuffle(others.begin(), others.end(), random);
  }
  const auto leave = [&](std::size_t remaining) {
    for (; others.size() > remaining; others.pop_back()) design.destroy_body(others.back());
  };
  leave(others.size() / 2);
  for (std::size_t k = 0; k < groups; k++) {
    build_group(kind, order[k], design, &made[order[k] * size]);
    leave(others.size() - std::min(others.size(), size / 2 + k % 2 * (size % 2)));
  }
  leave(0);
  design.settle();
  return made;
}

double wall_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

Steps::Steps(Clock clock) : clock_(clock) {
  fill_infos(InfoInputs(StepSettings{}, {0, -9.81, 0}, substep, substep, substep), infos_);
}

void Steps::step(SceneKind kind, Design& design, StageTimes* times) const {
  const FlushSubnormals flush;
  const bool joints = kind == SceneKind::chains, contacts = kind == SceneKind::pairs, ropes = kind == SceneKind::ropes;
  double before = clock_();
  const auto run = [&](Kernel kernel, Phase phase) {
    design.run(kernel, infos_[std::size_t(phase)]);
    if (times == nullptr) return;
    const double after = clock_();
    (*times)[std::size_t(schema(kernel).stage)] += after - std::exchange(before, after);
  };
  if (ropes || kind == SceneKind::wind) design.run_wind(wind_velocity);
  run(Kernel::begin_drag, Phase::first);
  if (joints || contacts) run(Kernel::inertia, Phase::biased);
  if (contacts) run(Kernel::contact_prepare, Phase::first);
  run(Kernel::remember, Phase::biased);
  run(Kernel::integrate_drag, Phase::biased);
  if (ropes) design.run_ropes(float(1 / substep));
  if (joints) run(Kernel::joint_prepare, Phase::first);
  if (joints) run(Kernel::joint_warm, Phase::biased);
  if (contacts) run(Kernel::contact_warm, Phase::biased);
  if (joints) run(Kernel::joint_solve, Phase::biased);
  if (contacts) run(Kernel::contact_solve, Phase::biased);
  run(Kernel::advance, Phase::biased);
  if (joints) run(Kernel::joint_solve, Phase::relax);
  if (contacts) run(Kernel::contact_solve, Phase::relax);
  if (contacts) run(Kernel::contact_store, Phase::last);
  run(Kernel::synchronise_drag, Phase::relax);
}

}  // namespace pcphys::architectures
