// How the contents of gl_parity_contents.h lie in memory for CPU lanes and for the GPU, and one kernel run on them.
#pragma once
#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "cpu/kernels.h"
#include "gl_parity_contents.h"
#include "step/backend.h"
#include "step/processor_state.h"

namespace parity {

/// A test must not pass because there was nothing to test: llvmpipe comes with our scripts.
inline std::unique_ptr<Backend> require_gl(Precision precision) {
  Result<std::unique_ptr<Backend>> made = make_gl_backend(precision, -1, false);
  if (!made)
    FAIL("The GL backend is needed by this test (scripts/install-dependencies brings llvmpipe): "
         << made.error().message);
  return std::move(*made);
}

// ---- layouts ----------------------------------------------------------------------------------------
/// Where real `f` of `slot` stands: blocks of `width` slots; the GPU keeps four reals of a slot together.
inline std::size_t place(std::size_t slot, std::size_t f, std::size_t reals, std::size_t width) {
  const std::size_t block = slot / width, lane = slot % width;
  return width == 32 ? ((block * (reals / 4) + f / 4) * width + lane) * 4 + f % 4 : (block * reals + f) * width + lane;
}

inline std::vector<std::uint32_t> pack_ends(const std::vector<std::uint32_t>& logical, std::size_t width) {
  std::vector<std::uint32_t> packed(logical.size());
  for (std::size_t i = 0; i < logical.size(); i++)
    packed[(i / 2 / width * 2 + i % 2) * width + i / 2 % width] = logical[i];
  return packed;
}
template <class Scalar>
std::uint32_t paths_of(Buffer buffer, const State<Scalar>& state, std::size_t width,
                       std::vector<std::uint32_t>& paths) {
  const bool contacts = buffer == Buffer::contact_paths;
  const std::vector<Range>& colours = contacts ? state.contact_colours : state.joint_colours;
  const Buffer ends = contacts ? Buffer::contact_ends : Buffer::joint_ends;
  return pack_paths(state.nodes, std::uint32_t(width), colours[state.tree_colours - 1].end / std::uint32_t(width),
                    pack_ends(state.indices[std::size_t(ends)], width), paths);
}
template <class Scalar>
std::vector<std::uint32_t> pack_indices(Buffer buffer, const State<Scalar>& state, std::size_t width,
                                        const TreeLayout& trees) {
  const std::vector<std::uint32_t>& logical = state.indices[std::size_t(buffer)];
  if (buffer == Buffer::tree_blocks) return trees.lists.blocks;
  if (buffer == Buffer::tree_parents) return trees.lists.parents;
  if (buffer == Buffer::tree_ends) return trees.lists.ends;
  if (buffer == Buffer::tree_order) return trees.lists.order;
  if (buffer == Buffer::contact_paths || buffer == Buffer::joint_paths) {
    std::vector<std::uint32_t> paths;
    paths_of(buffer, state, width, paths);
    return paths;
  }
  return is_ends(buffer) ? pack_ends(logical, width) : logical;
}

/// Where the logical slots of a buffer of rows stand, and how many places there are: with the lanes that pad blocks of
/// trees, and the ways that are shorter than others of their block.
struct SlotLayout {
  std::vector<std::size_t> slots;  // empty: as they come
  std::size_t size = 0;
};
/// Of contact_reach, logically in the order of one lane.
template <class Scalar> SlotLayout lay_out_reach(const State<Scalar>& state, std::size_t width) {
  std::vector<std::uint32_t> single, packed;
  paths_of(Buffer::contact_paths, state, 1, single);
  SlotLayout layout;
  layout.size = paths_of(Buffer::contact_paths, state, width, packed) * width;
  const std::uint32_t count = state.contact_colours[state.tree_colours - 1].end;
  for (std::uint32_t slot = 0; slot < count; slot++) {
    // heads: see tree_path.inl
    const std::uint32_t *own = &single[single[slot]], *block = &packed[packed[slot / width]];
    const auto count = [](const std::uint32_t* head, std::size_t side) {
      return std::size_t{2} * head[4 + side] + head[side];
    };
    // of how the sides meet
    for (std::size_t k = 0; k < 2; k++) layout.slots.push_back((block[7] + k) * width + slot % width);
    for (std::size_t turns = 0; turns < 2; turns++)
      for (std::size_t side = 0; side < 2; side++)
        for (std::size_t k = 0; k < count(own, side); k++) {
          const std::size_t first = block[7] + 2 + turns * (count(block, 0) + count(block, 1)) + side * count(block, 0);
          layout.slots.push_back((first + k) * width + slot % width);
        }
  }
  return layout;
}
template <class Scalar>
SlotLayout layout_of(Buffer buffer, const State<Scalar>& state, std::size_t width, const TreeLayout& trees) {
  if (buffer == Buffer::contact_reach) return lay_out_reach(state, width);
  if (is_tree_rows(buffer)) return {std::vector<std::size_t>(trees.slots.begin(), trees.slots.end()), trees.size};
  return {{}, state.reals[std::size_t(buffer)].size() / std::max(1u, schema(buffer).reals)};
}

/// Copies between logical order and a backend's, for rows of the solver; tables are the same in both.
template <class Scalar>
void copy_reals(Buffer buffer, const Scalar* from, Scalar* to, std::size_t count, std::size_t width,
                const SlotLayout& layout, bool pack) {
  const std::size_t reals = schema(buffer).reals;
  for (std::size_t i = 0; i < count; i++) {
    const std::size_t slot = layout.slots.empty() ? i / reals : layout.slots[i / reals];
    const std::size_t packed = is_rows(buffer) ? place(slot, i % reals, reals, width) : i;
    to[pack ? packed : i] = from[pack ? i : packed];
  }
}

template <class Scalar> std::vector<Range> ranges_of(Kernel kernel, const State<Scalar>& state, std::uint32_t width) {
  const Domain domain = schema(kernel).domain;
  if (of_trees(domain)) return {{0, lay_out(state.trees, width).lists.count()}};
  // whole scenes compare them (tests/joint_drives.cpp, pcphys wild springs --bits-gl)
  if (domain == Domain::net) return {};
  if (domain == Domain::body) return {{0, std::uint32_t(state.indices[std::size_t(Buffer::bodies)].size())}};
  const bool joints = domain == Domain::joint || domain == Domain::free_joint || domain == Domain::tree_joint;
  std::vector<Range> ranges = joints ? state.joint_colours : state.contact_colours;
  if (domain == Domain::free_contact || domain == Domain::free_joint)
    ranges.erase(ranges.begin(), ranges.begin() + state.tree_colours);
  if (domain == Domain::tree_contact || domain == Domain::tree_joint) ranges.resize(state.tree_colours);
  for (Range& range : ranges) range = {range.begin / width, range.end / width};
  return ranges;
}

// ---- running one kernel -----------------------------------------------------------------------------
template <class Scalar> void run_cpu(const CpuKernels& kernels, Kernel kernel, std::size_t info, State<Scalar>& state) {
  struct alignas(64) Line {
    char bytes[64];
  };
  std::array<std::vector<Line>, buffer_count> memory;
  void* buffers[buffer_count] = {};
  std::array<SlotLayout, buffer_count> layouts;
  const TreeLayout trees = lay_out(state.trees, kernels.lanes);
  for (const Access& access : schema(kernel).accesses) {
    const std::size_t i = std::size_t(access.buffer);
    const auto indices = pack_indices(access.buffer, state, kernels.lanes, trees);
    layouts[i] = layout_of(access.buffer, state, kernels.lanes, trees);
    memory[i].resize((layouts[i].size * schema(access.buffer).reals * sizeof(Scalar) + indices.size() * 4) / 64 + 1);
    buffers[i] = memory[i].data();
    if (is_index(access.buffer))
      std::memcpy(buffers[i], indices.data(), indices.size() * 4);
    else
      copy_reals(access.buffer, state.reals[i].data(), static_cast<Scalar*>(buffers[i]), state.reals[i].size(),
                 kernels.lanes, layouts[i], true);
  }
  {
    const FlushSubnormals flush;  // as stepping does, and some GPUs
    for (const Range& range : ranges_of(kernel, state, kernels.lanes))
      kernels.run[std::size_t(kernel)]({buffers, &state.infos[info], range.begin, range.end});
  }
  for (const Access& access : schema(kernel).accesses) {
    const std::size_t i = std::size_t(access.buffer);
    if (access.write)
      copy_reals(access.buffer, static_cast<const Scalar*>(buffers[i]), state.reals[i].data(), state.reals[i].size(),
                 kernels.lanes, layouts[i], false);
  }
}

inline void require(const Status& status) {
  if (!status) FAIL(status.error().message);
}

/// `width`: slots side by side, gl.width() or 1.
template <class Scalar>
void run_gl(Backend& gl, std::uint32_t width, Kernel kernel, std::size_t info, State<Scalar>& state) {
  std::array<std::vector<Scalar>, buffer_count> reals;
  std::array<std::vector<std::uint32_t>, buffer_count> indices;
  std::array<SlotLayout, buffer_count> layouts;
  const TreeLayout trees = lay_out(state.trees, width);
  for (const Access& access : schema(kernel).accesses) {
    const std::size_t i = std::size_t(access.buffer);
    indices[i] = pack_indices(access.buffer, state, width, trees);
    layouts[i] = layout_of(access.buffer, state, width, trees);
    reals[i].resize(layouts[i].size * schema(access.buffer).reals);
    copy_reals(access.buffer, state.reals[i].data(), reals[i].data(), state.reals[i].size(), width, layouts[i], true);
    void* host = is_index(access.buffer) ? static_cast<void*>(indices[i].data()) : reals[i].data();
    require(gl.attach(access.buffer, host, indices[i].size() * 4 + reals[i].size() * sizeof(Scalar)));
    require(gl.upload(access.buffer));
  }
  require(gl.set_infos(state.infos.data(), state.infos.size()));
  const std::vector<Range> ranges = ranges_of(kernel, state, width);
  const KernelRun run{kernel, true, std::uint32_t(info), width, ranges};
  require(gl.run({&run, 1}));
  require(gl.finish());
  for (const Access& access : schema(kernel).accesses) {
    const std::size_t i = std::size_t(access.buffer);
    if (!access.write) continue;
    require(gl.download(access.buffer));
    copy_reals(access.buffer, reals[i].data(), state.reals[i].data(), state.reals[i].size(), width, layouts[i], false);
  }
}

/// Equal numbers, -0 being +0; two not-a-numbers count as equal.
template <class Scalar> bool same(Scalar a, Scalar b) { return a == b || (a != a && b != b); }

/// How many reals of what the kernel writes differ, and where the first does.
template <class Scalar>
std::size_t differences(Kernel kernel, const State<Scalar>& a, const State<Scalar>& b, std::string& first) {
  std::size_t count = 0;
  for (const Access& access : schema(kernel).accesses) {
    const std::size_t i = std::size_t(access.buffer), reals = schema(access.buffer).reals;
    // of contact_reach lanes fill what they have no use for where others of their block have: what they use shows in
    // what comes of it
    for (std::size_t k = 0; access.write && access.buffer != Buffer::contact_reach && k < a.reals[i].size(); k++) {
      if (same(a.reals[i][k], b.reals[i][k])) continue;
      char text[200];
      std::snprintf(text, sizeof text, "%s row %zu real %zu: %a (%.9g) and %a (%.9g)",
                    std::string(schema(access.buffer).name).c_str(), k / reals, k % reals, double(a.reals[i][k]),
                    double(a.reals[i][k]), double(b.reals[i][k]), double(b.reals[i][k]));
      if (count++ == 0) first = text;
    }
  }
  return count;
}

}  // namespace parity
