#pragma once

#include <cstddef>
#include <new>

namespace holotrace {

/// Cache-aligned memory from the system's allocator, for builds under the sanitizers. The sanitizers do not see the
/// blocks of oneTBB's own allocator: writes past the end of a buffer, or data races in it, would go unnoticed.
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
  static constexpr std::align_val_t alignment{128};  // the alignment of oneTBB's allocator
};

}  // namespace holotrace
