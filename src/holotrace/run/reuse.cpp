#include "holotrace/run/reuse.h"

#include <algorithm>
#include <utility>

#include "holotrace/base/archive.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/members.h"
#include "holotrace/denoise/denoise.h"
#include "holotrace/run/scene_targets.h"

namespace holotrace {

EncodeParams encoding_of(const Job& job) {
  EncodeParams params = job.encode;
  if (traits_of(params.method).aims_at_targets && params.target_distances.empty())
    params.target_distances = job.camera.distances;
  return params;
}

uint64_t cause_of_results(Job job) {
  job.time = 0;
  job.shutter = {};  // its moments are there
  job.last_key.reset();
  if (job.tracked) job.tracked->end = 0;
  job.animate = {};
  job.eye = {};  // `tracked` has what follows from it
  job.warnings.clear();
  std::string denoiser;  // pictures are others with it
  if (job.encode.denoise != Denoise::none) try {
      denoiser = find_denoiser();
    } catch (const NoDenoiser&) {
    }
  return fingerprint_of(job, denoiser);
}

uint64_t cause_of_waves(const Job& job) {
  return fingerprint_of(job.scene, job.wavelengths, job.slm, job.trace, job.synthesize, encoding_of(job));
}

uint64_t cause_of_eye_light(Job job) {
  job.tracked.reset();
  job.chosen.clear();  // it names the place of the eye
  job.camera.eye = {};
  job.trace.frames = 1;
  std::fill(job.encode.eye.begin(), job.encode.eye.end(), 0.0);
  return std::max<uint64_t>(1, cause_of_results(std::move(job)));
}

void check_time_of_film(const Job& job, const Job& first, bool from_last) {
  require(job.wavelengths == first.wavelengths,
          "expected the same wavelengths at all times of a film, got others at {}; give \"wavelength\" in the scene",
          format_time(job.time));
  require(!job.encode.is_rolling || from_last,
          "expected rolling frames in a film that goes on from the last time; give from_last, or leave out rolling");
  if (!from_last) return;
  require(
      aims_at_scene(job),
      "expected from_last only with the method sgd and the target render or light-field; give [encode] target, or leave "
      "it out");
  require(
      job.trace.frames == first.trace.frames,
      "expected as many frames at all times of a film that goes on from the last time, got {} at first and {} at {}; give "
      "[trace] frames, or leave from_last out",
      first.trace.frames, job.trace.frames, format_time(job.time));
}

}  // namespace holotrace
