#include "serve_ranks.h"

#include <exception>
#include <new>
#include <string>

#include "banded_field.h"
#include "rank_links.h"
#include "rank_tags.h"

namespace holotrace {
namespace {

// Rank 0 then ends all ranks. Until then it may send more, and waits until that is received.
[[noreturn]] void report_failure(const Ranks& ranks, const std::string& sentence) {
  constexpr size_t most = 1000;  // a short message arrives even while rank 0 waits until its own is received
  ranks.send(0, tag_failed, sentence.substr(0, most));
  for (;;) ranks.receive();
}

}  // namespace

void serve_ranks(Ranks& ranks) {
  const Ranks::Message message = ranks.receive();
  const bool has_bands = message.tag == tag_job;
  try {
    if (has_bands) serve_bands(ranks, message);
    if (message.tag == tag_frames) serve_frames(ranks, message);
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
