#pragma once

#include <string>
#include <vector>

namespace holotrace {

/// The most multiply-adds per second, in single precision, that code for an instruction set reaches here.
struct MultiplyAddPeak {
  std::string instruction_set;  ///< as Highway names it: "AVX3" (AVX-512), "AVX2", "SSE4", …
  double per_second = 0;        ///< on all threads; where the set has none in one instruction, of a product and a sum
};

/// Of each instruction set that runs here, best first: loops of multiply-adds that stay in the registers, as many side
/// by side as hide each other's delay. Takes some 50 ms for each.
std::vector<MultiplyAddPeak> measure_multiply_add_peaks();

}  // namespace holotrace
