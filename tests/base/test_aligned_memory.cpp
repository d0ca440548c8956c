#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/sanitizers.h"

namespace holotrace {
namespace {

TEST(AlignedMemory, BeginsAtWholeLinesAndHoldsItsBytes) {
  for (const size_t bytes :
       {size_t(0), size_t(1), size_t(127), size_t(129), (size_t(2) << 20) - 1, (size_t(2) << 20) + 1}) {
    auto* const memory = static_cast<unsigned char*>(allocate_aligned(bytes));
    EXPECT_EQ(reinterpret_cast<uintptr_t>(memory) % 128, 0u) << bytes;
    for (size_t i = 0; i < bytes; ++i) memory[i] = static_cast<unsigned char>(i);  // the sanitizers watch the ends
    if (bytes > 0) {
      EXPECT_EQ(memory[bytes - 1], static_cast<unsigned char>(bytes - 1));
    }
    free_aligned(memory, bytes);
  }
}

TEST(AlignedMemory, ThatNoMachineHasIsRefused) {
  EXPECT_THROW(allocate_aligned(size_t(-1)), std::bad_alloc);
  EXPECT_THROW(AlignedAllocator<double>().allocate(size_t(-1) / 12), std::bad_alloc);
}

TEST(AlignedMemory, OfBlocksThatAreUsedAtOnceIsNeverShared) {
  // Blocks that are kept come back; two that are held at once must differ.
  constexpr size_t bytes = size_t(6) << 20;
  for (int round = 0; round < 3; ++round) {
    std::vector<unsigned char*> blocks;
    for (unsigned char n = 0; n < 16; ++n) {  // more than are kept
      blocks.push_back(static_cast<unsigned char*>(allocate_aligned(bytes - n)));
      blocks.back()[0] = blocks.back()[bytes - n - 1] = n;
    }
    for (unsigned char n = 0; n < 16; ++n) {
      EXPECT_EQ(blocks[n][0], n);
      EXPECT_EQ(blocks[n][bytes - n - 1], n);
      free_aligned(blocks[n], bytes - n);
    }
  }
}

#if !HOLOTRACE_ADDRESS_SANITIZER  // for which all memory is the heap's
// Whether the kernel was asked for huge pages of a place: "hg" among its flags.
bool asks_for_huge_pages(const void* place) {
  std::ifstream maps("/proc/self/smaps");
  const auto at = reinterpret_cast<uintptr_t>(place);
  bool is_here = false;
  for (std::string line; std::getline(maps, line);) {
    uintptr_t first = 0, end = 0;
    if (std::sscanf(line.c_str(), "%lx-%lx ", &first, &end) == 2) is_here = first <= at && at < end;
    if (is_here && line.starts_with("VmFlags:")) return line.find(" hg") != std::string::npos;
  }
  return false;
}

// Whether the flags show that they were asked for, which an emulator of another processor keeps to itself.
bool shows_huge_pages() {
  constexpr size_t bytes = size_t(4) << 20;
  void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return false;
  const bool is_shown = madvise(memory, bytes, MADV_HUGEPAGE) == 0 && asks_for_huge_pages(memory);
  munmap(memory, bytes);
  return is_shown;
}

TEST(AlignedMemory, OfLargeArraysIsOnHugePages) {
  if (!shows_huge_pages()) GTEST_SKIP() << "this system has no huge pages, or does not show them";
  const AlignedVector<float> large(size_t(16) << 20), small(1000);
  EXPECT_TRUE(asks_for_huge_pages(&large[large.size() / 2]));
  EXPECT_EQ(reinterpret_cast<uintptr_t>(large.data()) % (size_t(2) << 20), 0u) << "begins with a whole one";
  EXPECT_FALSE(asks_for_huge_pages(small.data()));
}

// The memory of this process, from /proc/self/statm in pages.
double resident() {
  size_t all = 0, pages = 0;
  std::ifstream("/proc/self/statm") >> all >> pages;
  return double(pages) * double(sysconf(_SC_PAGESIZE));
}

void free_many_large_arrays() {
  for (size_t megabytes = 10; megabytes < 60; megabytes += 2) AlignedVector<char> touched(megabytes << 20, 1);
}

TEST(AlignedMemory, ThatIsKeptIsLittle) {
  const double before = resident();
  free_many_large_arrays();
  EXPECT_LT(resident() - before, 80e6);  // 64 MiB, and what the heap keeps
}

TEST(AlignedMemory, ThatIsKeptIsAsMuchAsIsAsked) {
  const size_t usual = most_kept_memory();
  keep_freed_memory(0);
  const double before = resident();
  keep_freed_memory(size_t(256) << 20);
  free_many_large_arrays();
  EXPECT_GT(resident() - before, 180e6);  // the last arrays that 256 MiB hold whole, at most 58 MiB less
  EXPECT_LT(resident() - before, 290e6);
  keep_freed_memory(size_t(64) << 20);
  EXPECT_LT(resident() - before, 80e6);
  keep_freed_memory(usual);
}
#endif

// Only arrays that ask for it are not set; what they hand on sets its values again.
TEST(AlignedMemory, OfUnsetArraysIsAsItWas) {
  constexpr int side = 1024;
  constexpr size_t more = size_t(2) * side * side;
  {
    const Array2D<float> old(side, side, 7);  // memory that is kept for the next of its size
    const AlignedVector<float> first(more, 7), second(more, 7);
  }
  auto array = Array2D<float>::unset(side, side);
  EXPECT_EQ(array.nx, side);
  EXPECT_EQ(array.size(), size_t(side) * side);
  for (const float value : {array.values.front(), array.values.back()})
    EXPECT_TRUE(HOLOTRACE_ADDRESS_SANITIZER ? std::isnan(value) : value == 7) << value;
  std::fill(array.values.begin(), array.values.end(), 3.0F);
  AlignedVector<float> copy = array.values, moved = std::move(array.values);
  for (AlignedVector<float>* values : {&copy, &moved}) {
    EXPECT_EQ(values->front(), 3);
    values->resize(more);
    EXPECT_EQ(values->back(), 0) << "what an array grows by is 0";
  }
}

}  // namespace
}  // namespace holotrace
