#include "holotrace/run/reuse.h"

#include "holotrace/base/archive.h"
#include "holotrace/base/error.h"
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

void check_from_last(const Job& job) {
  require(
      aims_at_scene(job),
      "expected from_last only with the method sgd and the target render or light-field; give [encode] target, or leave it out");
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

}  // namespace holotrace
