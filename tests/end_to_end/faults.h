#pragma once

#include <string>
#include <vector>

#include "support/program.h"

namespace holotrace::test {

/// What happens at a call of the system, as `strace --inject` takes it.
struct Fault {
  std::string calls;   ///< such as "write" or "?rename,renameat2"; ? where not every system has it
  std::string effect;  ///< such as "error=ENOSPC" or "signal=SIGINT"
  int at = 1;          ///< number of the call, from 1; each kind of call and each thread counts by itself
};

/// The end of a program with a fault, and the call that failed, such as `write(5</tmp/a.png>, …) = -1 ENOSPC …`; "" if
/// none did.
struct FaultyRun {
  Outcome outcome;
  std::string call;
};

/// Whether strace is here and may watch other programs.
bool has_strace(const Workplace& work);

/// Runs `holotrace arguments…` in which the call number `fault.at` fails or raises a signal.
FaultyRun run_with(const Workplace& work, const Fault& fault, const std::vector<std::string>& arguments);

}  // namespace holotrace::test
