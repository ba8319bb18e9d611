// The narrow phase within a step, as the runner asks for it: of contacts in the order of the backend's blocks.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "collision/detector.h"
#include "step/runner.h"
#include "step/schedule.h"
#include "world/memory.h"

namespace pcphys {

class ContactLooks final : public Collider {
 public:
  ContactLooks(Detector& detector, ColouredSlots& contacts) : detector_(detector), contacts_(contacts) {}
  void look_with(const Detector::Options& options) { options_ = options; }

  void collide(WorldState& s, unsigned octave, bool first, double h) override {
    list_rows(octave);
    detector_.meet(s, rows_, octave, first, h, options_);
    list_blocks();
  }
  void find_missed(WorldState& s, unsigned octave, double h) override {
    list_rows(octave);
    detector_.find_missed(s, rows_, octave, h, options_);
    list_blocks();
  }
  bool waits() const override { return detector_.waits(); }
  void collide_again(WorldState& s, unsigned octave, bool last, double h) override {
    detector_.meet_again(s, rows_, octave, last, h, options_);
    list_blocks();
  }
  std::span<const Range> renewed_blocks() const override { return renewed_; }
  std::span<const Range> struck_blocks() const override { return struck_; }
  std::size_t memory_bytes() const { return bytes_of(rows_, blocks_, some_, renewed_, struck_); }

 private:
  void list_rows(unsigned octave) {
    const std::uint32_t width = contacts_.width();
    rows_.clear();
    blocks_.clear();
    for (const Range& range : contacts_.ranges(octave))
      for (std::uint32_t block = range.begin; block < range.end; block++) {
        const auto rows = contacts_.order().begin() + block * width;
        rows_.insert(rows_.end(), rows, rows + width);
        blocks_.push_back(block);
      }
  }
  void list_blocks() {
    blocks_of(detector_.renewed(), renewed_);
    blocks_of(detector_.struck(), struck_);
  }
  /// Of places in `rows_`.
  void blocks_of(std::span<const std::uint32_t> places, std::vector<Range>& ranges) {
    const std::uint32_t width = contacts_.width();
    some_.assign(places.begin(), places.end());
    for (std::uint32_t& place : some_) place /= width;
    std::ranges::sort(some_);
    ranges.clear();
    for (const std::uint32_t place : some_) {
      const std::uint32_t block = blocks_[place];
      if (ranges.empty() || block >= ranges.back().end) ranges.push_back({block, block + 1});
    }
  }

  Detector& detector_;
  ColouredSlots& contacts_;
  Detector::Options options_;
  // of the sub-step in hand: rows of contacts, the block of each so many of them, and the blocks of some
  std::vector<std::uint32_t> rows_, blocks_, some_;
  std::vector<Range> renewed_, struck_;
};

}  // namespace pcphys
