#pragma once

namespace holotrace {

/// The most multiply-adds per second of bf16 factors into floats, on all threads; 0 where the processor has none.
struct Bf16Peaks {
  double vectors = 0;  ///< AVX512_BF16: vdpbf16ps, 32 in an instruction
  double tiles = 0;    ///< AMX: tdpbf16ps, 8192 in an instruction
};

/// Loops that stay in the registers, as many sums side by side as hide each other's delay. Takes some 50 ms for each.
Bf16Peaks measure_bf16_peaks();

}  // namespace holotrace
