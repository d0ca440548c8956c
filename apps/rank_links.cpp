#include "rank_links.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cstdint>
#include <exception>
#include <new>
#include <string>
#include <utility>

#include "banded_field.h"
#include "holotrace/base/archive.h"
#include "holotrace/base/error.h"
#include "holotrace/slm/encode/iterate/shared_frames.h"
#include "interrupts.h"
#include "ranks.h"

namespace holotrace {

void RankLinks::send(int to, const std::string& bytes) {
  if (ranks_.rank() == 0 && !ranks_.is_job_running) {
    ranks_.is_job_running = true;
    const std::string threads = to_message(int32_t(threads_));
    for (int rank = 1; rank < ranks_.size(); ++rank) ranks_.send(rank, tag_frames, threads);
  }
  ranks_.send(to, tag_link, bytes);
}

std::string RankLinks::receive(int from) {
  while (heard_[from].empty()) {
    Ranks::Message message = ranks_.receive();
    if (message.tag != tag_link) throw Error(fmt::format("rank {}: {}", message.from, message.bytes));
    heard_[message.from].push_back(std::move(message.bytes));
  }
  std::string bytes = std::move(heard_[from].front());
  heard_[from].pop_front();
  return bytes;
}

bool RankLinks::wait_for_job() {
  Ranks::Message message = ranks_.receive();
  if (message.tag != tag_link) return false;
  heard_[message.from].push_back(std::move(message.bytes));
  return true;
}

void serve_frames(Ranks& ranks, const Ranks::Message& first) {
  int32_t threads = 0;
  from_message(first.bytes, threads);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  size_t(threads > 0 ? threads : ranks.threads()));
  ignore_interrupts();  // rank 0 saves, and ends all ranks
  RankLinks links(ranks);
  while (links.wait_for_job()) optimise_frames_for_first_process(links);
}

namespace {

// Rank 0 then ends all ranks. Until then it may send more, and waits until that is received.
[[noreturn]] void report_failure(const Ranks& ranks, const std::string& sentence) {
  constexpr size_t most = 1000;  // a short message arrives even while rank 0 waits until its own is received
  ranks.send(0, tag_failed, sentence.substr(0, most));
  for (;;) ranks.receive();
}

}  // namespace

void start_times(Ranks& ranks) {
  ranks.is_job_running = true;
  for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, tag_times);
}

std::vector<std::string> wait_for_times(Ranks& ranks) {
  std::vector<std::string> notes;
  for (int rank = 1; rank < ranks.size(); ++rank) {
    const Ranks::Message message = ranks.receive();
    if (message.tag != tag_finished) throw Error(fmt::format("rank {}: {}", message.from, message.bytes));
    std::vector<std::string> heard;
    from_message(message.bytes, heard);
    notes.insert(notes.end(), heard.begin(), heard.end());
  }
  ranks.is_job_running = false;
  return notes;
}

void report_times(Ranks& ranks, const std::vector<std::string>& notes) {
  ranks.send(0, tag_finished, to_message(notes));
}

void serve_ranks(Ranks& ranks, const std::function<void()>& run_command) {
  const Ranks::Message message = ranks.receive();
  const bool has_bands = message.tag == tag_job;
  try {
    if (has_bands) serve_bands(ranks, message);
    if (message.tag == tag_frames) serve_frames(ranks, message);
    if (message.tag == tag_times) {
      ignore_interrupts();  // rank 0 ends all ranks
      run_command();
      ranks.receive();  // the end
    }
  } catch (const std::bad_alloc&) {
    report_failure(ranks, has_bands ? "expected enough memory for a band, but it ran out; give a smaller --memory or "
                                      "fewer ranks"
                                    : "expected enough memory for the frames of a rank, but it ran out; use fewer "
                                      "frames or fewer ranks on a machine");
  } catch (const std::exception& error) {
    report_failure(ranks, error.what());
  }
  ranks.leave();
}

void dismiss_ranks(Ranks& ranks, int exit_code) {
  if (ranks.is_job_running) ranks.end_all(exit_code);
  for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, tag_end);
  ranks.leave();
}

}  // namespace holotrace
