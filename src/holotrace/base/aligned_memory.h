#pragma once

#include <cstddef>

namespace holotrace {

/// Uninitialised memory that begins at a multiple of 128 bytes: whole vectors of every instruction set, and no cache line that
/// others write to. From 2 MB on it has huge pages where the system grants them, because the first access to each ordinary
/// page takes longer than most work on its samples; and some such memory, 64 MB in all, is kept for the next call when it is
/// freed. Thread-safe.
/// @throws std::bad_alloc
void* allocate_aligned(size_t bytes);

/// @param bytes  as they were allocated
void free_aligned(void* memory, size_t bytes);

/// allocate_aligned for containers.
template <class T>
struct AlignedAllocator {
  using value_type = T;

  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}

  T* allocate(size_t count) { return static_cast<T*>(allocate_aligned(count * sizeof(T))); }
  void deallocate(T* data, size_t count) { free_aligned(data, count * sizeof(T)); }

  template <class U>
  bool operator==(const AlignedAllocator<U>&) const {
    return true;
  }
};

}  // namespace holotrace
