#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "holotrace/data/panel_hologram.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/report.h"
#include "holotrace/run/stage.h"
#include "holotrace/run/view_series.h"
#include "holotrace/run/viewpoints.h"

namespace holotrace {

/// Holograms that are shown one after the other. Memory holds one of them at a time.
struct HologramSeries {
  size_t count = 0;
  std::function<PanelHologram(size_t i)> at;
};

/// How holograms are lit and seen.
struct ViewingParams {
  ShowParams show;
  PropagateParams propagation;
  CameraParams camera;
  std::vector<Viewpoint> from;  ///< viewpoints(camera), or some of them
};

/// The camera's pictures of a series of holograms, each kind with a common exposure.
struct SeriesViews {
  ViewSeries views;   ///< at the distances of the camera
  ViewSeries sweep;   ///< empty unless the camera asks for a sweep
  ViewSeries stereo;  ///< for the left and the right eye; empty without a stereo pair
};

/// What a camera sees of holograms on virtual SLMs: `holotrace show`. Holograms of one wavelength and name are averaged as
/// frames, different names are added, and different wavelengths become colours (view/combine_views.h).
///
/// Stages: those of view_hologram (viewing.h), and the curves of a sweep (report_sweep).
/// @throws Error  for no hologram, for views that do not fit in the machine's memory, and as view_hologram does
SeriesViews view_holograms(const HologramSeries& holograms, const ViewingParams& params, Report& report,
                           const StageObserver& watch = {});

}  // namespace holotrace
