// What this machine offers to the GL backend: devices, limits, and whether results equal the CPU's bits.
// Everything here makes and drops a headless context of its own; nothing of a host's context is touched.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace pcphys {

/// How a function that IEEE 754 rounds correctly is had on a device.
enum class RoundingForm : std::uint8_t {
  builtin,  // the device's own
  fma,      // one fused correction step after it
  nearest,  // the step, then a choice among neighbours by exact residuals
  none      // no form was exact: results may differ from the CPU's
};
/// "builtin", "fma", "nearest" or "none".
const char* name(RoundingForm form);

/// What the device probe found for one precision.
struct GlArithmetic {
  bool supported = false;
  RoundingForm division = RoundingForm::none;
  RoundingForm square_root = RoundingForm::none;
  bool two_roundings = false;    // a `precise` a * b + c rounds the product and the sum
  bool fma_fused = false;        // fma(a, b, c) rounds once
  bool subnormals_kept = false;  // else flushed to zero
  /// The same scene gives the same bits on this device and on the CPU.
  bool parity() const {
    return supported && two_roundings && division != RoundingForm::none && square_root != RoundingForm::none;
  }
};

struct GlLimits {
  std::uint32_t storage_blocks = 0;       // of a compute program; 8 are needed
  std::uint64_t storage_block_bytes = 0;  // largest buffer
  std::uint32_t shared_memory_bytes = 0;  // of a work group
  std::uint32_t work_group_invocations = 0;
  std::uint32_t work_group_count = 0;  // along x
};

struct GlReport {
  int device = -1;  // index of the EGL device; -1: found without one (surfaceless, default display)
  bool usable = false;
  std::string problem;  // when not usable: what is missing and what to do, a whole sentence
  std::string package;  // the Debian package that brings it; empty when none would help
  std::string renderer, vendor, version;
  bool software = false;  // the CPU plays the GPU (llvmpipe)
  GlLimits limits;
  GlArithmetic f32, f64;
};

/// A device that EGL lists, without the probe.
struct GlDevice {
  int index = 0;
  bool usable = false;  // has OpenGL 4.3 with compute
  bool software = false;
  std::string renderer;  // or, when not usable, why
};

/// Never fails: without EGL or devices the list is empty, and `probe_gl(-1)` says why.
std::vector<GlDevice> gl_devices();

/// device: index into `gl_devices`, -1 for the first that works. Never fails; see `usable` and `problem`.
GlReport probe_gl(int device);

}  // namespace pcphys
