// Threads that share a loop. Which thread runs which piece is chance; what is computed is not, since no piece of a loop
// reads what another writes.
#pragma once
#include <cstdint>
#include <memory>

#include "pcphys/result.h"

namespace pcphys {

class Workers {
 public:
  static constexpr std::uint32_t most = 256;
  /// Errors: bad_argument for more than `most`; unavailable for more than one in a build without threads.
  static Status check(std::uint32_t threads);

  /// threads: as checked, the calling one among them; 0: as many as the processor runs at a time.
  explicit Workers(std::uint32_t threads);
  ~Workers();

  std::uint32_t threads() const { return threads_; }
  /// Calls part(begin, end) for pieces that make up [0, count), each at least `grain` long where there are so many.
  /// Returns when all are done. Loops of less than two grains stay on the calling thread.
  template <class Part> void run(std::uint32_t count, std::uint32_t grain, const Part& part) const {
    if (threads_ == 1 || count < 2 * grain) return part(0u, count);
    share(count, grain, &part,
          [](const void* p, std::uint32_t begin, std::uint32_t end) { (*static_cast<const Part*>(p))(begin, end); });
  }

 private:
  using Call = void (*)(const void* part, std::uint32_t begin, std::uint32_t end);
  struct Arena;
  void share(std::uint32_t count, std::uint32_t grain, const void* part, Call call) const;

  std::uint32_t threads_;
  std::unique_ptr<Arena> arena_;
};

}  // namespace pcphys
