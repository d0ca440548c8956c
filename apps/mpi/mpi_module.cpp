#include "mpi/mpi_module.h"

#include <sched.h>

#include <algorithm>
#include <vector>

// Only the C interface: MPI has withdrawn the one of C++.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

namespace {

cpu_set_t own_cores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  sched_getaffinity(0, sizeof cores, &cores);
  return cores;
}

// The cores of this rank, divided by the number of ranks on this machine that may use them, too. Also numbers and
// counts the ranks on this machine.
int fair_threads(int* rank_here, int* ranks_here) {
  MPI_Comm machine;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  MPI_Comm_rank(machine, rank_here);
  MPI_Comm_size(machine, ranks_here);
  const cpu_set_t own = own_cores();
  std::vector<cpu_set_t> all(static_cast<size_t>(*ranks_here));
  MPI_Allgather(&own, sizeof own, MPI_BYTE, all.data(), sizeof own, MPI_BYTE, machine);
  MPI_Comm_free(&machine);
  int sharers = 0;
  for (const cpu_set_t& cores : all) {
    cpu_set_t common;
    CPU_AND(&common, &own, &cores);
    sharers += CPU_COUNT(&common) > 0;
  }
  return std::max(1, CPU_COUNT(&own) / std::max(1, sharers));
}

void start(int* argc, char*** argv, int* rank, int* size, int* threads, int* rank_here, int* ranks_here) {
  int level = 0;
  MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &level);
  MPI_Comm_rank(MPI_COMM_WORLD, rank);
  MPI_Comm_size(MPI_COMM_WORLD, size);
  *threads = fair_threads(rank_here, ranks_here);
}

void send(const void* bytes, int size, int to, int tag) { MPI_Send(bytes, size, MPI_BYTE, to, tag, MPI_COMM_WORLD); }

bool has_message(int* from, int* tag, int* size) {
  int is_there = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &is_there, &status);
  if (!is_there) return false;
  MPI_Get_count(&status, MPI_BYTE, size);
  *from = status.MPI_SOURCE;
  *tag = status.MPI_TAG;
  return true;
}

void receive(void* bytes, int size, int from, int tag) {
  MPI_Recv(bytes, size, MPI_BYTE, from, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

void finish() { MPI_Finalize(); }

void end_all(int exit_code) { MPI_Abort(MPI_COMM_WORLD, exit_code); }

}  // namespace

extern "C" const holotrace::MpiModule* holotrace_mpi() {
  static constexpr holotrace::MpiModule module{start, send, has_message, receive, finish, end_all};
  return &module;
}
