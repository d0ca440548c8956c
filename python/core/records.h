#pragma once

#include <memory>
#include <vector>

#include "holotrace/data/image.h"
#include "holotrace/data/job.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/report.h"
#include "holotrace/data/sources.h"
#include "holotrace/run/scene_targets.h"

namespace holotrace::python {

/// What a run or a view keeps to be saved later.
struct RunRecord {
  Job job;  ///< with the numbers that its quality chooses
  Report report;
  std::vector<Sources> points;                      ///< as in RunResults
  std::vector<Image> radiances;                     ///< as in RunResults
  std::shared_ptr<const KeptEyeLight> eye_light{};  ///< as in RunResults
};
struct ViewRecord {
  CameraParams camera;
  double eye_separation = 0;  ///< [m]; 0: no stereo pair
  Report report;
};

}  // namespace holotrace::python
