#pragma once

#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/image.h"
#include "holotrace/data/job.h"
#include "holotrace/data/report.h"
#include "holotrace/data/sources.h"
#include "holotrace/stage.h"

namespace holotrace {

/// Every box of the pipeline's picture, from a scene to what a viewer sees of its hologram.
struct Boxes {
  Image render;  ///< path-traced reference, seen from the panel's centre
  Sources sources;
  Field field;  ///< at the panel
  Hologram hologram;
  std::vector<Image> views;  ///< one per camera distance
  Report report;
};

/// The whole pipeline, one verb after the other.
/// @throws Error  as the stages do
Boxes run(const Job& job, const StageObserver& watch = {});

}  // namespace holotrace
