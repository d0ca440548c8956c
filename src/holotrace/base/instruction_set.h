#pragma once

#include <string>
#include <vector>

namespace holotrace {

/// The instruction sets that this machine has and that vector code is compiled for, best first, by Highway's names:
/// "AVX3" (AVX-512), "AVX2", "SSE4", … A set that handles floats as a better one on the list does (SSSE3) is left out.
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

}  // namespace holotrace
