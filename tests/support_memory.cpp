#include "support_memory.h"

#include <cstdlib>
#include <new>

namespace memorytest {
bool counting = false;
std::size_t allocations = 0;
thread_local long allocations_left = -1;
}  // namespace memorytest

namespace {

void* counted(std::size_t size, std::size_t alignment) {
  if (memorytest::allocations_left == 0) return nullptr;
  if (memorytest::allocations_left > 0) memorytest::allocations_left--;
  if (memorytest::counting) memorytest::allocations++;
  void* p = nullptr;
  if (alignment <= alignof(std::max_align_t))
    p = std::malloc(size ? size : 1);
  else if (posix_memalign(&p, alignment, size ? size : 1) != 0)
    p = nullptr;
  return p;
}
void* counted_or_throw(std::size_t size, std::size_t alignment = 1) {
  if (void* p = counted(size, alignment)) return p;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t n) { return counted_or_throw(n); }
void* operator new[](std::size_t n) { return counted_or_throw(n); }
void* operator new(std::size_t n, std::align_val_t a) { return counted_or_throw(n, std::size_t(a)); }
void* operator new[](std::size_t n, std::align_val_t a) { return counted_or_throw(n, std::size_t(a)); }
void* operator new(std::size_t n, const std::nothrow_t&) noexcept { return counted(n, 1); }
void* operator new[](std::size_t n, const std::nothrow_t&) noexcept { return counted(n, 1); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, const std::nothrow_t&) noexcept { std::free(p); }
void operator delete[](void* p, const std::nothrow_t&) noexcept { std::free(p); }
extern "C" void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept { return counted(size, alignment); }
