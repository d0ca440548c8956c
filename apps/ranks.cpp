#include "ranks.h"

#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "holotrace/base/error.h"
#include "mpi/mpi_module.h"
#include "program_module.h"

namespace holotrace {
namespace {

// The number of ranks that a launcher reports: mpirun of Open MPI, of MPICH and its derivatives, or another's PMIx.
int launched_ranks() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* text = std::getenv(name)) return std::max(1, std::atoi(text));
  return std::getenv("PMIX_RANK") ? 1 : 0;
}

#ifdef HOLOTRACE_HAS_MPI

const MpiModule* load_module(int ranks) {
  // Global: MPI's own modules look for its functions among those of the program.
  void* function = load({"mpi", mpi_module_function, RTLD_NOW | RTLD_GLOBAL},
                        fmt::format("{} processes need it: is MPI installed here?", ranks));
  require(function != nullptr,
          "expected holotrace_mpi.so beside the program for {} processes, got none; install Holotrace again", ranks);
  return reinterpret_cast<const MpiModule* (*)()>(function)();
}

#else

const MpiModule* load_module(int ranks) {
  require(ranks <= 1,
          "expected a build of holotrace with MPI for {} processes under mpirun, got a build without MPI; build with "
          "-DHOLOTRACE_MPI=ON, or run holotrace without mpirun",
          ranks);
  return nullptr;
}

#endif

}  // namespace

Ranks::Ranks(int& argc, char**& argv) {
  const int ranks = launched_ranks();
  if (ranks == 0) return;
  mpi_ = load_module(ranks);
  if (mpi_) mpi_->start(&argc, &argv, &rank_, &size_, &threads_, &rank_here_, &ranks_here_);
}

void Ranks::send(int to, int tag, const void* bytes, size_t size) const {
  require(size < size_t(1) << 31, "expected a message below 2 GiB, got {} bytes", size);
  if (mpi_) mpi_->send(bytes, int(size), to, tag);
}

std::optional<Ranks::Message> Ranks::try_receive() const {
  Message message;
  int size = 0;
  if (!mpi_ || !mpi_->has_message(&message.from, &message.tag, &size)) return std::nullopt;
  message.bytes.resize(size_t(size));
  mpi_->receive(message.bytes.data(), size, message.from, message.tag);
  return message;
}

void Ranks::leave() {
  if (mpi_) mpi_->finish();
}

void Ranks::end_all(int exit_code) const {
  if (mpi_) mpi_->end_all(exit_code);
  std::_Exit(exit_code);
}

int Ranks::threads() const { return threads_; }

Ranks::Message Ranks::receive() const {
  for (;;) {
    if (std::optional<Message> message = try_receive()) return std::move(*message);
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
}

}  // namespace holotrace
