// The smallest scene that still breaks, by delta debugging (A. Zeller, R. Hildebrandt, Simplifying and isolating
// failure-inducing input, 2002) over the calls: fewer steps, fewer calls, a later start, simpler calls.
//
// Some faults are told by what should have been: a body that touches nothing keeps its speed, a tower stands, nothing
// is lost. Taking out what a body stands on makes such a fault out of a right motion. There only islands go that never
// met the rest, and of a tower what was built last.
#include "wild/shrink.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "wild/simplify.h"

namespace pcphys::wild {
namespace {

/// Overlaps at the start may grow by so much [m]: positions are floats.
constexpr double no_overlap = 1e-6;
/// Joints may be made open by so much more [m].
constexpr double no_gap = 1e-4;
constexpr int most_rounds = 4;

/// Bodies that move and touch or hold each other in any step are one island; the fixed ones that an island touches are
/// told beside.
class Islands : public Watcher {
 public:
  void after_call(const Player& player, const Call& call, const Status&) override {
    each_made(call, [&](Object object, int number) {
      if (object == Object::body) numbers_[player.body(number)] = number;
    });
    const MakeJoint* joint = std::get_if<MakeJoint>(&call);
    const MakeSpring* spring = std::get_if<MakeSpring>(&call);
    if (joint) meet(player, joint->a, joint->b);
    if (spring) meet(player, spring->a, spring->b);
    const MakeRagdoll* ragdoll = std::get_if<MakeRagdoll>(&call);
    for (int i = 1; ragdoll && i < int(ragdoll->def.bones.size()); i++)
      meet(player, ragdoll->first_body, ragdoll->first_body + i);
  }
  bool after_step(const Player& player, double, const StepReport&) override {
    for (const Contact& contact : player.world().contacts()) {
      const auto a = numbers_.find(contact.a), b = numbers_.find(contact.b);
      if (a != numbers_.end() && b != numbers_.end()) meet(player, a->second, b->second);
    }
    return true;
  }
  int island_of(int body) {
    const auto [at, added] = parents_.emplace(body, body);
    if (!added && at->second != body) at->second = island_of(at->second);
    return at->second;
  }
  bool touched(int body) const { return touched_.contains(body); }

 private:
  static bool moves(const Player& player, int body) {
    const auto kind = player.world().kind(player.body(body));
    return body != ground && kind && *kind == BodyKind::dynamic;
  }
  void meet(const Player& player, int a, int b) {
    touched_.insert(a);
    touched_.insert(b);
    if (moves(player, a) && moves(player, b)) parents_[island_of(a)] = island_of(b);
  }

  std::map<BodyId, int> numbers_;
  std::map<int, int> parents_;
  std::set<int> touched_;
};

/// How far the joints are open that calls make: without the steps before them bodies stand elsewhere, and to close a
/// gap is work.
class MadeOpen : public Watcher {
 public:
  void after_call(const Player& player, const Call& call, const Status&) override {
    each_made(call, [&](Object object, int number) {
      if (object != Object::joint) return;
      if (const auto gap = player.world().joint_separation(player.joint(number))) most = std::max(most, *gap);
    });
  }
  double most = 0;
};

class Shrinker {
 public:
  using Progress = std::function<bool(std::size_t, std::uint64_t)>;

  Shrinker(const Scene& scene, const PlayOptions& options, Measure measure, const Progress& progress)
      : best_(scene), options_(options), measure_(measure), progress_(progress) {}

  Scene run() {
    if (!breaks(best_)) return best_;
    take(without(best_, std::vector<bool>(best_.calls.size(), false)));
    overlap_ = deepest_overlap(best_);
    gap_ = widest_gap(best_);
    fewer_steps();
    if (told_by_what_should_be()) {
      fewer_islands();
      if (measure_ == Measure::stand) lower_tower();
      take(with_usual_settings());
      if (measure_ == Measure::free_speed) {
        start_later();
        simplify_calls([](Changes changes) { return changes == Changes::surface; });
      }
    } else {
      for (int round = 0; round < most_rounds && fewer_calls(); round++) {}
      fewer_steps();
      start_later();
      take(with_usual_settings());
      take(without_gravity());
      simplify_calls([](Changes) { return true; });
      fewer_corners();
      shorter_waits();
    }
    fewer_steps();
    return best_;
  }

