#pragma once

#include <cstddef>
#include <new>

namespace holotrace {

/// Cache-aligned memory from the system's allocator, for builds under the sanitizers: they do not see what oneTBB's own
/// allocator gives and takes, so that a write past the end of a buffer, or two threads at one, would go unnoticed.
template <class T>
struct SanitizedAllocator {
  using value_type = T;

  SanitizedAllocator() = default;
  template <class U>
  SanitizedAllocator(const SanitizedAllocator<U>&) {}

  T* allocate(size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), alignment)); }
  void deallocate(T* data, size_t) { ::operator delete(data, alignment); }

  template <class U>
  bool operator==(const SanitizedAllocator<U>&) const {
    return true;
  }

 private:
  static constexpr std::align_val_t alignment{128};  // as oneTBB's
};

}  // namespace holotrace
