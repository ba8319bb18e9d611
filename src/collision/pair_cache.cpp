#include "collision/pair_cache.h"

#include <bit>
#include <cassert>
#include <limits>
#include <numeric>

#include "collision/radix_sort.h"

namespace pcphys {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
// Nothing is inside the first, so its proxy is looked at in every update; everything is inside the second.
constexpr Aabb nowhere{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
constexpr Aabb everywhere{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};

constexpr float worn_tree = 1.3f;  // growth of the tree's cost above which building anew pays
// Overlaps asked one by one after an overflow, a tenth of a second or so, before a bound must do.
constexpr std::uint64_t ask_at_most = std::uint64_t{1} << 25;

}  // namespace

void PairCache::set_filter(Filter filter, const void* context) {
  filter_ = filter;
  context_ = context;
}

void PairCache::set_margin(float metres, float fraction) {
  margin_ = metres;
  margin_fraction_ = fraction;
}

void PairCache::add(std::uint32_t proxy, bool moves) {
  assert(!has(proxy));
  if (proxy >= state_.size()) {
    state_.resize(proxy + 1, 0);
    fat_.resize(proxy + 1, everywhere);
    index_bits_ = static_cast<unsigned>(std::bit_width(proxy));
  }
  state_[proxy] = static_cast<std::uint8_t>(present | still | fresh | (moves ? State::moves : 0));
  fat_[proxy] = nowhere;
}

void PairCache::remove(std::uint32_t proxy) {
  assert(has(proxy));
  state_[proxy] = 0;
  fat_[proxy] = everywhere;
  someone_left_ = true;
}

void PairCache::set_moves(std::uint32_t proxy, bool moves) {
  assert(has(proxy));
  state_[proxy] = static_cast<std::uint8_t>((state_[proxy] & ~State::moves) | (moves ? State::moves : 0));
  touch(proxy);
}

void PairCache::touch(std::uint32_t proxy) {
  assert(has(proxy));
  fat_[proxy] = nowhere;
}

PairReport PairCache::update(std::span<const Aabb> tight) {
  assert(tight.size() >= state_.size());
  PairReport report;
  find_moved(tight, report);
  set_identity();
  if (moved_.empty() && !someone_left_) return report;

  renew_fat_boxes(tight);
  report.rebuilt = renew_tree();
  if (!collect(report)) {
    restore();
    return report;
  }
  sort_found();
  merge(report);
  settle();
  report.changed = true;
  report.moved = static_cast<std::uint32_t>(moved_.size());
  return report;
}

void PairCache::find_moved(std::span<const Aabb> tight, PairReport& report) {
  moved_.clear();
  for (std::uint32_t i = 0; i < state_.size(); ++i) {
    if (!(state_[i] & present) || (contains(fat_[i], tight[i]) && !outgrown(i, tight[i]))) continue;
    if (valid(tight[i])) {
      moved_.push_back(i);
      continue;
    }
    if (report.refused++ == 0) report.first_refused = i;
    if (state_[i] & entered) someone_left_ = true;
    state_[i] &= static_cast<std::uint8_t>(~entered);
    fat_[i] = nowhere;
  }
}

float PairCache::margin_of(std::uint32_t proxy, const Aabb& tight) const {
  return state_[proxy] & moves ? std::min(margin_, margin_fraction_ * largest_side(tight)) : 0.0f;
}

// A box that was fast had a large tight box, and its fat box stays large when it slows down: such a box would
// keep pairs with everything it once flew past.
bool PairCache::outgrown(std::uint32_t proxy, const Aabb& tight) const {
  return (state_[proxy] & moves) && !contains(grown(tight, 3 * margin_of(proxy, tight)), fat_[proxy]);
}

void PairCache::renew_fat_boxes(std::span<const Aabb> tight) {
  fat_before_.resize(moved_.size());
  for (std::size_t n = 0; n < moved_.size(); ++n) {
    const std::uint32_t i = moved_[n];
    fat_before_[n] = fat_[i];
    fat_[i] = grown(tight[i], margin_of(i, tight[i]));
    if (!(state_[i] & entered)) tree_stale_ = true;
    state_[i] = static_cast<std::uint8_t>((state_[i] | entered) & ~still);
  }
}

// Returns whether it was built anew.
bool PairCache::renew_tree() {
  if (!tree_stale_ && !someone_left_) {
    tree_.refit(fat_, state_);
    if (tree_.growth() <= worn_tree) return false;
  }
  active_.clear();
  for (std::uint32_t i = 0; i < state_.size(); ++i)
    if (state_[i] & entered) active_.push_back(i);
  tree_.build(fat_, active_, state_);
  tree_stale_ = false;
  return true;
}

// The pairs of all that moved into found_. False when they do not fit beside those that are kept.
bool PairCache::collect(PairReport& report) {
  found_.clear();
  // Beyond the capacity the rest is asked one by one for a while; without a filter the tree counts at once.
  std::uint64_t count = 0, patience = filter_ ? ask_at_most : 0;
  const bool all_counted = tree_.pairs([&](std::uint32_t a, std::uint32_t b) {
    const Pair pair{std::min(a, b), std::max(a, b)};
    if (!filter_ || filter_(context_, pair.a, pair.b)) {
      if (++count <= capacity_) found_.push_back(key(pair));
    }
    return count <= capacity_ || patience-- > 0;
  });
  if (count + pairs_.size() <= capacity_) return true;
  const auto kept = static_cast<std::uint64_t>(
      std::count_if(pairs_.begin(), pairs_.end(), [&](const Pair& pair) { return keeps(pair); }));
  if (count + kept <= capacity_) return true;
  report.overflow = true;
  report.pairs_needed = all_counted ? count + kept : tree_.count_pairs();
  report.needed_is_exact = all_counted || !filter_;
  return false;
}

void PairCache::restore() {
  for (std::size_t n = 0; n < moved_.size(); ++n) {
    fat_[moved_[n]] = fat_before_[n];
    state_[moved_[n]] |= still;
  }
  moved_.clear();
  tree_stale_ = true;
}

void PairCache::sort_found() {
  found_scratch_.resize(found_.size());
  const auto key = [](std::uint64_t pair) { return pair; };
  if (radix_sort(found_.data(), found_scratch_.data(), found_.size(), 0, 2 * index_bits_, key) != found_.data())
    found_.swap(found_scratch_);
}

// Old pairs and found ones are both in order. Of an old pair with a moved proxy only the memory is used.
void PairCache::merge(PairReport& report) {
  const std::size_t old_count = pairs_.size(), most = old_count + found_.size();
  // the two lists change places: room for one is room for the other, or every other step would allocate
  next_pairs_.reserve(pairs_.capacity());
  next_previous_.reserve(previous_.capacity());
  next_pairs_.resize(most);
  next_previous_.resize(most);
  Pair* out = next_pairs_.data();
  std::uint32_t *previous = next_previous_.data(), remembered = 0;
  const std::uint64_t index_mask = (std::uint64_t{1} << index_bits_) - 1;
  std::size_t old = 0, count = 0;
  const auto keep_until = [&](std::uint64_t end) {
    for (; old < old_count && key(pairs_[old]) < end; ++old) {
      out[count] = pairs_[old];
      previous[count] = static_cast<std::uint32_t>(old);
      count += keeps(pairs_[old]);
    }
  };
  for (const std::uint64_t found : found_) {
    keep_until(found);
    const Pair pair{static_cast<std::uint32_t>(found >> index_bits_), static_cast<std::uint32_t>(found & index_mask)};
    const bool known = old < old_count && pairs_[old] == pair;
    const bool same = known && !((state_[pair.a] | state_[pair.b]) & fresh);
    out[count] = pair;
    previous[count++] = same ? static_cast<std::uint32_t>(old) : none;
    remembered += same;
    old += known;
  }
  keep_until(~std::uint64_t{0});
  next_pairs_.resize(count);
  next_previous_.resize(count);
  pairs_.swap(next_pairs_);
  previous_.swap(next_previous_);
  report.added = static_cast<std::uint32_t>(found_.size()) - remembered;
  report.removed = static_cast<std::uint32_t>(old_count - (count - report.added));
  identity_ = false;
}

void PairCache::settle() {
  for (const std::uint32_t i : moved_) state_[i] = static_cast<std::uint8_t>((state_[i] | still) & ~fresh);
  someone_left_ = false;
}

void PairCache::set_identity() {
  if (!identity_) std::iota(previous_.begin(), previous_.end(), 0u);
  identity_ = true;
}

}  // namespace pcphys
