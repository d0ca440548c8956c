#pragma once

namespace holotrace {

/// The peak rate of multiply-adds of bf16 factors into floats [1/s], on all threads, by loops that stay in registers;
/// 0 if the processor has no such instruction. Each takes about 50 ms.
double measure_bf16_vector_peak();  ///< AVX512_BF16: vdpbf16ps, 32 multiply-adds per instruction
double measure_bf16_tile_peak();    ///< AMX: tdpbf16ps, 8192 multiply-adds per instruction

}  // namespace holotrace
