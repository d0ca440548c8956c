#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace holotrace {

/// Uninitialised memory that begins at a multiple of 128 bytes: whole vectors of every instruction set, and no cache line that
/// others write to. From 2 MB on it has huge pages where the system grants them, because the first access to each ordinary
/// page takes longer than most work on its samples; and some such memory is kept for the next call when it is
/// freed (keep_freed_memory). Thread-safe.
/// @throws std::bad_alloc
void* allocate_aligned(size_t bytes);

/// @param bytes  as they were allocated
void free_aligned(void* memory, size_t bytes);

/// Keeps at most so much freed memory for the next calls of allocate_aligned, at first 64 MB. A program that repeats its work
/// may ask for more.
void keep_freed_memory(size_t bytes);
/// The most that is kept now.
size_t most_kept_memory();

/// allocate_aligned for containers.
template <class T>
struct AlignedAllocator {
  using value_type = T;
  using is_always_equal = std::true_type;

  /// Whether values that are made without arguments are zero. Else they are what the memory holds.
  bool makes_zeros = true;

  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>& other) : makes_zeros(other.makes_zeros) {}

  static AlignedAllocator without_zeros() {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
    AlignedAllocator allocator;
    allocator.makes_zeros = false;
    return allocator;
  }

  template <class U>
  void construct(U* place) {
    if (makes_zeros) std::construct_at(place);
  }
  AlignedAllocator select_on_container_copy_construction() const { return {}; }

  T* allocate(size_t count) { return static_cast<T*>(allocate_aligned(count * sizeof(T))); }
  void deallocate(T* data, size_t count) { free_aligned(data, count * sizeof(T)); }

  template <class U>
  bool operator==(const AlignedAllocator<U>&) const {
    return true;
  }
};

}  // namespace holotrace
