// Puts GLSL programs together from the embedded texts: the prelude, the declarations that follow from a
// kernel's accesses, the kernel, and main().
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "pcphys/device.h"
#include "pcphys/result.h"
#include "pcphys/types.h"
#include "plan/own_kernels.h"
#include "world/schema.h"

namespace pcphys {

/// Lanes side by side in the arrays of structures of arrays on the GPU.
inline constexpr std::uint32_t gl_width = 32;
/// Invocations of a work group.
inline constexpr std::uint32_t gl_work_group = 64;
/// And of one that shares a joint tree, and the most that GL promises.
inline constexpr std::uint32_t gl_team_size = 32, gl_largest_team = 1024;

struct SourceOptions {
  Precision precision = Precision::f32;
  RoundingForm division = RoundingForm::builtin;
  RoundingForm square_root = RoundingForm::builtin;
  std::uint32_t lanes = gl_width;  // of a block
  std::uint32_t team = 1;          // invocations that share a block of one lane, where a kernel's text says how
  bool scattered = false;          // in another order, see GlTeam; of no text: a uniform of the programs says it
};

struct ProgramSource {
  std::string text;
  std::vector<std::string> files;  // by the number that #line gives them, for the driver's messages
  std::uint32_t host = 0;          // the number of the file with the host's own text; 0: none
};

Result<ProgramSource> kernel_source(Kernel kernel, const SourceOptions& options);
/// Whether a work group shares each block.
bool is_shared(Kernel kernel, const SourceOptions& options);
/// Of a kernel of the host's own; errors of its text name its own file and lines.
Result<ProgramSource> own_kernel_source(const OwnKernel& kernel, const SourceOptions& options);
/// Its second program, where it is of pairs or makes one value of all rows.
Result<ProgramSource> own_totals_source(const OwnKernel& kernel, const SourceOptions& options);
/// Of 32 bits, that a number takes between the two.
std::uint32_t number_words(PropertyType type, std::size_t real_bytes);
Result<ProgramSource> probe_source(Precision precision);

/// Whether GLSL sees a buffer as single reals: the solver's rows in double, see PC_AT in prelude.glsl.
bool scalar_elements(Buffer buffer, Precision precision);
/// Length of a buffer's row in the elements that GLSL sees: Real4, or unsigned integers (1).
std::uint32_t quads(Buffer buffer);

}  // namespace pcphys
