#include "step/schedule.h"

#include <algorithm>

namespace pcphys {

void ColouredSlots::colour(const WorldState& state, std::span<const std::array<std::uint32_t, 2>> ends, std::uint32_t kind) {
  units_.clear();
  priorities_.clear();
  ends_.clear();
  rows_.clear();
  for (std::uint32_t row = 1; row < ends.size(); row++) {
    std::uint32_t ids[2];
    for (int side = 0; side < 2; side++) {
      const BodyRecord& body = state.bodies[ends[row][side]];
      ids[side] = body.index;
      units_.push_back(body.kind == BodyKind::dynamic ? ends[row][side] : Colouring::fixed_unit);
      ends_.push_back(ends[row][side]);
    }
    priorities_.push_back(priority(std::min(ids[0], ids[1]), std::max(ids[0], ids[1]), kind));
    rows_.push_back(row);
  }
  colouring_.build(std::uint32_t(state.bodies.size()), units_, priorities_);
  width_ = 0;
}

void ColouredSlots::pack(std::uint32_t width) {
  if (width_ == width) return;
  width_ = width;
  version_++;
  pack_slots(colouring_, width, ends_, rows_, slots_);
}

void Schedule::update_structure(const WorldState& state) {
  bodies.clear();
  drag = gyroscopic = false;
  for (std::uint32_t row = 1; row < state.bodies.size(); row++) {
    if (state.bodies[row].kind == BodyKind::fixed) continue;
    bodies.push_back(row);
    drag |= state.tables.get(Buffer::force, row, 3) > 0 || state.tables.get(Buffer::force, row, 7) > 0;
    const Vec3 inverse = state.tables.get3(Buffer::mass, row, 4);
    gyroscopic |= inverse.x != inverse.y || inverse.y != inverse.z;
  }
  moving = std::uint32_t(bodies.size());
  bodies.resize((bodies.size() + padding - 1) / padding * padding, 0);
  bodies_version++;
  joint_ends_.assign(state.joints.size(), {0, 0});
  for (std::uint32_t row = 1; row < state.joints.size(); row++)
    joint_ends_[row] = {state.body_ids.row(state.joints[row].body_a), state.body_ids.row(state.joints[row].body_b)};
  joints.colour(state, joint_ends_, 0);
}

}  // namespace pcphys
