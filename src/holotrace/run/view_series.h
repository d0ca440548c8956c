#pragma once

#include <vector>

#include "holotrace/data/chart.h"
#include "holotrace/data/image.h"
#include "holotrace/run/repeated_stages.h"
#include "holotrace/run/viewpoints.h"
#include "holotrace/view/combine_views.h"

namespace holotrace {

/// Pictures with a common exposure.
struct ViewSeries {
  std::vector<Image> images;  ///< irradiance as the sensor reads it [W/m²]
  double white = 1;           ///< irradiance of white [W/m²]
};

/// The views of one kind [W/m²], before the camera's sensor reads them.
std::vector<Image> images_of(const std::vector<Viewpoint>& from, const std::vector<CombinedViews>& sums, ViewKind kind);

/// The same as the camera's sensor reads them (view/sensor_noise.h), with that irradiance as white [W/m²].
void read_views(std::vector<Image>& views, double white, ViewKind kind, const CameraParams& camera);

/// The views of one kind with a common exposure, as the camera's sensor reads them (view/sensor_noise.h).
ViewSeries expose_series(const std::vector<Viewpoint>& from, const std::vector<CombinedViews>& sums, ViewKind kind,
                         const CameraParams& camera);

/// Reports the curves of a sweep, if there is one, at the end of its stage: `position_m`; `sharpness`, the variance
/// of the irradiance over its squared mean, which is largest where most of the picture is in focus; and
/// `mean_irradiance` [W/m²].
void report_sweep(const std::vector<Viewpoint>& from, const ViewSeries& sweep, RepeatedStages& repeat);

/// A sweep as a chart: the sharpness against the distance in focus, or the mean irradiance against the eye's place.
/// @throws Error  if there is no sweep
Chart sweep_chart(const std::vector<Viewpoint>& from, const ViewSeries& sweep);

}  // namespace holotrace
