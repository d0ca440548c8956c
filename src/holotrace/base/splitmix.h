#pragma once

#include <cstdint>

// Splitmix64 (Steele, Lea and Flood, OOPSLA 2014), a generator that adds a step and mixes the sum.

namespace holotrace {

/// 2⁶⁴ over the golden ratio: the step of splitmix64.
inline constexpr uint64_t splitmix_step = 0x9e3779b97f4a7c15;

/// The finalizer of splitmix64: a bijection of 64 bits in which each bit of the result depends on all bits.
constexpr uint64_t mix(uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9;
  v = (v ^ (v >> 27)) * 0x94d049bb133111eb;
  return v ^ (v >> 31);
}

}  // namespace holotrace
