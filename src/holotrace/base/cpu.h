#pragma once

#include <string>

namespace holotrace {

/// The name that the processor reports, such as "Intel(R) Xeon(R) Processor", or "unknown processor".
std::string cpu_name();

/// Whether processor and system support dot products of bf16 pairs summed in floats (AVX512_BF16: vdpbf16ps).
bool has_avx512_bf16();

/// Whether products of bf16 tiles summed in floats run here (AMX: tdpbf16ps). The system saves tile registers only
/// for a program that asks for it: the first call asks for all threads of the program and keeps the answer.
bool enable_amx_bf16();

}  // namespace holotrace
