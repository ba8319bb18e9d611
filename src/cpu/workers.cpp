#include "cpu/workers.h"

#include <algorithm>
#include <optional>
#include <string>
#include <thread>

#include "step/processor_state.h"
#ifdef PCPHYS_HAVE_TBB
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif
#ifdef PCPHYS_WATCHED_THREADS
#include <sanitizer/tsan_interface.h>
#endif

namespace pcphys {

#ifdef PCPHYS_HAVE_TBB
namespace {
/// oneTBB is compiled without the thread sanitizer, which so does not see that a piece of a loop begins after the loop
/// and ends before it does; here it is told. Of two pieces it is told nothing: what one writes and another reads is a
/// race that it finds.
class Order {
 public:
#ifdef PCPHYS_WATCHED_THREADS
  void loop_begins() { __tsan_release(&begin_); }
  void piece_begins() { __tsan_acquire(&begin_); }
  void piece_ends() { __tsan_release(&end_); }
  void loop_ends() { __tsan_acquire(&end_); }

 private:
  char begin_ = 0, end_ = 0;
#else
  void loop_begins() {}
  void piece_begins() {}
  void piece_ends() {}
  void loop_ends() {}
#endif
};
}  // namespace

struct Workers::Arena {
  explicit Arena(std::uint32_t threads) : arena(int(threads)) {
    // more than the processor has, as tests want them: oneTBB would warn and make fewer
    if (int(threads) > tbb::info::default_concurrency())
      limit.emplace(tbb::global_control::max_allowed_parallelism, threads);
  }
  std::optional<tbb::global_control> limit;
  tbb::task_arena arena;
};
#else
struct Workers::Arena {};
#endif

Status Workers::check(std::uint32_t threads) {
  if (threads > most)
    return Error{ErrorCode::bad_argument, "The number of threads is " + std::to_string(threads) + "; it may be up to " +
                                              std::to_string(most) +
                                              ", and 0 for as many as the processor runs at a time."};
#ifndef PCPHYS_HAVE_TBB
  if (threads > 1)
    return Error{
        ErrorCode::unavailable,
        "This build has no threads: oneTBB was not found when it was configured (Debian, Ubuntu: apt-get install "
        "libtbb-dev). Build it anew, or set threads to 1."};
#endif
  return {};
}

#ifdef PCPHYS_HAVE_TBB
Workers::Workers(std::uint32_t threads)
    : threads_(threads > 0 ? threads : std::clamp(std::thread::hardware_concurrency(), 1u, most)) {
  if (threads_ > 1) arena_ = std::make_unique<Arena>(threads_);
}
#else
Workers::Workers(std::uint32_t) : threads_(1) {}
#endif
Workers::~Workers() = default;

void Workers::share([[maybe_unused]] std::uint32_t count, [[maybe_unused]] std::uint32_t grain,
                    [[maybe_unused]] const void* part, [[maybe_unused]] Call call) const {
#ifdef PCPHYS_HAVE_TBB
  Order order;
  order.loop_begins();
  arena_->arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, grain),
                      [&](const tbb::blocked_range<std::uint32_t>& piece) {
                        order.piece_begins();
                        const FlushSubnormals flush;
                        call(part, piece.begin(), piece.end());
                        order.piece_ends();
                      });
  });
  order.loop_ends();
#endif
}

}  // namespace pcphys
