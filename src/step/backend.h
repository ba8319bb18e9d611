// Where kernels run. A backend moves memory and runs loops; it holds no physics arithmetic.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "pcphys/result.h"
#include "pcphys/types.h"
#include "plan/own_kernels.h"
#include "world/schema.h"

namespace pcphys {

class Workers;

/// Positions in `bodies` for the body domain (a backend may go on to the next multiple of its lanes, the list is padded
/// with row 0); blocks of as many slots as there are lanes for joints and contacts.
struct Range {
  std::uint32_t begin, end;
};

/// One run of a kernel over ranges, one after the other: each may read what the one before wrote (the colours of a
/// constraint graph). Of joints with their bodies two: of joints in `joined`,
/// and of the bodies that take their sums in `bodies`.
struct KernelRun {
  Kernel kernel;
  bool barrier;         // it also reads what an earlier run wrote
  std::uint32_t info;   // which of the blocks of `set_infos`
  std::uint32_t lanes;  // one of `width_for`
  std::span<const Range> ranges;
  // a kernel of the host's own in its place; over rows themselves where its table is not of bodies
  const OwnKernel* own = nullptr;
  std::uint32_t others = 0;  // of pairs: all rows of the table; of joints with their bodies: all joints
};

class Backend {
 public:
  virtual ~Backend() = default;

  /// "cpu, 8 lanes" or the GL renderer's name.
  virtual std::string device() const = 0;
  /// The most slots side by side in arrays of structures of arrays.
  virtual std::uint32_t width() const = 0;
  /// How many it puts side by side of a domain of which no more than `count` can.
  virtual std::uint32_t width_for(Domain domain, std::uint32_t count) const {
    return (void)domain, (void)count, width();
  }

  /// Where the host keeps a buffer (world tables, index lists) and how long it is. Called again when either
  /// changed. The CPU works in place; the GPU sizes its copy (growing by half, keeping nothing).
  virtual Status attach(Buffer buffer, void* host, std::size_t bytes) = 0;
  /// Scratch of the solver: `slots` rows of a PC_ROWS buffer, a multiple of the lanes. Never transferred.
  virtual Status reserve(Buffer buffer, std::size_t slots) = 0;

  /// Scratch that the host can read in place, `width` slots side by side; null where it cannot.
  virtual const void* scratch(Buffer buffer) const { return (void)buffer, nullptr; }
  /// What the backend has itself for a buffer.
  virtual std::size_t held_bytes(Buffer buffer) const { return (void)buffer, std::size_t{0}; }

  /// And for terms of what kernels of the host's own sum up.
  virtual std::size_t sum_bytes() const { return 0; }

  /// Host to device and back, the whole buffer; nothing to do on the CPU.
  virtual Status upload(Buffer buffer) = 0;
  virtual Status download(Buffer buffer) = 0;
  /// A second copy of what the device has of a buffer, which stays there; and that one in place of the first.
  virtual Status keep(Buffer buffer) { return (void)buffer, Status{}; }
  virtual Status put_back(Buffer buffer) { return (void)buffer, Status{}; }

  /// All info blocks of a step, `count` times InfoOf<Scalar>, in the precision of the world.
  virtual Status set_infos(const void* infos, std::size_t count) = 0;
  /// Makes what a kernel of the host's own needs to run here, unless it is there. Errors: unavailable where it has no
  /// text for this place; device_error with what the GL compiler said, in the lines of the host's own text.
  virtual Status prepare(const OwnKernel& kernel) { return (void)kernel, Status{}; }
  /// Runs kernels, one after the other.
  virtual Status run(std::span<const KernelRun> runs) = 0;
  /// Takes down a flag that kernels raise (PC_RAISE: the last real of quad `quad` of a buffer's first row) and says
  /// whether it was up; of a list its first number (PC_LOWER). On a device this waits for what was asked for so far.
  virtual Result<bool> take_flag(Buffer buffer, std::uint32_t quad) = 0;
  /// Waits until all that was asked for is done, so that a clock around it tells the time it took.
  virtual Status finish() = 0;
};

/// lanes: 1, 4 or 8 (f32), 1 or 4 (f64); 0 picks the widest that the processor has, and narrower ones where those
/// would stand empty. `workers`: to share loops among; they outlive the backend.
Result<std::unique_ptr<Backend>> make_cpu_backend(Precision precision, std::uint32_t lanes,
                                                  const Workers* workers = nullptr);

/// device: index into the EGL devices, -1 for the first that works. `host_context`: use the context that is
/// current on the calling thread instead of a headless one of our own.
Result<std::unique_ptr<Backend>> make_gl_backend(Precision precision, int device, bool host_context);

/// Its `width_for`, which no device changes.
std::uint32_t gl_width_for(Domain domain, std::uint32_t count);

/// The invocations that share a joint tree which stands alone in its block, of GL backends that are made from then on.
/// Tests and benchmarks change it: the bits are the same.
struct GlTeam {
  std::uint32_t size;  // 1: none share; 0: 32, but in software none. At first what PCPHYS_GL_TEAM says, or 0
  // in another order: where a barrier is missing, a device that runs them one after the other has other bits
  bool scattered = false;
};
GlTeam& gl_team();

/// Where steps get their GL backend from: make_gl_backend, until a test puts one there that fails.
using GlBackendMaker = Result<std::unique_ptr<Backend>> (*)(Precision precision, int device, bool host_context);
GlBackendMaker& gl_backend_maker();

}  // namespace pcphys
