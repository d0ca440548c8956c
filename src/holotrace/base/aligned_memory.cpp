#include "holotrace/base/aligned_memory.h"

#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <new>

#include "holotrace/base/sanitizers.h"

namespace holotrace {
namespace {

constexpr size_t huge_page = size_t(2) << 20, line = 128;
constexpr size_t page = size_t(64) << 10;  // a multiple of every system's

// Blocks that come from the system. The address sanitizer watches the heap alone, so it gets all blocks there.
bool is_large(size_t bytes) { return !HOLOTRACE_ADDRESS_SANITIZER && bytes >= huge_page; }

size_t whole_pages(size_t bytes) { return (bytes + page - 1) / page * page; }

// Whole pages from the system, which begin at a huge page. The heap would keep memory that is freed.
void* map(size_t bytes) {
  void* const all = mmap(nullptr, bytes + huge_page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (all == MAP_FAILED) throw std::bad_alloc();
  auto* const first = static_cast<char*>(all);
  const size_t before = (huge_page - reinterpret_cast<uintptr_t>(all) % huge_page) % huge_page;
  if (before > 0) munmap(first, before);
  munmap(first + before + bytes, huge_page - before);
  madvise(first + before, bytes, MADV_HUGEPAGE);  // a hint: the memory is as good without it
  return first + before;
}

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

  // Keeps a block in the place of the oldest ones, or gives it back.
  void put(void* memory, size_t bytes) {
    std::unique_lock lock(mutex_);
    if (bytes > most_) {
      lock.unlock();
      munmap(memory, bytes);
      return;
    }
    blocks_.push_back({memory, bytes});
    bytes_ += bytes;
    drop(lock);
  }

  size_t most() {
    const std::lock_guard lock(mutex_);
    return most_;
  }

  void keep(size_t most) {
    std::unique_lock lock(mutex_);
    most_ = most;
    drop(lock);
  }

 private:
  struct Block {
    void* memory;
    size_t bytes;
  };

  // Gives back what is too much, without the lock: it may take milliseconds.
  void drop(std::unique_lock<std::mutex>& lock) {
    while (bytes_ > most_) {
      const Block oldest = blocks_.front();
      blocks_.pop_front();
      bytes_ -= oldest.bytes;
      lock.unlock();
      munmap(oldest.memory, oldest.bytes);
      lock.lock();
    }
  }

  std::mutex mutex_;
  std::deque<Block> blocks_;
  size_t bytes_ = 0, most_ = size_t(64) << 20;
};

KeptBlocks& kept() {
  static auto& blocks = *new KeptBlocks;  // never destroyed: arrays may be freed while the program ends
  return blocks;
}

}  // namespace

void keep_freed_memory(size_t bytes) { kept().keep(bytes); }

size_t most_kept_memory() { return kept().most(); }

void* allocate_aligned(size_t bytes) {
  if (bytes > size_t(-1) / 2) throw std::bad_alloc();
  if (is_large(bytes)) {
    void* const kept_block = kept().take(whole_pages(bytes));
    return kept_block ? kept_block : map(whole_pages(bytes));
  }
  void* memory = nullptr;
  if (posix_memalign(&memory, line, bytes) != 0) throw std::bad_alloc();
  return memory;
}

void free_aligned(void* memory, size_t bytes) {
  if (is_large(bytes))
    kept().put(memory, whole_pages(bytes));
  else
    std::free(memory);
}

}  // namespace holotrace
