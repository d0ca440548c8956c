#pragma once

namespace holotrace {

/// The most multiply-adds per second of bf16 factors into floats, on all threads, by loops that stay in the registers;
/// 0 where the processor has none. Takes some 50 ms for each.
double measure_bf16_vector_peak();  ///< AVX512_BF16: vdpbf16ps, 32 in an instruction
double measure_bf16_tile_peak();    ///< AMX: tdpbf16ps, 8192 in an instruction

}  // namespace holotrace
