// The narrow phase within a step, as the runner asks for it: of contacts in the order of the backend's blocks.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "collision/detector.h"
#include "step/runner.h"
#include "step/schedule.h"
#include "world/memory.h"

namespace pcphys {

class ContactLooks final : public Collider {
 public:
  ContactLooks(Detector& detector, ColouredSlots& contacts) : detector_(detector), contacts_(contacts) {}
  /// Before a try of the step, once its contacts stand in blocks.
  void look_with(const Detector::Options& options) {
    options_ = options;
    for (Level& level : levels_) level.listed = false;
  }

  void collide(WorldState& s, unsigned octave, bool first, double h) override {
    const Level& level = listed(octave);
    detector_.meet(s, {level.rows, level.places}, octave, first, h, options_);
    list_blocks(level);
  }
  void collide_sent(WorldState& s, unsigned octave, double h) override {
    const Level& level = listed(octave);
    detector_.meet_sent(s, {level.rows, level.places}, octave, h, options_);
    list_blocks(level);
  }
  bool waits() const override { return detector_.waits(); }
  void collide_again(WorldState& s, unsigned octave, bool last, double h) override {
    const Level& level = listed(octave);
    detector_.meet_again(s, {level.rows, level.places}, octave, last, h, options_);
    list_blocks(level);
  }
  std::span<const Range> renewed_blocks() const override { return renewed_; }
  std::span<const Range> struck_blocks() const override { return struck_; }
  std::size_t memory_bytes() const { return bytes_of(levels_, place_of_, some_, renewed_, struck_); }

 private:
  /// The contacts of an octave: rows, their places there in the order of the rows (what looks one after the other read
  /// lies side by side so), and the block of each so many of them.
  struct Level {
    bool listed = false;
    std::vector<std::uint32_t> rows, places, blocks;
    std::size_t memory_bytes() const { return bytes_of(rows, places, blocks); }
  };

  const Level& listed(unsigned octave) {
    if (levels_.size() <= octave) levels_.resize(octave + 1);
    Level& level = levels_[octave];
    if (std::exchange(level.listed, true)) return level;
    const std::uint32_t width = contacts_.width();
    level.rows.clear();
    level.blocks.clear();
    for (const Range& range : contacts_.ranges(octave))
      for (std::uint32_t block = range.begin; block < range.end; block++) {
        const auto rows = contacts_.order().begin() + block * width;
        level.rows.insert(level.rows.end(), rows, rows + width);
        level.blocks.push_back(block);
      }
    list_places(level);
    return level;
  }
  void list_places(Level& level) {
    constexpr std::uint32_t none = 0xffffffffu;
    const std::uint32_t most = level.rows.empty() ? 0 : *std::ranges::max_element(level.rows);
    place_of_.assign(most + 1, none);
    for (std::uint32_t place = 0; place < level.rows.size(); place++) place_of_[level.rows[place]] = place;
    level.places.assign(place_of_.begin() + 1, place_of_.end());
    std::erase(level.places, none);
  }
  void list_blocks(const Level& level) {
    blocks_of(level, detector_.renewed(), renewed_);
    blocks_of(level, detector_.struck(), struck_);
  }
  void blocks_of(const Level& level, std::span<const std::uint32_t> places, std::vector<Range>& ranges) {
    const std::uint32_t width = contacts_.width();
    ranges.clear();
    if (places.empty()) return;
    some_.assign(level.blocks.size(), 0);
    for (const std::uint32_t place : places) some_[place / width] = 1;
    for (std::size_t i = 0; i < some_.size(); i++)
      if (some_[i] != 0) ranges.push_back({level.blocks[i], level.blocks[i] + 1});
  }

  Detector& detector_;
  ColouredSlots& contacts_;
  Detector::Options options_;
  std::vector<Level> levels_;  // by octave, of the step in hand
  std::vector<std::uint32_t> place_of_;
  std::vector<char> some_;  // of blocks
  std::vector<Range> renewed_, struck_;
};

}  // namespace pcphys
