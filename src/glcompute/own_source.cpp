// Programs of kernels of the host's own. Those of all forms but elements are two each: one reads, and leaves sums in a
// block of their own; the next puts them together and writes properties. So everything is read before anything is
// written, and the order of sums is that of the CPU (pcphys/pair_loop.h, cpu/own_runs.cpp).
#include <algorithm>
#include <map>

#include "glcompute/compile_log.h"
#include "glcompute/own_sums.h"
#include "glcompute/own_text.h"
#include "glcompute/source_text.h"

namespace pcphys {
namespace {

using Arguments = const std::function<bool(const OwnArgument&)>&;

bool any(const OwnArgument&) { return true; }
bool of_other(const OwnArgument& a) { return a.kind == OwnArgument::Kind::other; }
bool not_of_other(const OwnArgument& a) { return !of_other(a); }

/// What stays in its row, from memory into variables and back.
std::string load_changed(const OwnKernel& k, const OwnText& own, const std::string& row) {
  std::string text;
  for (const OwnArgument& a : k.arguments)
    if (a.writes() && !a.summed())
      text += own.for_parts(a.type, [&](std::uint32_t c, const std::string& part) {
        return "  " + a.name + part + " = " + own.place(a, c, row) + ";\n";
      });
  return text;
}
std::string store_changed(const OwnKernel& k, const OwnText& own, const std::string& row) {
  std::string text;
  for (const OwnArgument& a : k.arguments)
    if (a.writes() && !a.summed())
      text += own.for_parts(a.type, [&](std::uint32_t c, const std::string& part) {
        return "  " + own.place(a, c, row) + " = " + a.name + part + ";\n";
      });
  return text;
}

std::string element_main(const OwnKernel& k) {
  const OwnText own(k);
  std::string text =
      "layout(local_size_x = " + std::to_string(gl_work_group) + ") in;\nuniform uvec2 pc_range;\nvoid main() {\n";
  text += "  uint pc_k = gl_GlobalInvocationID.x + pc_range.x;\n  if (pc_k >= pc_range.y) return;\n";
  text += k.table == Table::body ? "  uint pc_row = io_bodies[pc_k];\n" : "  uint pc_row = pc_k;\n";
  text += own.load(any, "pc_row") + load_changed(k, own, "pc_row") + "  " + own.call();
  return text + store_changed(k, own, "pc_row") + "}\n";
}

// ---- what mains begin with -----------------------------------------------------------------------------
const std::string uniforms = "uniform uvec2 pc_range;\nuniform uvec4 pc_work;\n";
std::string begin_main(std::uint32_t local_size) {
  return "layout(local_size_x = " + std::to_string(local_size) + ") in;\n" + uniforms + "void main() {\n";
}
const std::string own_row =
    "  uint pc_k = gl_GlobalInvocationID.x + pc_range.x;\n  bool pc_here = pc_k < pc_range.y;\n";
std::string row_of(const OwnKernel& k, Buffer list) {
  const std::string place = "pc_here ? pc_k : pc_range.x";
  if (k.table != Table::body && k.table != Table::joint) return "  uint pc_row = " + place + ";\n";
  return "  uint pc_row = io_" + std::string(schema(list).name) + "[" + place + "];\n";
}

// ---- pairs --------------------------------------------------------------------------------------------
std::string four_of(const std::string& number_type) {
  return number_type == "Real" ? "Real4" : (number_type == "float" ? "" : number_type.substr(0, 1)) + "vec4";
}
/// What each invocation reads of another row, four numbers of a type side by side:
/// one access to shared memory fetches them.
class Tile {
 public:
  explicit Tile(const OwnKernel& k) : k_(k) {}
  std::string declarations() const {
    std::map<std::string, std::uint32_t> counts;
    each([&](const OwnArgument&, std::uint32_t, const std::string& type, std::uint32_t ordinal) {
      counts[type] = ordinal + 1;
    });
    std::string text;
    for (const auto& [type, count] : counts)
      for (std::uint32_t four = 0; four * 4 < count; four++)
        text += "shared " + four_of(type) + " " + array(type, four) + "[" + std::to_string(KernelPairs::tile) + "];\n";
    return text;
  }
  /// Component c of an argument, of row `index` of the tile.
  std::string place(const OwnArgument& a, std::uint32_t c, const std::string& index) const {
    std::string text;
    each([&](const OwnArgument& b, std::uint32_t d, const std::string& type, std::uint32_t ordinal) {
      if (&a == &b && c == d) text = array(type, ordinal / 4) + "[" + index + "]." + "xyzw"[ordinal % 4];
    });
    return text;
  }

