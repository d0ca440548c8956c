#include "holotrace/base/aligned_memory.h"

#include <sys/mman.h>

#include <cstdlib>
#include <deque>
#include <mutex>
#include <new>

namespace holotrace {
namespace {

constexpr size_t huge_page = size_t(2) << 20, page = 4096, line = 128;

bool is_large(size_t bytes) { return bytes >= huge_page; }

size_t whole_pages(size_t bytes) { return (bytes + page - 1) / page * page; }

// Large blocks that were freed, the oldest first.
class KeptBlocks {
 public:
  // A block of just that size; none if none is kept.
  void* take(size_t bytes) {
    const std::lock_guard lock(mutex_);
    for (auto block = blocks_.begin(); block != blocks_.end(); ++block)
      if (block->bytes == bytes) {
        void* const memory = block->memory;
        bytes_ -= bytes;
        blocks_.erase(block);
        return memory;
      }
    return nullptr;
  }

  // Keeps a block in the place of the oldest ones, or frees it.
  void put(void* memory, size_t bytes) {
    const std::lock_guard lock(mutex_);
    if (bytes > most) return std::free(memory);
    blocks_.push_back({memory, bytes});
    for (bytes_ += bytes; bytes_ > most; blocks_.pop_front()) {
      bytes_ -= blocks_.front().bytes;
      std::free(blocks_.front().memory);
    }
  }

 private:
#if defined(__SANITIZE_ADDRESS__)
  static constexpr size_t most = 0;  // the sanitizer sees uses of freed memory
#else
  static constexpr size_t most = size_t(64) << 20;
#endif
  struct Block {
    void* memory;
    size_t bytes;
  };
  std::mutex mutex_;
  std::deque<Block> blocks_;
  size_t bytes_ = 0;
};

KeptBlocks& kept() {
  static auto& blocks = *new KeptBlocks;  // never destroyed: arrays may be freed while the program ends
  return blocks;
}

}  // namespace

void* allocate_aligned(size_t bytes) {
  if (bytes > size_t(-1) / 2) throw std::bad_alloc();
  const size_t whole = is_large(bytes) ? whole_pages(bytes) : bytes;
  if (is_large(bytes))
    if (void* const memory = kept().take(whole)) return memory;
  void* memory = nullptr;
  if (posix_memalign(&memory, is_large(bytes) ? huge_page : line, whole) != 0) throw std::bad_alloc();
  if (is_large(bytes)) madvise(memory, whole, MADV_HUGEPAGE);  // a hint: the memory is as good without it
  return memory;
}

void free_aligned(void* memory, size_t bytes) {
  if (is_large(bytes))
    kept().put(memory, whole_pages(bytes));
  else
    std::free(memory);
}

}  // namespace holotrace
