// The lines of a text that the preprocessor joined: PCPHYS_KERNEL stringises its signature and its body, which leaves
// one line of each.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "plan/own_kernels.h"

namespace pcphys {

struct KernelLines {
  /// A joined text with the line breaks that its file has, and the line on which it begins there.
  struct Text {
    std::string text;
    int line = 0;
    /// Of a place in the joined text: the line of the file.
    int line_at(std::size_t place) const;
  };
  Text signature, body;
};

/// Finds a kernel in the text of its file, at the line that the macro gave or before it (GCC gives the macro's first
/// line, Clang its last). Nothing where no such text stands there: the file is another by now, or a macro of the host's
/// own made the kernel.
std::optional<KernelLines> find_lines(std::string_view source, const OwnKernel& kernel);
/// The same, reading the file; nothing where it cannot be read. Only to tell an error.
std::optional<KernelLines> read_lines(const OwnKernel& kernel);

/// "FILE:LINE" of a place in a kernel's signature; of the kernel where its lines are not found, and empty where it
/// names no file.
std::string place_in_signature(const OwnKernel& kernel, std::size_t place);

}  // namespace pcphys
