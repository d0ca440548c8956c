#pragma once

#include <cstddef>

namespace holotrace {

/// What ranks.cpp needs of MPI, from a module that it loads under a launcher only: MPI's libraries would cost every other
/// command time and memory.
struct MpiModule {
  /// Connects to the other ranks.
  /// @param threads     number of cores for this rank
  /// @param rank_here   number of this rank among those on the same machine
  /// @param ranks_here  their number
  void (*start)(int* argc, char*** argv, int* rank, int* size, int* threads, int* rank_here, int* ranks_here);
  void (*send)(const void* bytes, int size, int to, int tag);
  /// Whether there is a message to this rank; who sent it, its tag and its size.
  bool (*has_message)(int* from, int* tag, int* size);
  void (*receive)(void* bytes, int size, int from, int tag);
  void (*finish)();
  void (*end_all)(int exit_code);
};

/// The name of the function `const MpiModule* holotrace_mpi()` in the module.
constexpr const char* mpi_module_function = "holotrace_mpi";

}  // namespace holotrace
