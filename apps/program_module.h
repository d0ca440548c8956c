#pragma once

#include <string>

namespace holotrace {

/// A library that one command needs and others would load in vain: holotrace_NAME.so, beside the program where it was
/// built, and in the folder of libraries where it is installed.
struct ProgramModule {
  const char* name;      ///< "mpi"
  const char* function;  ///< the function that it gives
  int flags;             ///< of dlopen
};

/// Loads the module and returns its function; null if there is no such module.
/// @param advice  end of the sentence if it cannot be loaded: "is MPI installed here?"
/// @throws Error  if it cannot be loaded
void* load(const ProgramModule& module, const std::string& advice);

}  // namespace holotrace
