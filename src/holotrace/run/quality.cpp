#include "holotrace/run/quality.h"

#include "holotrace/run/scene_targets.h"

namespace holotrace {
namespace {

struct Effort {
  int frames, planes, iterations;
};

Effort effort_of(Quality quality) {
  switch (quality) {
    case Quality::draft:
      return {4, 10, 50};
    case Quality::good:
      return {8, 16, 150};
    case Quality::best:
      return {16, 24, 300};
    case Quality::as_given:
      break;
  }
  return {1, most_target_planes, sgd_iterations};
}

}  // namespace

Job with_quality(Job job) {
  if (job.encode.quality == Quality::as_given || !aims_at_scene(job)) return job;
  const Effort effort = effort_of(job.encode.quality);
  if (job.trace.frames == 1) job.trace.frames = effort.frames;
  if (job.encode.planes == 0) job.encode.planes = effort.planes;
  if (job.encode.iterations == 0) job.encode.iterations = effort.iterations;
  return job;
}

}  // namespace holotrace
