#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

namespace holotrace {

/// Uninitialised memory for `count` values, for work that passes over much memory. It uses large pages where the
/// system has them, so that the first access and accesses with large strides cost little.
template <class T>
class LargeBuffer {
 public:
  explicit LargeBuffer(size_t count) {
    constexpr size_t page = size_t(2) << 20;
    const size_t bytes = (count * sizeof(T) + page - 1) / page * page;
    data_.reset(static_cast<T*>(std::aligned_alloc(page, bytes > 0 ? bytes : page)));
    if (!data_) throw std::bad_alloc();
    madvise(data_.get(), bytes, MADV_HUGEPAGE);  // a hint: the buffer works without it, too
  }

  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }

 private:
  struct Free {
    void operator()(T* data) const { std::free(data); }
  };
  std::unique_ptr<T[], Free> data_;
};

}  // namespace holotrace
