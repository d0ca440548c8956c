#pragma once

#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "holotrace/base/process_links.h"
#include "ranks.h"

namespace holotrace {

/// The ranks of mpirun as processes that share the frames of a descent (slm/encode/iterate/shared_frames.h).
class RankLinks : public ProcessLinks {
 public:
  /// @param ranks    must outlive it
  /// @param threads  of each rank; 0: its share of the cores
  explicit RankLinks(Ranks& ranks, int threads = 0) : ranks_(ranks), threads_(threads) {}

  int count() const override { return ranks_.size(); }
  PlaceOnMachine here() const override { return {ranks_.rank_here(), ranks_.ranks_here()}; }
  /// The first call on rank 0 also starts the job: it tells every other rank to take frames, and how many threads it has.
  void send(int to, const std::string& bytes) override;
  std::string receive(int from) override;

  /// On a rank other than rank 0: waits for the next job. @return false if rank 0 has none
  bool wait_for_job();

 private:
  Ranks& ranks_;
  int threads_;
  std::map<int, std::deque<std::string>> heard_{};  // of each rank, what is not received yet
};

/// The work of a rank other than rank 0, after its first message about frames.
void serve_frames(Ranks& ranks, const Ranks::Message& first);

/// The function of every rank other than rank 0: does what rank 0 asks for until it reports the end.
/// @param run_command  runs the command line, which is that of rank 0: for the times of a film
void serve_ranks(Ranks& ranks, const std::function<void()>& run_command);

/// On rank 0: lets the other ranks run the command line, too.
void start_times(Ranks& ranks);

/// On rank 0, after its own times: waits for those of the other ranks. @return their sentences for the user
/// @throws Error  with the sentence of a rank that has failed
std::vector<std::string> wait_for_times(Ranks& ranks);

/// On another rank, after its times: says so to rank 0. @param notes  what a user should hear
void report_times(Ranks& ranks, const std::vector<std::string>& notes);

/// Lets the other ranks end, or ends them at once if they are working when the work has failed here.
void dismiss_ranks(Ranks& ranks, int exit_code);

}  // namespace holotrace
