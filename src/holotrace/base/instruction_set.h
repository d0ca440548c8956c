#pragma once

#include <string>
#include <vector>

namespace holotrace {

/// The instruction sets that this machine has and vector code is compiled for, best first, by Highway's names: "AVX3"
/// (AVX-512), "AVX2", "SSE4", … One whose floats are those of a better one on the list (SSSE3) is left out.
std::vector<std::string> instruction_sets();

/// While it lives, all code that picks its instruction set at run time picks this one: for tests and benchmarks. One at
/// a time, and not while such code runs.
class OnInstructionSet {
 public:
  /// @throws Error for a name that is not one of instruction_sets().
  explicit OnInstructionSet(const std::string& name);
  ~OnInstructionSet();
  OnInstructionSet(const OnInstructionSet&) = delete;
  OnInstructionSet& operator=(const OnInstructionSet&) = delete;
};

}  // namespace holotrace
