#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace holotrace {

/// The name that the processor reports, such as "Intel(R) Xeon(R) Processor", or "unknown processor".
std::string cpu_name();

/// Whether processor and system support dot products of bf16 pairs summed in floats (AVX512_BF16: vdpbf16ps).
bool has_avx512_bf16();

/// Whether products of bf16 tiles summed in floats run here (AMX: tdpbf16ps). The system saves tile registers only
/// for a program that asks for it: the first call asks for all threads of the program and keeps the answer.
bool enable_amx_bf16();

/// The instruction sets that this machine has and that vector code is compiled for, best first, by Highway's names:
/// "AVX3" (AVX-512), "AVX2", "SSE4", … Plain loops are named only where there is nothing else.
std::vector<std::string> instruction_sets();

/// All code that picks its instruction set at run time uses this one from here on, and instruction_sets() has no other;
/// "" allows all again. Capitals do not count, and "AVX512" is AVX3. To be called while no such code runs.
/// @throws Error for a name that is not one of instruction_sets()
void force_instruction_set(const std::string& name);

/// Whether force_instruction_set has not set the best instruction set of this machine aside.
bool allows_best_instruction_set();

/// While an object exists, all code that picks its instruction set at run time uses this one; for tests and
/// benchmarks. Only one object may exist at a time; create and destroy it only while no such code runs.
class OnInstructionSet {
 public:
  /// @throws Error for a name that is not one of instruction_sets().
  explicit OnInstructionSet(const std::string& name);
  ~OnInstructionSet();
  OnInstructionSet(const OnInstructionSet&) = delete;
  OnInstructionSet& operator=(const OnInstructionSet&) = delete;
};

/// Bytes of physical memory that this machine has.
double physical_memory();

/// Checks memory before a large allocation; the system would otherwise kill the program without a message.
/// @throws Error if this machine has less than `bytes` of memory; the message names what needs them (`what`)
void require_memory(double bytes, std::string_view what);

/// Number of threads that parallel_for uses: all that the machine has, or fewer if --threads says so.
int thread_count();

/// Number of threads that the processor runs at once, whatever --threads says. Forecasts by which `auto` chooses assume
/// all of them: the choice, and so the bytes of the result, must not depend on --threads.
int processor_threads();

}  // namespace holotrace
