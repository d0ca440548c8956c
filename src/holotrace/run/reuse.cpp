#include "holotrace/run/reuse.h"

#include "holotrace/base/archive.h"
#include "holotrace/data/members.h"
#include "holotrace/denoise/denoise.h"

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
