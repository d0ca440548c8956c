#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "holotrace/base/aligned_memory.h"

namespace holotrace {

/// Uninitialised memory for `count` values (allocate_aligned), for work that passes over much memory.
template <class T>
class LargeBuffer {
 public:
  explicit LargeBuffer(size_t count)
      : data_(static_cast<T*>(allocate_aligned(count * sizeof(T))), Free{count * sizeof(T)}) {}

  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }

 private:
  struct Free {
    size_t bytes = 0;
    void operator()(T* data) const { free_aligned(data, bytes); }
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