 private:
  static std::string array(const std::string& type, std::uint32_t four) {
    return "pc_tile_" + type + "_" + std::to_string(four);
  }
  template <class Function> void each(const Function& function) const {
    std::map<std::string, std::uint32_t> next;
    for (const OwnArgument& a : k_.arguments)
      for (std::uint32_t c = 0; of_other(a) && c < components(a.type); c++) {
        const std::string type = OwnText::number_type(a.type);
        function(a, c, type, next[type]++);
      }
  }
  const OwnKernel& k_;
};

/// Sums over one tile. In most tiles, which are full and do not hold the row itself,
/// nothing need be asked of each pair.
std::string sum_tile(const OwnKernel& k, const Tile& tile) {
  const OwnText own(k);
  std::string pair;
  for (const OwnArgument& a : k.arguments) {
    if (!of_other(a)) continue;
    pair += "  " + own.type(a.type) + " pc_in_" + a.name + ";\n";
    pair += own.for_parts(a.type, [&](std::uint32_t c, const std::string& part) {
      return "  pc_in_" + a.name + part + " = " + tile.place(a, c, "pc_j") + ";\n";
    });
  }
  pair += clear(k, "") + "  " + own.call() + combine(k, "pc_part_", "");
  const std::uint32_t unrolled =
      k.real_bytes == 8 ? 1 : 8;  // what one pair waits for others fill; in double they only make the text long
  const std::string full = std::to_string(KernelPairs::tile) + "u";
  std::string text = "  if (pc_count == " + full + " && pc_self >= " + full + ") {\n";
  text += "  for (uint pc_i = 0u; pc_i < " + full + "; pc_i += " + std::to_string(unrolled) + "u) {\n";
  for (std::uint32_t i = 0; i < unrolled; i++)
    text += "  { uint pc_j = pc_i + " + std::to_string(i) + "u;\n" + pair + "  }\n";
  text +=
      "  }\n  } else {\n  for (uint pc_j = 0u; pc_j < pc_count; pc_j++) {\n  if (pc_j == pc_self) continue;\n" + pair;
  return text + "  }\n  }\n";
}

/// pc_work: others, how many in one go, bodies, the first of these.
std::string all_pairs_main(const OwnKernel& k) {
  const OwnText own(k);
  const Tile shared(k);
  const bool bodies = k.table == Table::body;
  const std::string tile = std::to_string(KernelPairs::tile) + "u";
  std::string text = shared.declarations() + begin_main(KernelPairs::tile) + own_row + row_of(k, Buffer::bodies);
  text +=
      own.load(not_of_other, "pc_row") + declare_sums(k, "pc_sum_") + declare_sums(k, "pc_part_") + clear(k, "pc_sum_");
  text += bodies ? "  uint pc_place = io_bodies_by_id[pc_row];\n" : "  uint pc_place = pc_row - 1u;\n";
  text += "  uint pc_lane = gl_LocalInvocationID.x;\n  uint pc_begin = gl_WorkGroupID.y * pc_work.y;\n";
  text += "  uint pc_end = min(pc_begin + pc_work.y, pc_work.x);\n";
  text += "  for (uint pc_at = pc_begin; pc_at < pc_end; pc_at += " + tile + ") {\n";
  text += "  uint pc_count = min(pc_end - pc_at, " + tile +
          ");\n  uint pc_self = pc_place - pc_at;\n  barrier();\n  if (pc_lane < pc_count) {\n";
  text += bodies ? "  uint pc_other = io_bodies_by_id[pc_work.x + 1u + pc_at + pc_lane];\n"
                 : "  uint pc_other = pc_at + pc_lane + 1u;\n";
  for (const OwnArgument& a : k.arguments)
    for (std::uint32_t c = 0; of_other(a) && c < components(a.type); c++)
      text += "  " + shared.place(a, c, "pc_lane") + " = " + own.place(a, c, "pc_other") + ";\n";
  text +=
      "  }\n  barrier();\n" + clear(k, "pc_part_") + sum_tile(k, shared) + combine(k, "pc_sum_", "pc_part_") + "  }\n";
  text += "  pc_stride = pc_work.z * gl_NumWorkGroups.y;\n";
  return text + "  if (pc_here) {\n" + put(k, "pc_sum_", "gl_WorkGroupID.y * pc_work.z + pc_k - pc_work.w") +
         "  }\n}\n";
}

std::string near_pairs_main(const OwnKernel& k) {
  const OwnText own(k);
  const std::string length = std::to_string(quads(Buffer::pose)) + "u";
  std::string text =
      "uniform Real pc_cutoff_squared;\n" + begin_main(KernelPairs::tile) + own_row + "  if (!pc_here) return;\n";
  text +=
      row_of(k, Buffer::bodies) + own.load(not_of_other, "pc_row") + declare_sums(k, "pc_sum_") + clear(k, "pc_sum_");
  text += "  Real4 pc_centre = io_pose[pc_row * " + length + "];\n";
  text +=
      "  for (uint pc_at = io_near_first[pc_row]; pc_at < io_near_first[pc_row + 1u]; pc_at++) {\n  uint pc_other = "
      "io_near_rows[pc_at];\n";
  text += "  Real4 pc_place = io_pose[pc_other * " + length + "];\n";
  for (const char* axis : {"x", "y", "z"})
    text += std::string("  precise Real pc_d") + axis + " = pc_place." + axis + " - pc_centre." + axis + ";\n";
  text +=
      "  precise Real pc_apart = pc_dx * pc_dx + pc_dy * pc_dy + pc_dz * pc_dz;\n  if (!(pc_apart <= "
      "pc_cutoff_squared)) "
      "continue;\n";
  text += own.load(of_other, "pc_other") + clear(k, "") + "  " + own.call() + combine(k, "pc_sum_", "") + "  }\n";
  return text + "  pc_stride = pc_work.z;\n" + put(k, "pc_sum_", "pc_k - pc_work.w") + "}\n";
}

/// pc_work: how many sums a body has, -, bodies, the first of these.
std::string pair_totals_main(const OwnKernel& k) {
  const OwnText own(k);
  const std::string stride = "pc_work.z";
  std::string text = begin_main(KernelPairs::tile) + own_row + "  if (!pc_here) return;\n" + row_of(k, Buffer::bodies);
  text += "  uint pc_i = pc_k - pc_work.w;\n  pc_stride = pc_work.z * pc_work.x;\n" + declare_sums(k, "pc_sum_") +
          declare_sums(k, "pc_part_");
  text += "  for (uint pc_step = 1u; pc_step < pc_work.x; pc_step *= 2u)\n";
  text += "  for (uint pc_c = 0u; pc_c + pc_step < pc_work.x; pc_c += 2u * pc_step) {\n";
  text += get(k, "pc_sum_", "pc_c * pc_work.z + pc_i") + get(k, "pc_part_", "(pc_c + pc_step) * pc_work.z + pc_i") +
          combine(k, "pc_sum_", "pc_part_");
  return text + put(k, "pc_sum_", "pc_c * pc_work.z + pc_i") + "  }\n" + get(k, "pc_sum_", "pc_i") + apply(k, own) +
         "}\n";
}

// ---- joints with their bodies --------------------------------------------------------------------------
/// pc_work: -, -, rows of joints, -.
std::string joined_main(const OwnKernel& k) {
  const OwnText own(k);
  constexpr const char* rows[] = {"pc_row", "pc_row_a", "pc_row_b"};
  std::string text = begin_main(gl_work_group) + own_row + "  if (!pc_here) return;\n";
  for (std::uint8_t i = 0; i < 3; i++)
    text += std::string("  uint ") + rows[i] + " = io_joined[3u * pc_k + " + std::to_string(i) + "u];\n";
  for (std::uint8_t i = 0; i < 3; i++)
    text += own.load([&](const OwnArgument& a) { return a.of_three() == i; }, rows[i]);
  text += load_changed(k, own, "pc_row") + clear(k, "") + "  " + own.call() + store_changed(k, own, "pc_row");
  return text + "  pc_stride = pc_work.z;\n" + put(k, "", "pc_row") + "}\n";
}

/// pc_work: as above. What a body is given as a, and what as b, in a row each.
std::string ends_main(const OwnKernel& k) {
  const OwnText own(k);
  const auto sum_of = [&](std::uint8_t end) {
    return for_sums(k, [&](const OwnArgument& a, const std::string& part, const std::string& word) {
      const std::string sum = "  pc_sum_" + a.name + part;
      return a.of_three() != end ? "" : sum + " = " + sum + " + " + value_at(k, a, word, "pc_end >> 1u") + ";\n";
    });
  };
  std::string text =
      begin_main(gl_work_group) + own_row + "  if (!pc_here) return;\n  uint pc_row = io_bodies[pc_k];\n";
  text +=
      "  uint pc_first = io_body_joints[pc_row], pc_last = io_body_joints[pc_row + 1u];\n  if (pc_first == pc_last) "
      "return;\n";
  text += "  pc_stride = pc_work.z;\n" + declare_sums(k, "pc_sum_") + clear(k, "pc_sum_");
  text += "  for (uint pc_at = pc_first; pc_at < pc_last; pc_at++) {\n  uint pc_end = io_body_joints[pc_at];\n";
  text += "  if ((pc_end & 1u) == 0u) {\n" + sum_of(1) + "  } else {\n" + sum_of(2) + "  }\n  }\n";
  return text + apply(k, own) + "}\n";
}

// ---- all rows to one value ----------------------------------------------------------------------------
std::string shared_values(const OwnKernel& k) {
  return for_sums(k, [&](const OwnArgument& a, const std::string&, const std::string& word) {
    return "shared " + OwnText::number_type(a.type) + " pc_shared_" + word + "[" + std::to_string(reduction_block) +
           "];\n";
  });
}
/// A value of each invocation of the first `count` to one, that of the first; in `sum_`.
std::string reduce_block(const OwnKernel& k) {
  std::string text = for_sums(k, [&](const OwnArgument& a, const std::string& part, const std::string& word) {
    return "  pc_shared_" + word + "[pc_lane] = pc_sum_" + a.name + part + ";\n";
  });
  text +=
      "  for (uint pc_step = 1u; pc_step < " + std::to_string(reduction_block) + "u; pc_step *= 2u) {\n  barrier();\n";
  text += "  if (pc_lane % (2u * pc_step) == 0u && pc_lane + pc_step < pc_count) {\n";
  text += for_sums(k, [&](const OwnArgument& a, const std::string& part, const std::string& word) {
    const std::string sum = "pc_sum_" + a.name + part, values = "pc_shared_" + word;
    return "  " + sum + " = " + combined(a, sum, values + "[pc_lane + pc_step]") + ";\n  " + values +
           "[pc_lane] = " + sum + ";\n";
  });
  return text + "  }\n  }\n";
}

/// pc_work: -, -, room for values, the first row's place.
std::string values_main(const OwnKernel& k) {
  const OwnText own(k);
  const Buffer list = k.table == Table::joint ? Buffer::joints_by_id : Buffer::moving_by_id;
  std::string text = shared_values(k) + begin_main(reduction_block) + own_row + row_of(k, list);
  text += "  uint pc_lane = gl_LocalInvocationID.x;\n  uint pc_count = min(pc_range.y - (pc_k - pc_lane), " +
          std::to_string(reduction_block) + "u);\n";
  text += own.load(any, "pc_row") + declare_sums(k, "pc_sum_") + clear(k, "") + "  " + own.call();
  text += for_sums(k, [&](const OwnArgument& a, const std::string& part, const std::string&) {
    return "  pc_sum_" + a.name + part + " = " + a.name + part + ";\n";
  });
  text += reduce_block(k) + "  pc_stride = pc_work.z;\n  if (pc_lane == 0u) {\n";
  return text + put(k, "pc_sum_", "(pc_k - pc_work.w) / " + std::to_string(reduction_block) + "u") + "  }\n}\n";
}

/// pc_work: the first value, how many, room for values, where the next level goes. pc_range.y: not 0 of the last level.
std::string levels_main(const OwnKernel& k) {
  const OwnText own(k);
  std::string text = shared_values(k) + begin_main(reduction_block);
  text += "  uint pc_k = gl_GlobalInvocationID.x, pc_lane = gl_LocalInvocationID.x;\n";
  text +=
      "  uint pc_count = min(pc_work.y - min(pc_k - pc_lane, pc_work.y), " + std::to_string(reduction_block) + "u);\n";
  text += "  pc_stride = pc_work.z;\n" + declare_sums(k, "pc_sum_") + clear(k, "pc_sum_");
  text += "  if (pc_lane < pc_count) {\n" + get(k, "pc_sum_", "pc_work.x + pc_k") + "  }\n" + reduce_block(k);
  text += "  if (pc_lane == 0u) {\n  if (pc_range.y == 0u) {\n" + put(k, "pc_sum_", "pc_work.w + gl_WorkGroupID.x") +
          "  } else {\n";
  for (const OwnArgument& a : k.arguments) {
    if (!a.summed()) continue;
    if (a.kind != OwnArgument::Kind::sum) text += "  if (pc_count > 0u) {\n";
    text += own.for_parts(a.type, [&](std::uint32_t c, const std::string& part) {
      return "  " + own.place(a, c, "1u") + " = pc_sum_" + a.name + part + ";\n";
    });
    if (a.kind != OwnArgument::Kind::sum) text += "  }\n";
  }
  return text + "  }\n  }\n}\n";
}

std::string first_main(const OwnKernel& k) {
  if (k.form == OwnKernel::Form::element) return element_main(k);
  if (k.form == OwnKernel::Form::reduction) return values_main(k);
  if (k.form == OwnKernel::Form::joined) return joined_main(k);
  return k.cutoff ? near_pairs_main(k) : all_pairs_main(k);
}
std::string second_main(const OwnKernel& k) {
  if (k.form == OwnKernel::Form::reduction) return levels_main(k);
  return k.form == OwnKernel::Form::joined ? ends_main(k) : pair_totals_main(k);
}

/// A joined text has no lines to speak of: its statements are counted instead.
Status add_body(const OwnKernel& k, SourceText& text) {
  if (k.own_lines) return text.add_text(k.body, k.file, std::uint32_t(k.line));
  return text.add_text(by_statement(k.body), k.file + ":" + std::to_string(k.line) + std::string(counted_by_statement),
                       1);
}

}  // namespace

std::uint32_t number_words(PropertyType type, std::size_t real_bytes) {
  return number_bytes(type, real_bytes) == 8 ? 2 : 1;
}

Result<ProgramSource> own_kernel_source(const OwnKernel& k, const SourceOptions& options) {
  const OwnText own(k);
  const bool element = k.form == OwnKernel::Form::element;
  SourceText text(options.precision);
  text.add(source_head(options));
  if (Status status = text.include("prelude.glsl"); !status) return status.error();
  text.add("#line 1 0\nstruct Mat3 { Vec3 x; Vec3 y; Vec3 z; };\n");
  text.add(own.blocks(element ? k.accesses : k.first));
  if (!element) text.add(sums_block(k, k.first.size()));
  text.add(own.variables() + info_declaration() + own.function());
  if (Status status = add_body(k, text); !status) return status.error();
  text.add("\n#line 1 0\n" + first_main(k));
  ProgramSource source = text.take();
  source.host = std::uint32_t(source.files.size() - 1);
  return source;
}

Result<ProgramSource> own_totals_source(const OwnKernel& k, const SourceOptions& options) {
  const OwnText own(k);
  SourceText text(options.precision);
  text.add(source_head(options));
  if (Status status = text.include("prelude.glsl"); !status) return status.error();
  text.add("#line 1 0\nstruct Mat3 { Vec3 x; Vec3 y; Vec3 z; };\n" + own.blocks(k.second) +
           sums_block(k, k.second.size()) + own.variables() + second_main(k));
  return text.take();
}

}  // namespace pcphys
