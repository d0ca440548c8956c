#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

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

/// Buffers that outlive a call: each is lent to one call at a time; new ones are made if none is free. Thread-safe.
class Workspace {
 public:
  struct Space {
    explicit Space(size_t count) : buffer(count), count(count) {}
    LargeBuffer<float> buffer;
    size_t count;
  };
  class Loan {
   public:
    Loan(Workspace& owner, size_t floats) : owner_(owner) {
      if (floats == 0) return;
      const std::lock_guard lock(owner_.mutex_);
      const auto fits = std::find_if(owner_.spaces_.begin(), owner_.spaces_.end(),
                                     [&](const auto& space) { return space->count == floats; });
      if (fits != owner_.spaces_.end()) {
        space_ = std::move(*fits);
        owner_.spaces_.erase(fits);
      } else {
        space_ = std::make_unique<Space>(floats);
      }
    }
    ~Loan() {
      if (!space_) return;
      const std::lock_guard lock(owner_.mutex_);
      owner_.spaces_.push_back(std::move(space_));
    }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    float* data() { return space_ ? space_->buffer.data() : nullptr; }

   private:
    Workspace& owner_;
    std::unique_ptr<Space> space_;
  };

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Space>> spaces_;
};

}  // namespace holotrace
