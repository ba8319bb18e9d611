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

KdTree::Node KdTree::object_node(const Aabb& box, std::uint32_t index, std::span<const std::uint8_t> flags) {
  const std::uint32_t flag = flags.empty() ? std::uint32_t{mobile} : flags[index] & both;
  const std::uint32_t info = flag | ((flag & still) ? 0 : moved_bit) | leaf_bit | normal_bit;
  return {{box.min[0], box.min[1], box.min[2]}, info, {box.max[0], box.max[1], box.max[2]}, index};
}

KdTree::Node KdTree::inner_node(const Node& left, const Node& right, std::uint32_t left_index) {
  Node node;
#if defined(__SSE2__)
  // Built in registers: a store of one lane would stall the next read of all four.
  const __m128 sides = _mm_castsi128_ps(_mm_set_epi32(0, -1, -1, -1));
  const __m128 kept = _mm_castsi128_ps(_mm_set_epi32(both | moved_bit | normal_bit, 0, 0, 0));
  const __m128 a = _mm_load_ps(left.min), b = _mm_load_ps(right.min);
  const __m128 low = _mm_or_ps(_mm_and_ps(_mm_min_ps(a, b), sides), _mm_and_ps(_mm_or_ps(a, b), kept));
  const __m128 high = _mm_and_ps(_mm_max_ps(_mm_load_ps(left.max), _mm_load_ps(right.max)), sides);
  const __m128 link = _mm_castsi128_ps(_mm_slli_si128(_mm_cvtsi32_si128(static_cast<int>(left_index)), 12));
  _mm_store_ps(node.min, low);
  _mm_store_ps(node.max, _mm_or_ps(high, link));
#else
  for (int i = 0; i < 3; ++i) node.min[i] = std::min(left.min[i], right.min[i]);
  for (int i = 0; i < 3; ++i) node.max[i] = std::max(left.max[i], right.max[i]);
  node.info = (left.info | right.info) & (both | moved_bit | normal_bit);
  node.link = left_index;
#endif
  return node;
}

