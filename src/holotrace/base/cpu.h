#pragma once

#include <string>

namespace holotrace {

/// The processor's own name for itself, as "Intel(R) Xeon(R) Processor", or "unknown processor".
std::string cpu_name();

/// Whether dot products of pairs of bf16 numbers into floats run here (AVX512_BF16: vdpbf16ps), processor and system.
bool has_avx512_bf16();

/// Whether products of tiles of bf16 numbers into floats run here (AMX: tdpbf16ps). The system keeps the state of tiles
/// only for a program that asked for it: the first call asks, for all threads of the program, and the answer is kept.
bool enable_amx_bf16();

}  // namespace holotrace
