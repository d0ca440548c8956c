#pragma once

namespace holotrace {

/// What a message between ranks is: of a field in bands (band_messages.h); of frames (rank_links.h); the end, from rank 0; or
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
  tag_end,
  tag_failed
};

}  // namespace holotrace
