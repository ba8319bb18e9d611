// Every allocation of the test program: operator new in its forms, and aligned_alloc, which the tables use. They may be
// counted, and made to fail.
#pragma once
#include <cstddef>

namespace memorytest {

extern bool counting;
extern std::size_t allocations;
/// Of this thread, before all that follow fail; below zero: none does.
extern thread_local long allocations_left;

/// No more than so many allocations while it lives.
class Scarce {
 public:
  explicit Scarce(long allocations) { allocations_left = allocations; }
  Scarce(const Scarce&) = delete;
  Scarce& operator=(const Scarce&) = delete;
  ~Scarce() { allocations_left = -1; }
};

}  // namespace memorytest
