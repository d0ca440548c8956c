#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "holotrace/data/chart.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/report.h"
#include "holotrace/run/stage.h"
#include "holotrace/run/viewing.h"
#include "holotrace/view/combine_views.h"

namespace holotrace {

/// Pictures with a common exposure.
struct ViewSeries {
  std::vector<Image> images;  ///< irradiance as the sensor reads it [W/m²]
  double white = 1;           ///< irradiance of white [W/m²]
};

/// The views of one kind [W/m²], before the camera's sensor reads them.
std::vector<Image> images_of(const std::vector<Viewpoint>& from, const std::vector<CombinedViews>& sums, ViewKind kind);

/// The same as the camera's sensor reads them (view/sensor.h), with that irradiance as white [W/m²].
void read_views(std::vector<Image>& views, double white, ViewKind kind, const CameraParams& camera);

/// The views of one kind, as `colours` of the camera says; before, they are in the scene's colours, as metrics compare them.
void show_colours(const std::vector<Viewpoint>& from, const std::vector<CombinedViews>& sums, ViewKind kind,
                  const CameraParams& camera, std::vector<Image>& views);

/// The views of one kind with a common exposure, as the camera's sensor reads them (view/sensor.h).
ViewSeries expose_series(const std::vector<Viewpoint>& from, const std::vector<CombinedViews>& sums, ViewKind kind,
                         const CameraParams& camera);

/// Reports the curves of a sweep, if there is one, at the end of its stage: `position_m`; `sharpness`, the variance
/// of the irradiance over its squared mean, which is largest where most of the picture is in focus; and
/// `mean_irradiance` [W/m²].
void report_sweep(const std::vector<Viewpoint>& from, const ViewSeries& sweep, RepeatedStages& repeat);

/// A sweep as a chart: the sharpness against the distance in focus, or the mean irradiance against the eye's place.
/// @throws Error  if there is no sweep
Chart sweep_chart(const std::vector<Viewpoint>& from, const ViewSeries& sweep);

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