 private:
  bool told_by_what_should_be() const {
    return measure_ == Measure::free_speed || measure_ == Measure::glide || measure_ == Measure::hop ||
           measure_ == Measure::stand || measure_ == Measure::lost;
  }

  bool breaks(const Scene& scene) {
    Verdict verdict = judge(scene, options_);
    last_ = verdict.steps;
    if (measure_ == Measure::count) return !verdict.failure.empty();
    if (measure_ == Measure::bits) judge_bits(scene, options_, options_.place == Place::gl, verdict);
    last_ = verdict[measure_].step ? verdict[measure_].step : verdict.steps;
    return verdict[measure_].broken();
  }

  /// Takes the scene if it still breaks.
  bool take(Scene scene) {
    if (stopped_) return false;
    if (progress_ && !progress_(best_.calls.size(), count_steps(best_))) stopped_ = true;
    if (stopped_ || !breaks(scene) || widest_gap(scene) > gap_ + no_gap) return false;
    best_ = std::move(scene);
    return true;
  }

  /// The least number of steps, by halving: what has been broken stays broken.
  void fewer_steps() {
    if (measure_ == Measure::overlap) return;  // judged at rest, so the end is as good as the whole
    (void)breaks(best_);
    const std::uint64_t all = count_steps(best_);
    const std::uint64_t worst = last_;
    std::uint64_t works = worst < all && take(cut(best_, worst)) ? worst : all;
    for (std::uint64_t fails = 0; works - fails > 1 && !stopped_;) {
      const std::uint64_t middle = fails + (works - fails) / 2;
      if (take(cut(best_, middle)))
        works = middle;
      else
        fails = middle;
    }
  }

  /// Groups of calls from half of them down to single ones, from the last to the first. True if any went.
  bool fewer_calls() {
    const std::size_t before = best_.calls.size();
    for (std::size_t size = std::max<std::size_t>(before / 2, 1); size > 0 && !stopped_; size /= 2) {
      for (std::size_t end = best_.calls.size(); end > 0 && !stopped_;) {
        const std::size_t begin = end > size ? end - size : 0;
        std::vector<bool> out(best_.calls.size(), false);
        std::fill(out.begin() + std::ptrdiff_t(begin), out.begin() + std::ptrdiff_t(end), true);
        Scene smaller = without(best_, out);
        if (count_steps(smaller) > 0) take(std::move(smaller));
        end = std::min(begin, best_.calls.size());
      }
    }
    return best_.calls.size() < before;
  }

  // ---- faults that are told by what should be ----

  Islands islands_of_best() const {
    Islands islands;
    Player player(best_, options_);
    (void)player.play(&islands);
    return islands;
  }

  /// Marks the calls that make a body for which `goes` says so.
  template <class Goes> std::vector<bool> makers(Goes goes) const {
    std::vector<bool> out;
    for (const Call& call : best_.calls) {
      bool out_it_goes = false;
      each_made(call, [&](Object object, int number) {
        out_it_goes = out_it_goes || (object == Object::body && goes(number));
      });
      out.push_back(out_it_goes);
    }
    return out;
  }

  std::set<int> bodies_that_move() const {
    std::set<int> found;
    for (const Call& call : best_.calls) {
      const MakeBody* make = std::get_if<MakeBody>(&call);
      if (make && make->def.kind != BodyKind::dynamic) continue;
      each_made(call, [&](Object object, int number) {
        if (object == Object::body) found.insert(number);
      });
    }
    return found;
  }

  void fewer_islands() {
    Islands islands = islands_of_best();
    const std::set<int> moving = bodies_that_move();
    std::set<int> all;
    for (const int body : moving) all.insert(islands.island_of(body));
    for (const int island : all)
      take(
          without(best_, makers([&](int body) { return moving.contains(body) && islands.island_of(body) == island; })));
    if (measure_ == Measure::lost) return;  // a wall that did not hold is part of the fault, though nothing touched it
    Islands left = islands_of_best();
    take(without(best_, makers([&](int body) { return !moving.contains(body) && !left.touched(body); })));
  }

