// Hands out indices, smallest free first, and generations: which id an object gets depends only on the
// sequence of calls. An index whose generations are used up is not used again.
// Also keeps each index's row in its table.
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "world/memory.h"

namespace pcphys {

class IdPool {
 public:
  struct Slot {
    std::uint32_t generation = 0, row = 0;
    bool alive = false;
  };
  static constexpr std::uint32_t last_generation = 0xffffffffu;

  explicit IdPool(std::uint32_t world = 1) : world_(world) {}
  /// Memory for so many more ids, and for all to be released.
  void make_room(std::uint32_t more) {
    if (free_.size() < more) pcphys::make_room(slots_, more - free_.size());
    free_.reserve(slots_.capacity());
  }
  /// As if the id had not been allocated; of several the last first.
  void take_back(std::uint32_t index) {
    if (slots_[index].alive) release(index);
    if (--slots_[index].generation > 0) return;
    std::erase(free_, index);
    std::make_heap(free_.begin(), free_.end(), std::greater<>());
    slots_.pop_back();
  }
  std::uint32_t allocate(std::uint32_t row) {
    std::uint32_t index = 0;
    if (free_.empty()) {
      index = std::uint32_t(slots_.size());
      slots_.emplace_back();
    } else {
      std::pop_heap(free_.begin(), free_.end(), std::greater<>());
      index = free_.back();
      free_.pop_back();
    }
    slots_[index].generation++;
    slots_[index].row = row;
    slots_[index].alive = true;
    alive_++;
    return index;
  }
  void release(std::uint32_t index) {
    slots_[index].alive = false;
    alive_--;
    if (slots_[index].generation == last_generation) return;
    free_.push_back(index);
    std::push_heap(free_.begin(), free_.end(), std::greater<>());
  }
  template <class Id> bool valid(Id id) const {
    return id.index < slots_.size() && slots_[id.index].alive && slots_[id.index].generation == id.generation &&
           id.world == world_;
  }
  template <class Id> Id id(std::uint32_t index) const { return {index, slots_[index].generation, world_}; }
  std::uint32_t row(std::uint32_t index) const { return slots_[index].row; }
  void set_row(std::uint32_t index, std::uint32_t row) { slots_[index].row = row; }
  bool alive(std::uint32_t index) const { return slots_[index].alive; }
  std::uint32_t generation(std::uint32_t index) const { return slots_[index].generation; }
  // for tests
  void set_generation(std::uint32_t index, std::uint32_t generation) { slots_[index].generation = generation; }
  std::uint32_t size() const { return std::uint32_t(slots_.size()); }  // indices ever used
  std::uint32_t count() const { return alive_; }
  const std::vector<std::uint32_t>& free_indices() const { return free_; }  // as the heap has them
  void shrink() {
    slots_.shrink_to_fit();
    free_.shrink_to_fit();
  }
  std::size_t memory_bytes() const { return bytes_of(slots_, free_); }

 private:
  std::uint32_t world_;
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> free_;  // min-heap
  std::uint32_t alive_ = 0;
};

}  // namespace pcphys
