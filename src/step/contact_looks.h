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
    detector_.meet(s, {rows_, places_}, octave, first, h, options_);
    list_blocks();
  }
  void find_missed(WorldState& s, unsigned octave, double h) override {
    list_rows(octave);
    detector_.find_missed(s, {rows_, places_}, octave, h, options_);
    list_blocks();
  }
  bool waits() const override { return detector_.waits(); }
  void collide_again(WorldState& s, unsigned octave, bool last, double h) override {
    detector_.meet_again(s, {rows_, places_}, octave, last, h, options_);
    list_blocks();
  }
  std::span<const Range> renewed_blocks() const override { return renewed_; }
  std::span<const Range> struck_blocks() const override { return struck_; }
  std::size_t memory_bytes() const { return bytes_of(rows_, places_, place_of_, blocks_, some_, renewed_, struck_); }

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
    list_places();
  }
  /// In the order of rows, so that what looks one after the other read lies side by side.
  void list_places() {
    constexpr std::uint32_t none = 0xffffffffu;
    const std::uint32_t most = rows_.empty() ? 0 : *std::ranges::max_element(rows_);
    place_of_.assign(most + 1, none);
    for (std::uint32_t place = 0; place < rows_.size(); place++) place_of_[rows_[place]] = place;
    places_.assign(place_of_.begin() + 1, place_of_.end());
    std::erase(places_, none);
  }
  void list_blocks() {
    blocks_of(detector_.renewed(), renewed_);
    blocks_of(detector_.struck(), struck_);
  }
  /// Of places in `rows_`.
  void blocks_of(std::span<const std::uint32_t> places, std::vector<Range>& ranges) {
    const std::uint32_t width = contacts_.width();
    ranges.clear();
    if (places.empty()) return;
    some_.assign(blocks_.size(), 0);
    for (const std::uint32_t place : places) some_[place / width] = 1;
    for (std::size_t i = 0; i < some_.size(); i++)
      if (some_[i] != 0) ranges.push_back({blocks_[i], blocks_[i] + 1});
  }

  Detector& detector_;
  ColouredSlots& contacts_;
  Detector::Options options_;
  // of the sub-step in hand: rows of contacts, their places there, the block of each so many of them
  std::vector<std::uint32_t> rows_, places_, place_of_, blocks_;
  std::vector<char> some_;  // of blocks
  std::vector<Range> renewed_, struck_;
};

}  // namespace pcphys
