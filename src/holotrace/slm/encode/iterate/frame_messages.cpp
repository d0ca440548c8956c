#include "holotrace/slm/encode/iterate/frame_messages.h"

#include "holotrace/base/archive.h"
#include "holotrace/data/members.h"

namespace holotrace {

std::string job_message(const FrameJob& job) {
  return to_message(job.slm, job.params, uint64_t(job.frames_of_all), uint64_t(job.frames.size()));
}

FrameJob job_from(const std::string& message) {
  FrameJob job;
  uint64_t frames_of_all = 0, frames = 0;
  from_message(message, job.slm, job.params, frames_of_all, frames);
  job.frames_of_all = frames_of_all;
  job.frames.resize(frames);
  return job;
}

std::string frame_message(Hologram frame) {
  frame.slm.reset();
  return to_message(frame);
}

}  // namespace holotrace
