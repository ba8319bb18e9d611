#include "collision/kd_tree.h"

#include <bit>

#include "collision/radix_sort.h"

namespace pcphys {
namespace {

constexpr int axis_bits = 21;  // of the wide code; the narrow one is its upper 10
constexpr float axis_cells = 2097152.0f;

// b20 ... b1 b0 becomes b20 0 0 ... b1 0 0 b0.
std::uint64_t spread_wide(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x001f00000000ffffu;
  bits = (bits | bits << 16) & 0x001f0000ff0000ffu;
  bits = (bits | bits << 8) & 0x100f00f00f00f00fu;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3u;
  return (bits | bits << 2) & 0x1249249249249249u;
}

// The same of 10 bits.
std::uint32_t spread(std::uint32_t bits) {
  bits = (bits | bits << 16) & 0x030000ffu;
  bits = (bits | bits << 8) & 0x0300f00fu;
  bits = (bits | bits << 4) & 0x030c30c3u;
  return (bits | bits << 2) & 0x09249249u;
}

float centre(const Aabb& box, int axis) { return 0.5f * box.min[axis] + 0.5f * box.max[axis]; }

// Outside the frame counts as its rim.
std::uint32_t cell(float centre, float origin, float cells_per_metre) {
  const float at = (centre - origin) * cells_per_metre;
  if (!(at > 0)) return 0;
  return at < axis_cells ? static_cast<std::uint32_t>(at) : (1u << axis_bits) - 1;
}

// Level of a split that two neighbours in Morton order force: what differs first in their codes, or in their
// positions when the codes are equal. Deeper splits have lower levels, and each level occurs once on a path.
unsigned split_level(std::uint64_t difference, std::size_t position) {
  return difference != 0 ? 32 + std::bit_width(difference) : std::bit_width(position ^ (position + 1));
}

constexpr unsigned top_level = 128;  // above every split

}  // namespace

void KdTree::build(std::span<const Aabb> boxes, std::span<const std::uint32_t> active,
                   std::span<const std::uint8_t> flags) {
  bounded_.clear();
  large_.clear();
  refused_.clear();
  for (const std::uint32_t i : active)
    (!valid(boxes[i]) ? refused_ : bounded(boxes[i]) ? bounded_ : large_).push_back(i);
  const Scene scene = measure(boxes);
  set_aside_large(boxes, scene);
  sort_codes(boxes, scene.frame);
  wide_ = many_ties();
  if (wide_) {
    sort_wide_codes(boxes, scene.frame);
    const WideCode* codes = wide_codes_.data();
    emit(
        boxes, flags, [=](std::size_t i) { return codes[i].index; },
        [=](std::size_t i) { return split_level(codes[i].code ^ codes[i + 1].code, i); });
  } else {
    const std::uint64_t* codes = codes_.data();
    emit(
        boxes, flags, [=](std::size_t i) { return static_cast<std::uint32_t>(codes[i]); },
        [=](std::size_t i) { return split_level(codes[i] >> 32 ^ codes[i + 1] >> 32, i); });
  }
  built_cost_ = cost_;
}

// The frame is the cube over the centres, without what lies further out than the middle 97 % are wide: a
// body that fell out of the world must not put all others into one cell. Quantiles are those of a sample.
KdTree::Scene KdTree::measure(std::span<const Aabb> boxes) {
  constexpr std::size_t most = 128;
  std::array<std::array<float, most>, 4> sample;
  const std::size_t count = std::min(most, bounded_.size()), rank = count / 64;
  Scene scene{};
  if (count == 0) return scene;
  float first[3], last[3];
  for (int k = 0; k < 3; ++k) first[k] = last[k] = centre(boxes[bounded_[0]], k);
  for (const std::uint32_t i : bounded_) {
    for (int k = 0; k < 3; ++k) {
      const float at = centre(boxes[i], k);
      first[k] = std::min(first[k], at);
      last[k] = std::max(last[k], at);
    }
  }
  for (std::size_t s = 0; s < count; ++s) {
    const Aabb& box = boxes[bounded_[s * bounded_.size() / count]];
    for (int k = 0; k < 3; ++k) sample[k][s] = centre(box, k);
    sample[3][s] = largest_side(box);
  }
  const auto ranked = [&](int k, std::size_t r) {
    std::nth_element(sample[k].begin(), sample[k].begin() + r, sample[k].begin() + count);
    return sample[k][r];
  };
  for (int k = 0; k < 3; ++k) {
    const float low = ranked(k, rank), high = ranked(k, count - 1 - rank), width = high - low;
    scene.frame.origin[k] = std::max(first[k], low - width);
    scene.side = std::max(scene.side, std::min(last[k], high + width) - scene.frame.origin[k]);
  }
  scene.frame.cells_per_metre = scene.side > 0 ? axis_cells / scene.side : 0;
  scene.typical_side = ranked(3, count / 2);
  return scene;
}

void KdTree::set_aside_large(std::span<const Aabb> boxes, const Scene& scene) {
  float limit = std::max(0.25f * scene.side, 8 * scene.typical_side);
  const auto is_large = [&](std::uint32_t i) { return largest_side(boxes[i]) > limit; };
  while (std::count_if(bounded_.begin(), bounded_.end(), is_large) > static_cast<std::ptrdiff_t>(max_large)) limit *= 2;
  for (const std::uint32_t i : bounded_)
    if (is_large(i)) large_.push_back(i);
  std::erase_if(bounded_, is_large);
}

void KdTree::sort_codes(std::span<const Aabb> boxes, const Frame& frame) {
  codes_.resize(bounded_.size());
  codes_scratch_.resize(bounded_.size());
  for (std::size_t n = 0; n < bounded_.size(); ++n) {
    std::uint32_t code = 0;
    for (int k = 0; k < 3; ++k)
      code |= spread(cell(centre(boxes[bounded_[n]], k), frame.origin[k], frame.cells_per_metre) >> (axis_bits - 10))
              << (2 - k);
    codes_[n] = std::uint64_t{code} << 32 | bounded_[n];
  }
  const auto key = [](std::uint64_t code) { return code; };
  if (radix_sort(codes_.data(), codes_scratch_.data(), codes_.size(), 32, 62, key) != codes_.data())
    codes_.swap(codes_scratch_);
}

bool KdTree::many_ties() const {
  std::size_t ties = 0;
  for (std::size_t i = 1; i < codes_.size(); ++i) ties += codes_[i - 1] >> 32 == codes_[i] >> 32;
  return ties * 100 > codes_.size();
}

void KdTree::sort_wide_codes(std::span<const Aabb> boxes, const Frame& frame) {
  wide_codes_.resize(bounded_.size());
  wide_scratch_.resize(bounded_.size());
  for (std::size_t n = 0; n < bounded_.size(); ++n) {
    std::uint64_t code = 0;
    for (int k = 0; k < 3; ++k)
      code |= spread_wide(cell(centre(boxes[bounded_[n]], k), frame.origin[k], frame.cells_per_metre)) << (2 - k);
    wide_codes_[n] = {code, bounded_[n]};
  }
  const auto key = [](const WideCode& item) { return item.code; };
  if (radix_sort(wide_codes_.data(), wide_scratch_.data(), wide_codes_.size(), 0, 63, key) != wide_codes_.data())
    wide_codes_.swap(wide_scratch_);
}

// One pass over the objects in Morton order. Left subtrees whose right side is still open wait on a stack, in
// falling order of level, and a split ends all waiting ones that are deeper.
template <class Index, class Level>
void KdTree::emit(std::span<const Aabb> boxes, std::span<const std::uint8_t> flags, Index index, Level level) {
  struct Open {
    Bundle bundle;
    unsigned level;
  };
  std::array<Open, max_depth + 1> open;
  std::uint32_t height = 0;
  blocks_.clear();
  bounds_.clear();
  reset_sums();
  for (std::size_t i = 0; i < large_.size(); i += BoxBlock::lanes) {
    Bundle bundle{{}, 0, true};
    while (bundle.count < BoxBlock::lanes && i + bundle.count < large_.size())
      bundle.index[bundle.count] = large_[i + bundle.count], ++bundle.count;
    closed(bundle, boxes, flags);
  }
  large_blocks_ = blocks_.size();
  const std::size_t count = bounded_.size();
  for (std::size_t i = 0; i < count; ++i) {
    Bundle bundle{{index(i)}, 1, true};
    const unsigned split = i + 1 < count ? level(i) : top_level;
    while (height > 0 && open[height - 1].level < split) bundle = joined(open[--height].bundle, bundle, boxes, flags);
    open[height++] = {bundle, split};
  }
  if (height > 0) closed(open[0].bundle, boxes, flags);
}

// Both sides into one bundle; what does not fit becomes blocks, the fuller side first.
KdTree::Bundle KdTree::joined(Bundle left, Bundle right, std::span<const Aabb> boxes,
                              std::span<const std::uint8_t> flags) {
  const auto fits = [&] { return left.count + right.count <= BoxBlock::lanes; };
  if (!(left.leaf && right.leaf && fits())) {
    if (left.leaf) left = closed(left, boxes, flags);
    if (right.leaf) right = closed(right, boxes, flags);
  }
  while (!fits()) {
    Bundle& fuller = left.count >= right.count ? left : right;
    fuller = closed(fuller, boxes, flags);
  }
  for (std::uint32_t i = 0; i < right.count; ++i) left.index[left.count++] = right.index[i];
  return left;
}

KdTree::Bundle KdTree::closed(const Bundle& bundle, std::span<const Aabb> boxes, std::span<const std::uint8_t> flags) {
  const std::size_t at = blocks_.size();
  BoxBlock& block = blocks_.emplace_back();
  bounds_.emplace_back();
  for (std::uint32_t l = 0; l < BoxBlock::lanes; ++l) block.index[l] = l < bundle.count ? bundle.index[l] : 0;
  block.count = static_cast<std::uint8_t>(bundle.count);
  block.leaf = bundle.leaf;
  load(at, boxes, flags);
  return {{static_cast<std::uint32_t>(at)}, 1, false};
}

// Boxes and flags of a block, from its objects or from the blocks below it.
void KdTree::load(std::size_t at, std::span<const Aabb> boxes, std::span<const std::uint8_t> flags) {
  BoxBlock& block = blocks_[at];
  const Aabb around = block.load(block.leaf ? boxes.data() : bounds_.data());
  bounds_[at] = around;
  std::uint32_t stills = 0, moveds = 0, mobiles = 0;
  for (std::uint32_t l = 0; l < block.count; ++l) {
    const std::uint32_t i = block.index[l];
    if (block.leaf) {
      const std::uint32_t flag = flags.empty() ? std::uint32_t{mobile} : flags[i];
      stills |= (flag & still) << l;
      moveds |= (~flag & still) << l;
      mobiles |= (flag / mobile & 1) << l;
    } else {
      stills |= std::uint32_t{blocks_[i].still != 0} << l;
      moveds |= std::uint32_t{blocks_[i].moved != 0} << l;
      mobiles |= std::uint32_t{blocks_[i].mobile != 0} << l;
    }
  }
  block.still = static_cast<std::uint8_t>(stills);
  block.moved = static_cast<std::uint8_t>(moveds);
  block.mobile = static_cast<std::uint8_t>(mobiles);
  if (block.leaf)
    objects_ += block.count, moved_ += static_cast<std::size_t>(std::popcount(moveds));
  else
    for (int k = 0; k < 3; ++k) cost_ += around.max[k] - around.min[k];
}

void KdTree::reset_sums() {
  cost_ = 0;
  objects_ = moved_ = 0;
}

void KdTree::refit(std::span<const Aabb> boxes, std::span<const std::uint8_t> flags) {
  reset_sums();
  for (std::size_t i = 0; i < blocks_.size(); ++i) load(i, boxes, flags);
}

namespace {

// What all boxes below a node have in common: `start` is their largest min, `end` their smallest max.
// Two crowds overlap box by box when each starts before the other ends.
struct Crowd {
  float start[3], end[3];
  std::uint64_t count, fixed;
};

Crowd crowd_of(const Aabb& box, bool mobile) {
  return {{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}, 1, mobile ? 0u : 1u};
}

Crowd joined_crowd(const Crowd& a, const Crowd& b) {
  Crowd crowd{{}, {}, a.count + b.count, a.fixed + b.fixed};
  for (int k = 0; k < 3; ++k) crowd.start[k] = std::max(a.start[k], b.start[k]);
  for (int k = 0; k < 3; ++k) crowd.end[k] = std::min(a.end[k], b.end[k]);
  return crowd;
}

bool all_overlap(const Crowd& a, const Crowd& b) {
  bool all = true;
  for (int k = 0; k < 3; ++k) all &= a.start[k] <= b.end[k] && b.start[k] <= a.end[k];
  return all;
}

std::uint64_t crowd_pairs(const Crowd& a, const Crowd& b) { return a.count * b.count - a.fixed * b.fixed; }
std::uint64_t crowd_pairs(const Crowd& a) {
  return (a.count * (a.count - 1) - a.fixed * (a.fixed == 0 ? 0 : a.fixed - 1)) / 2;
}

// Lanes of a block as a crowd of its own.
Crowd crowd_of(const BoxBlock& block) {
  Crowd crowd = crowd_of(block.box(0), block.mobile & 1);
  for (std::uint32_t l = 1; l < block.count; ++l)
    crowd = joined_crowd(crowd, crowd_of(block.box(l), block.mobile >> l & 1));
  return crowd;
}

std::uint64_t count_between(const BoxBlock& a, const BoxBlock& b) {
  int count = 0;
  for (std::uint32_t l = 0; l < a.count; ++l)
    count += std::popcount(overlapping_lanes(b, a, l) & (a.mobile >> l & 1 ? BoxBlock::all : b.mobile));
  return static_cast<std::uint64_t>(count);
}

std::uint64_t count_within(const BoxBlock& a) {  // each twice, and each mobile one with itself
  return (count_between(a, a) - static_cast<std::uint64_t>(std::popcount(a.mobile))) / 2;
}

}  // namespace

std::uint64_t KdTree::count_pairs() const {
  std::vector<Crowd> crowds(blocks_.size());
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    crowds[i] = blocks_[i].leaf ? crowd_of(blocks_[i]) : crowds[blocks_[i].index[0]];
    for (std::uint32_t l = 1; l < blocks_[i].count && !blocks_[i].leaf; ++l)
      crowds[i] = joined_crowd(crowds[i], crowds[blocks_[i].index[l]]);
  }
  std::uint64_t count = 0;
  std::vector<std::array<std::uint32_t, 2>> tasks;
  const auto within = [&](std::uint32_t a) {
    if (all_overlap(crowds[a], crowds[a]))
      count += crowd_pairs(crowds[a]);
    else if (blocks_[a].leaf)
      count += count_within(blocks_[a]);
    else
      tasks.push_back({a, a});
  };
  const auto between = [&](std::uint32_t a, std::uint32_t b) {
    if (!overlap(bounds_[a], bounds_[b])) return;
    if (all_overlap(crowds[a], crowds[b]))
      count += crowd_pairs(crowds[a], crowds[b]);
    else if (blocks_[a].leaf && blocks_[b].leaf)
      count += count_between(blocks_[a], blocks_[b]);
    else
      tasks.push_back({a, b});
  };
  for (std::uint32_t i = 0; i < large_blocks_; ++i) {
    within(i);
    for (std::uint32_t j = 0; j < i; ++j) between(i, j);
    if (has_tree()) between(i, root());
  }
  if (has_tree()) within(root());
  while (!tasks.empty()) {
    const auto [a, b] = tasks.back();
    tasks.pop_back();
    const bool into_a = a == b || (!blocks_[a].leaf && (blocks_[b].leaf || crowds[a].count >= crowds[b].count));
    const BoxBlock& block = blocks_[into_a ? a : b];
    for (std::uint32_t l = 0; l < block.count; ++l) {
      if (a != b)
        between(into_a ? b : a, block.index[l]);
      else
        within(block.index[l]);
      for (std::uint32_t m = 0; m < l && a == b; ++m) between(block.index[l], block.index[m]);
    }
  }
  return count;
}

}  // namespace pcphys
