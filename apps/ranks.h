#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace holotrace {

struct MpiModule;

/// The processes that `mpirun -n K holotrace …` starts, ranks 0 … K−1. Without a launcher, or in a build without MPI,
/// there is only rank 0 and nothing is set up. MPI is in a module that is loaded here. For use by one thread.
class Ranks {
 public:
  /// Connects to the other ranks if a launcher started this process. @throws Error if it did but MPI was not built in
  Ranks(int& argc, char**& argv);
  Ranks(const Ranks&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  int rank_here() const { return rank_here_; }    ///< its number among the ranks on the same machine
  int ranks_here() const { return ranks_here_; }  ///< number of ranks on the same machine
  bool has_launcher() const { return mpi_ != nullptr; }

  /// Number of processor cores for this rank: its own cores, divided among the ranks that may use them.
  int threads() const;

  struct Message {
    int from = 0, tag = 0;
    std::string bytes;
  };

  /// Sends up to 2 GiB; when it returns, the bytes may be reused.
  void send(int to, int tag, const void* bytes, size_t size) const;
  void send(int to, int tag, const std::string& bytes = "") const { send(to, tag, bytes.data(), bytes.size()); }

  /// The next message to this rank; nothing if there is none.
  std::optional<Message> try_receive() const;

  /// Waits for the next message without using a core.
  Message receive() const;

  /// Disconnects from the other ranks; each of them must do the same.
  void leave();

  /// Ends all ranks at once, this one with the given exit code.
  [[noreturn]] void end_all(int exit_code) const;

  bool is_job_running = false;  ///< the other ranks are in a job: an error here ends them at once

 private:
  int rank_ = 0, size_ = 1, threads_ = 0, rank_here_ = 0, ranks_here_ = 1;
  const MpiModule* mpi_ = nullptr;  // none without a launcher
};

/// What a message between ranks is: of a field in bands (banded_field.h); of frames (rank_links.h); of the times of a film, which each
/// rank knows from the command line (animate_command.cpp); the end, from rank 0; or
/// what has failed, from another rank.
enum RankTag {
  tag_job,
  tag_set,
  tag_band,
  tag_ready,
  tag_rows,
  tag_finished,
  tag_frames,
  tag_link,
  tag_times,
  tag_end,
  tag_failed
};

}  // namespace holotrace
