#include "holotrace/base/arm_processor.h"
#include "holotrace/base/machine.h"

#if defined(__x86_64__)
#include <cpuid.h>
#endif
#if defined(__aarch64__) && defined(__linux__)
#include <asm/hwcap.h>
#include <sys/auxv.h>
#endif
#if defined(__linux__)
#include <sys/syscall.h>
#include <unistd.h>
#endif

#include <cstdint>
#include <cstring>

namespace holotrace {

#if defined(__x86_64__)
namespace {

struct CpuId {
  uint32_t a = 0, b = 0, c = 0, d = 0;
};

// The registers of a CPUID leaf; all zero where this processor does not have the leaf.
CpuId cpu_id(uint32_t leaf, uint32_t subleaf = 0) {
  CpuId id;
  __get_cpuid_count(leaf, subleaf, &id.a, &id.b, &id.c, &id.d);
  return id;
}

bool has_bit(uint32_t bits, int index) { return (bits >> index) & 1; }

// The registers whose contents the system saves for a program (XCR0); 0 where it saves no extended state.
uint64_t kept_state() {
  constexpr int osxsave = 27;
  if (!has_bit(cpu_id(1).c, osxsave)) return 0;
  uint32_t low, high;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return uint64_t(high) << 32 | low;
}

bool keeps(uint64_t states) { return (kept_state() & states) == states; }

bool ask_for_tile_data() {
#if defined(__linux__)
  // The numbers are those of <asm/prctl.h>; older headers lack some of them.
  constexpr long arch_req_xcomp_perm = 0x1023, xfeature_xtiledata = 18;
  return syscall(SYS_arch_prctl, arch_req_xcomp_perm, xfeature_xtiledata) == 0;
#else
  return false;
#endif
}

}  // namespace

std::string cpu_name() {
  constexpr uint32_t first = 0x80000002, last = 0x80000004;
  if (__get_cpuid_max(0x80000000, nullptr) < last) return "unknown processor";
  char text[49] = {};
  for (uint32_t leaf = first; leaf <= last; ++leaf) {
    const CpuId id = cpu_id(leaf);
    std::memcpy(text + 16 * (leaf - first), &id, sizeof id);
  }
  const std::string name = text;
  const size_t begin = name.find_first_not_of(' ');
  return begin == std::string::npos ? "unknown processor" : name.substr(begin, name.find_last_not_of(' ') + 1 - begin);
}

bool has_avx512_bf16() {
  constexpr uint64_t vectors = 0xe6;  // SSE, AVX, and the masks and both halves of the AVX-512 registers
  constexpr int avx512f = 16, avx512bw = 30, avx512vl = 31, avx512_bf16 = 5;
  static const bool has = [] {
    const uint32_t basic = cpu_id(7).b;
    return has_bit(basic, avx512f) && has_bit(basic, avx512bw) && has_bit(basic, avx512vl) &&
           has_bit(cpu_id(7, 1).a, avx512_bf16) && keeps(vectors);
  }();
  return has;
}

bool enable_amx_bf16() {
  constexpr uint64_t tiles = 0x60000;  // tile shapes and tile data
  constexpr int amx_bf16 = 22, amx_tile = 24;
  static const bool may = [] {
    const uint32_t extended = cpu_id(7).d;
    return has_bit(extended, amx_bf16) && has_bit(extended, amx_tile) && keeps(tiles) && ask_for_tile_data();
  }();
  return may;
}

#else

std::string cpu_name() {
#if defined(__aarch64__) && defined(__linux__)
  if (getauxval(AT_HWCAP) & HWCAP_CPUID) {  // the system answers for the register, which only it can read
    uint64_t midr;
    __asm__("mrs %0, MIDR_EL1" : "=r"(midr));
    return arm_processor_name(midr);
  }
#endif
  return "unknown processor";
}

bool has_avx512_bf16() { return false; }
bool enable_amx_bf16() { return false; }

#endif

}  // namespace holotrace
