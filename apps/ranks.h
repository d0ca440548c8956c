#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace holotrace {

/// The processes that `mpirun -n K holotrace …` starts, ranks 0 … K−1. Without a launcher, and in a build without MPI,
/// there is rank 0 alone and nothing is set up. The only place of the program that knows MPI; for one thread.
class Ranks {
 public:
  /// Joins the other ranks, if a launcher started this process. @throws Error if it did and MPI was not built in
  Ranks(int& argc, char**& argv);
  Ranks(const Ranks&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  bool has_launcher() const { return has_launcher_; }

  /// Processor cores for this rank: those that it may run on, shared with the ranks that may run there too.
  int threads() const;

  struct Message {
    int from = 0, tag = 0;
    std::string bytes;
  };

  /// Sends up to 2 GiB; returns when the bytes may be reused.
  void send(int to, int tag, const void* bytes, size_t size) const;
  void send(int to, int tag, const std::string& bytes = "") const { send(to, tag, bytes.data(), bytes.size()); }

  /// The next message to this rank, nothing where none is there.
  std::optional<Message> try_receive() const;

  /// Waits for one, without burning a core.
  Message receive() const;

  /// Leaves the others, who must leave too.
  void leave();

  /// Ends all ranks at once, this one with the exit code.
  [[noreturn]] void end_all(int exit_code) const;

  bool others_work = false;  ///< they are in the midst of something, and hear no one

 private:
  int rank_ = 0, size_ = 1, threads_ = 0;
  bool has_launcher_ = false;
};

}  // namespace holotrace
