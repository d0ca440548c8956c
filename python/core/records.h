#pragma once

#include "holotrace/data/job.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/report.h"

namespace holotrace::python {

/// What a run or a view keeps to be saved later.
struct RunRecord {
  Job job;  ///< with the numbers that its quality chooses
  Report report;
};
struct ViewRecord {
  CameraParams camera;
  double eye_separation = 0;  ///< [m]; 0: no stereo pair
  Report report;
};

}  // namespace holotrace::python