  /// What was built last does not carry the rest.
  void lower_tower() {
    const std::set<int> moving = bodies_that_move();
    const std::vector<int> order(moving.begin(), moving.end());
    for (std::size_t stay = 1; stay < order.size() && !stopped_; stay *= 2) {
      const int highest = order[stay - 1];
      if (take(without(best_, makers([&](int body) { return moving.contains(body) && body > highest; })))) return;
    }
  }

  // ---- the same calls, simpler ----

  /// Not where the fault builds up over many steps: there a later start would be a broken one.
  void start_later() {
    constexpr Measure of_one_step[] = {Measure::energy, Measure::momentum, Measure::angular_momentum,
                                       Measure::free_speed, Measure::phantom};
    if (std::find(std::begin(of_one_step), std::end(of_one_step), measure_) == std::end(of_one_step)) return;
    const auto first = std::find_if(best_.calls.begin(), best_.calls.end(),
                                    [](const Call& call) { return std::holds_alternative<Steps>(call); });
    if (first == best_.calls.end()) return;
    const int count = std::get<Steps>(*first).count;
    for (int left = 1; left < count && !stopped_; left *= 2) {
      const auto later = later_start(best_, options_, count - left);
      if (!later) return;
      if (overlaps_no_more(*later) && take(*later)) return;
    }
  }

  bool overlaps_no_more(const Scene& scene) const { return deepest_overlap(scene) <= overlap_ + no_overlap; }

  double widest_gap(const Scene& scene) const {
    MadeOpen made;
    Player player(scene, options_);
    (void)player.play(&made);
    return made.most;
  }

  Scene with_usual_settings() const {
    Scene plain = best_;
    plain.settings = {};
    return plain;
  }
  Scene without_gravity() const {
    Scene plain = best_;
    plain.world.gravity = {};
    return plain;
  }

  /// Whether a joint holds what the call makes: the pin's two ends would come apart if it stood elsewhere.
  bool is_held(const Call& call) const {
    std::set<int> made;
    each_made(call, [&](Object object, int number) {
      if (object == Object::body) made.insert(number);
    });
    return std::any_of(best_.calls.begin(), best_.calls.end(), [&](const Call& other) {
      const MakeJoint* joint = std::get_if<MakeJoint>(&other);
      return joint && (made.contains(joint->a) || made.contains(joint->b));
    });
  }

  void simplify_calls(bool (*allowed)(Changes)) {
    for (std::size_t i = 0; i < best_.calls.size(); i++)
      for (const Simplification& way : simplifications()) {
        if (stopped_) return;
        Scene simpler = best_;
        if (!allowed(way.changes) || !way.apply(simpler.calls[i])) continue;
        if (way.changes == Changes::place && (is_held(best_.calls[i]) || !overlaps_no_more(simpler))) continue;
        take(std::move(simpler));
      }
  }

  void fewer_corners() {
    for (std::size_t i = 0; i < best_.calls.size(); i++) {
      const MakeBody* make = std::get_if<MakeBody>(&best_.calls[i]);
      if (!make || make->def.shapes.size() != 1) continue;
      for (std::size_t corner = make->def.shapes[0].convex.vertices().size(); corner-- > 0 && !stopped_;) {
        const auto simpler = without_corner(best_, i, corner);
        if (simpler && overlaps_no_more(*simpler)) take(*simpler);
      }
    }
  }

  /// Fewer steps between calls.
  void shorter_waits() {
    for (std::size_t i = 0; i < best_.calls.size(); i++) {
      const Steps* steps = std::get_if<Steps>(&best_.calls[i]);
      if (!steps) continue;
      for (int less = steps->count / 2; less > 0 && !stopped_;) {
        Scene shorter = best_;
        std::get<Steps>(shorter.calls[i]).count -= less;
        if (std::get<Steps>(shorter.calls[i]).count < 1 || !take(std::move(shorter))) less /= 2;
      }
    }
  }

  Scene best_;
  const PlayOptions& options_;
  Measure measure_;
  const Progress& progress_;
  double overlap_ = 0, gap_ = 0;
  std::uint64_t last_ = 0;  // step of the last scene judged, after which its measure was worst
  bool stopped_ = false;
};

}  // namespace

Scene shrink(const Scene& scene, const PlayOptions& options, Measure measure,
             const std::function<bool(std::size_t calls, std::uint64_t steps)>& progress) {
  return Shrinker(scene, options, measure, progress).run();
}

}  // namespace pcphys::wild
