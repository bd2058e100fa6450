#pragma once
// Counts allocations of the calling thread by replacing `new`. Include it in one source of a program.

#include <cstdint>
#include <cstdlib>
#include <new>

namespace sf::counted {

inline thread_local bool counting = false;
inline thread_local std::uint64_t allocations = 0;

/// Runs up to `most` laps until one allocates nothing. The scheduler decides which thread needs a larger scratch
/// buffer, and when. @return allocations of the last lap
template <class Lap>
std::uint64_t when_warm(int most, Lap lap) {
  for (int k = 0; k < most; ++k) {
    allocations = 0;
    counting = true;
    lap();
    counting = false;
    if (allocations == 0) break;
  }
  return allocations;
}

}  // namespace sf::counted

// Replaces every form, out of line, since sanitizers compare the forms that allocate and free.
#define SF_COUNTED [[gnu::noinline]]
SF_COUNTED void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  if (sf::counted::counting) ++sf::counted::allocations;
  return std::malloc(size > 0 ? size : 1);
}
SF_COUNTED void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
SF_COUNTED void* operator new[](std::size_t size) { return operator new(size); }
SF_COUNTED void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return operator new(size, std::nothrow);
}
SF_COUNTED void operator delete(void* memory) noexcept { std::free(memory); }
SF_COUNTED void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
SF_COUNTED void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
SF_COUNTED void operator delete[](void* memory) noexcept { std::free(memory); }
SF_COUNTED void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
SF_COUNTED void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
#undef SF_COUNTED