void KdTree::build(std::span<const Aabb> boxes, std::span<const std::uint32_t> active, std::span<const std::uint8_t> flags) {
  bounded_.clear();
  large_.clear();
  refused_.clear();
  for (const std::uint32_t i : active) {
    if (!valid(boxes[i]))
      refused_.push_back(i);
    else if (bounded(boxes[i]))
      bounded_.push_back(i);
    else
      large_.push_back(object_node(boxes[i], i, flags));
  }
  const Scene scene = measure(boxes);
  set_aside_large(boxes, scene, flags);
  sort_codes(boxes, scene.frame);
  wide_ = many_ties();
  if (wide_) {
    sort_wide_codes(boxes, scene.frame);
    const WideCode* codes = wide_codes_.data();
    cut_into_blocks([=](std::size_t i) { return split_level(codes[i].code ^ codes[i + 1].code, i); });
    emit(boxes, flags, [=](std::size_t i) { return codes[i].index; });
  } else {
    const std::uint64_t* codes = codes_.data();
    cut_into_blocks([=](std::size_t i) { return split_level(codes[i] >> 32 ^ codes[i + 1] >> 32, i); });
    emit(boxes, flags, [=](std::size_t i) { return static_cast<std::uint32_t>(codes[i]); });
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

void KdTree::set_aside_large(std::span<const Aabb> boxes, const Scene& scene, std::span<const std::uint8_t> flags) {
  float limit = std::max(0.25f * scene.side, 8 * scene.typical_side);
  const auto is_large = [&](std::uint32_t i) { return largest_side(boxes[i]) > limit; };
  while (std::count_if(bounded_.begin(), bounded_.end(), is_large) > static_cast<std::ptrdiff_t>(max_large)) limit *= 2;
  for (const std::uint32_t i : bounded_)
    if (is_large(i)) large_.push_back(object_node(boxes[i], i, flags));
  std::erase_if(bounded_, is_large);
}

void KdTree::sort_codes(std::span<const Aabb> boxes, const Frame& frame) {
  codes_.resize(bounded_.size());
  codes_scratch_.resize(bounded_.size());
  for (std::size_t n = 0; n < bounded_.size(); ++n) {
    std::uint32_t code = 0;
    for (int k = 0; k < 3; ++k)
      code |= spread(cell(centre(boxes[bounded_[n]], k), frame.origin[k], frame.cells_per_metre) >> (axis_bits - 10)) << (2 - k);
    codes_[n] = std::uint64_t{code} << 32 | bounded_[n];
  }
  const auto key = [](std::uint64_t code) { return code; };
  if (radix_sort(codes_.data(), codes_scratch_.data(), codes_.size(), 32, 62, key) != codes_.data()) codes_.swap(codes_scratch_);
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

// One pass over the objects in Morton order finds every node of the radix tree: left subtrees whose right side
// is still open wait on a stack, in falling order of level, and a split ends all waiting ones that are deeper.
// Here only the sizes of nodes are wanted: those of up to four objects are not divided.
template <class Level> void KdTree::cut_into_blocks(Level level) {
  struct Open {
    std::uint32_t begin, split;
  };
  std::array<Open, max_depth + 1> open;
  std::uint32_t height = 0;
  const auto count = static_cast<std::uint32_t>(bounded_.size());
  cuts_.resize(count);
  std::uint8_t* cuts = cuts_.data();
  for (std::uint32_t i = 0; i < count; ++i) {
    const unsigned here = i + 1 < count ? level(i) : top_level;
    std::uint32_t begin = i;
    while (height > 0 && cuts[open[height - 1].split] < here) {
      const Open& node = open[--height];
      begin = node.begin;
      if (i + 1 - begin <= BoxBlock::lanes) cuts[node.split] = 0;
    }
    cuts[i] = static_cast<std::uint8_t>(here);
    open[height++] = {begin, i};
  }
}

// The same pass over blocks. Nodes come out in post-order, so every inner node finds its children's boxes ready.
template <class Index>
void KdTree::emit(std::span<const Aabb> boxes, std::span<const std::uint8_t> flags, Index index) {
  struct Open {
    std::uint32_t node;
    unsigned level;
  };
  std::array<Open, max_depth + 1> open;
  std::uint32_t height = 0;
  nodes_.clear();
  blocks_.clear();
  cost_ = 0;
  moved_count_ = 0;
  for (std::size_t i = 0; i < bounded_.size(); ++i) {
    BoxBlock& block = blocks_.emplace_back();
    block.count = 0;
    while (cuts_[i] == 0) block.index[block.count++] = index(i++);
    block.index[block.count++] = index(i);
    nodes_.push_back(load_block(static_cast<std::uint32_t>(blocks_.size()) - 1, boxes, flags));
    while (height > 0 && open[height - 1].level < cuts_[i]) {
      const std::uint32_t left = open[--height].node;
      nodes_.push_back(inner_node(nodes_[left], nodes_.back(), left));
      add_cost(nodes_.back());
    }
    open[height++] = {static_cast<std::uint32_t>(nodes_.size()) - 1, cuts_[i]};
  }
}

KdTree::Node KdTree::load_block(std::uint32_t at, std::span<const Aabb> boxes, std::span<const std::uint8_t> flags) {
  BoxBlock& block = blocks_[at];
  const Aabb around = block.load(boxes);
  block.still = 0;
  block.mobile = 0;
  for (std::uint32_t l = 0; l < block.count; ++l) {
    const std::uint32_t flag = flags.empty() ? std::uint32_t{mobile} : flags[block.index[l]];
    block.still |= (flag & still) << l;
    block.mobile |= (flag / mobile & 1) << l;
  }
  const std::uint32_t moved = block.moved();
  moved_count_ += static_cast<std::size_t>(std::popcount(moved));
  const std::uint32_t info = (block.still ? std::uint32_t{still} : 0u) | (block.mobile ? std::uint32_t{mobile} : 0u) | (moved ? moved_bit : 0u);
  return {{around.min[0], around.min[1], around.min[2]}, info | leaf_bit | normal_bit, {around.max[0], around.max[1], around.max[2]}, at};
}

void KdTree::add_cost(const Node& node) {
  for (int k = 0; k < 3; ++k) cost_ += node.max[k] - node.min[k];
}

void KdTree::refit(std::span<const Aabb> boxes, std::span<const std::uint8_t> flags) {
  for (Node& node : large_) node = object_node(boxes[node.link], node.link, flags);
  cost_ = 0;
  moved_count_ = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const std::uint32_t link = nodes_[i].link;
    const bool leaf = nodes_[i].leaf();
    nodes_[i] = leaf ? load_block(link, boxes, flags) : inner_node(nodes_[link], nodes_[i - 1], link);
    if (!leaf) add_cost(nodes_[i]);
  }
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

Crowd joined(const Crowd& a, const Crowd& b) {
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
std::uint64_t crowd_pairs(const Crowd& a) { return (a.count * (a.count - 1) - a.fixed * (a.fixed == 0 ? 0 : a.fixed - 1)) / 2; }

// Lanes of a block as a crowd of its own.
Crowd crowd_of(const BoxBlock& block) {
  Crowd crowd = crowd_of(block.box(0), block.mobile & 1);
  for (std::uint32_t l = 1; l < block.count; ++l) crowd = joined(crowd, crowd_of(block.box(l), block.mobile >> l & 1));
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
  std::vector<Node> nodes(nodes_);
  std::vector<BoxBlock> blocks(blocks_);
  std::vector<Crowd> crowds(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    crowds[i] = nodes[i].leaf() ? crowd_of(blocks[nodes[i].link]) : joined(crowds[nodes[i].link], crowds[i - 1]);

  std::uint64_t count = 0;
  std::vector<std::array<std::uint32_t, 2>> tasks;
  const auto within = [&](std::uint32_t a) {
    if (all_overlap(crowds[a], crowds[a])) count += crowd_pairs(crowds[a]);
    else if (nodes[a].leaf()) count += count_within(blocks[nodes[a].link]);
    else tasks.push_back({a, a});
  };
  const auto between = [&](std::uint32_t a, std::uint32_t b) {
    if (!overlap(nodes[a], nodes[b])) return;
    if (all_overlap(crowds[a], crowds[b])) count += crowd_pairs(crowds[a], crowds[b]);
    else if (nodes[a].leaf() && nodes[b].leaf()) count += count_between(blocks[nodes[a].link], blocks[nodes[b].link]);
    else tasks.push_back({a, b});
  };
  const auto tree = static_cast<std::uint32_t>(nodes.size());
  if (tree > 0) within(tree - 1);
  for (std::uint32_t i = 0; i < large_.size(); ++i) {
    const Node& object = large_[i];
    const Aabb box{{object.min[0], object.min[1], object.min[2]}, {object.max[0], object.max[1], object.max[2]}};
    crowds.push_back(crowd_of(box, object.info & mobile));
    BoxBlock& block = blocks.emplace_back();
    block.count = 1, block.index[0] = 0, block.still = 0, block.mobile = object.info / mobile & 1;
    block.load({&box, 1});
    nodes.push_back(object);
    nodes.back().link = static_cast<std::uint32_t>(blocks.size()) - 1;
    for (std::uint32_t j = 0; j < i; ++j) between(tree + j, tree + i);
    if (tree > 0) between(tree - 1, tree + i);
  }
  while (!tasks.empty()) {
    const auto [a, b] = tasks.back();
    tasks.pop_back();
    if (a == b) {
      within(a - 1), within(nodes[a].link), between(a - 1, nodes[a].link);
    } else if (!nodes[a].leaf() && (nodes[b].leaf() || crowds[a].count >= crowds[b].count)) {
      between(a - 1, b), between(nodes[a].link, b);
    } else {
      between(a, b - 1), between(a, nodes[b].link);
    }
  }
  return count;
}

}  // namespace pcphys
