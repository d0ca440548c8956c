#include "ranks.h"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>
#include <vector>

#include "holotrace/base/error.h"

#ifdef HOLOTRACE_HAS_MPI
// Only the C interface: MPI has withdrawn the one of C++.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>
#endif

namespace holotrace {
namespace {

// The number of ranks that a launcher reports: mpirun of Open MPI, of MPICH and its derivatives, or another's PMIx.
int launched_ranks() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* text = std::getenv(name)) return std::max(1, std::atoi(text));
  return std::getenv("PMIX_RANK") ? 1 : 0;
}

}  // namespace

#ifdef HOLOTRACE_HAS_MPI

namespace {

cpu_set_t own_cores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  sched_getaffinity(0, sizeof cores, &cores);
  return cores;
}

// The cores of this rank, divided by the number of ranks on this machine that may use them, too.
int fair_threads() {
  MPI_Comm machine;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  int size = 1;
  MPI_Comm_size(machine, &size);
  const cpu_set_t own = own_cores();
  std::vector<cpu_set_t> all(static_cast<size_t>(size));
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

}  // namespace

Ranks::Ranks(int& argc, char**& argv) : has_launcher_(launched_ranks() > 0) {
  if (!has_launcher_) return;
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  threads_ = fair_threads();
}

void Ranks::send(int to, int tag, const void* bytes, size_t size) const {
  require(size < size_t(1) << 31, "expected a message below 2 GiB, got {} bytes", size);
  MPI_Send(bytes, int(size), MPI_BYTE, to, tag, MPI_COMM_WORLD);
}

std::optional<Ranks::Message> Ranks::try_receive() const {
  int is_there = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &is_there, &status);
  if (!is_there) return std::nullopt;
  int size = 0;
  MPI_Get_count(&status, MPI_BYTE, &size);
  Message message{status.MPI_SOURCE, status.MPI_TAG, std::string(size_t(size), '\0')};
  MPI_Recv(message.bytes.data(), size, MPI_BYTE, message.from, message.tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return message;
}

void Ranks::leave() {
  if (has_launcher_) MPI_Finalize();
}

void Ranks::end_all(int exit_code) const {
  if (has_launcher_) MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::_Exit(exit_code);
}

#else

Ranks::Ranks(int&, char**&) {
  require(launched_ranks() <= 1,
          "expected a build with MPI to be started by a launcher of {} processes, got one without; build with "
          "-DHOLOTRACE_MPI=ON, or start it alone",
          launched_ranks());
}

void Ranks::send(int, int, const void*, size_t) const {}
std::optional<Ranks::Message> Ranks::try_receive() const { return std::nullopt; }
void Ranks::leave() {}
void Ranks::end_all(int exit_code) const { std::_Exit(exit_code); }

#endif

int Ranks::threads() const { return threads_; }

Ranks::Message Ranks::receive() const {
  for (;;) {
    if (std::optional<Message> message = try_receive()) return std::move(*message);
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
}

}  // namespace holotrace
