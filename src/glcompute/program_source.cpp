#include "glcompute/program_source.h"

#include <string>

#include "glcompute/source_text.h"

namespace pcphys {
namespace {

/// Elements as the prelude's macros take them.
std::string element(Buffer buffer, Precision precision) {
  if (schema(buffer).reals == 0) return "uint";
  return scalar_elements(buffer, precision) ? "Real" : "Real4";
}

/// `shared`: what one invocation stores others of its work group read.
std::string buffer_declarations(const KernelSchema& kernel, Precision precision, bool shared) {
  std::string text;
  std::uint32_t binding = 0;
  for (const Access& access : kernel.accesses) {
    const BufferSchema& buffer = schema(access.buffer);
    const std::string label(buffer.name);
    text += "layout(std430, binding = " + std::to_string(binding++) + ") restrict " +
            (!access.write ? "readonly "
             : shared      ? "coherent "
                           : "") +
            "buffer Block_" + label + " { " + element(access.buffer, precision) + " io_" + label + "[]; };\n";
    if (buffer.reals != 0) text += "#define quads_" + label + " " + std::to_string(quads(access.buffer)) + "u\n";
  }
  return text;
}

std::string main_text(Domain domain, bool shared) {
  if (shared)
    return "layout(local_size_x = PC_TEAM) in;\nuniform uvec2 pc_range;\nvoid main() { pc_kernel(Slot(gl_WorkGroupID.x "
           "+ "
           "pc_range.x, 0u)); }\n";
  std::string text =
      "layout(local_size_x = " + std::to_string(gl_work_group) + ") in;\nuniform uvec2 pc_range;\nvoid main() {\n";
  text += "  uint k = gl_GlobalInvocationID.x + pc_range.x;\n  if (k >= pc_range.y) return;\n";
  text += domain == Domain::body ? "  pc_kernel(io_bodies[k]);\n"
          : one_by_one(domain)   ? "  pc_kernel(k);\n"
                                 : "  pc_kernel(Slot(k / PC_W, k % PC_W));\n";
  return text + "}\n";
}

}  // namespace

bool scalar_elements(Buffer buffer, Precision precision) {
  return buffer > Buffer::table_buffers && schema(buffer).reals > 0 && precision == Precision::f64;
}

std::uint32_t quads(Buffer buffer) { return schema(buffer).reals == 0 ? 1 : schema(buffer).reals / 4; }

bool is_shared(Kernel kernel, const SourceOptions& options) {
  return options.lanes == 1 && options.team > 1 && schema(kernel).domain == Domain::tree_nodes;
}

Result<ProgramSource> kernel_source(Kernel kernel, const SourceOptions& options) {
  const KernelSchema& what = schema(kernel);
  const bool shared = is_shared(kernel, options);
  SourceText text(options.precision);
  text.add(source_head(options));
  if (shared) text.add("#define PC_TEAM " + std::to_string(options.team) + "u\n");
  if (Status status = text.include("prelude.glsl"); !status) return status.error();
  text.add("#line 1 0\n" + buffer_declarations(what, options.precision, shared) + info_declaration());
  if (shared)
    if (Status status = text.include("team.glsl"); !status) return status.error();
  if (Status status = text.include(std::string(what.name) + ".inl"); !status) return status.error();
  text.add("#line 1 0\n" + main_text(what.domain, shared));
  return text.take();
}

Result<ProgramSource> probe_source(Precision precision) {
  SourceText text(precision);
  text.add(source_head({precision}));
  if (Status status = text.include("prelude.glsl"); !status) return status.error();
  if (Status status = text.include("probe.glsl"); !status) return status.error();
  return text.take();
}

const char* name(RoundingForm form) {
  constexpr const char* names[] = {"builtin", "fma", "nearest", "none"};
  return names[std::size_t(form)];
}

}  // namespace pcphys
