#pragma once

#include <string>
#include <vector>

#include "holotrace/data/chart.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/params/render.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/run/repeated_stages.h"
#include "holotrace/view/combine_views.h"

namespace holotrace {

/// Why a view is taken: at one of the camera's distances, as a part of its sweep, or for one eye of a stereo pair.
enum class ViewKind { distance, sweep, eye };

/// From where a camera looks, and at what.
struct Viewpoint {
  ViewKind kind = ViewKind::distance;
  std::string stage;    ///< of the report that its looking belongs to: "look at 300 mm", "sweep", "stereo"
  double distance = 0;  ///< from the panel to the plane in focus [m]
  double position = 0;  ///< sweep: the distance, or x of the eye [m]
  CameraParams camera;  ///< with its eye in its place
};

/// A view from every distance of the camera; from `sweep_from` to `sweep_to` in even steps, of the plane in focus, or
/// of the eye, which then looks at the first distance; and, for eyes that are apart, from each of them at that
/// distance. Views of one stage follow each other.
///
/// @param stereo   the eyes are about stereo.eye, stereo.eye_separation apart; 0: none
/// @throws Error   for a sweep of less than 2 views, without two ends that differ, to a distance below 0, of no time; a
///                 parallax sweep or a stereo pair without a pupil; as check_sensor does
std::vector<Viewpoint> viewpoints(const CameraParams& camera, const RenderParams& stereo = {});

/// Adds what the camera sees of a hologram, from each viewpoint, to the sums: over the illumination states of the light and the
/// panel (illumination_plan.h), whose light does not interfere,
///
///     I(x) = Σ_states weight · look(show(hologram, state), part of the source)
///
/// The field of a state is shown once and looked at from everywhere. One field is there at a time, and with more than
/// one state one irradiance per viewpoint.
///
/// Stages: "show" for each state (facts `illumination_states` and `illumination_states_why` of partly coherent light), and one for each stage
/// of the viewpoints: viewing_calls. With an odd number of samples per pixel above 1, the first hologram's "show"
/// states the part of the light on the panel that goes into each order (i, j), its mean over illumination states: facts
/// "order_efficiency i,j", whose sum is `efficiency`.
/// @param slm   with all of its effects; `show` says which are on
/// @param sums  one per viewpoint
/// @throws Error  as illumination_states, show, look and CombinedViews::add do
void view_hologram(const Hologram& hologram, const Slm& slm, const ShowParams& show, const PropagateParams& propagation,
                   const std::vector<Viewpoint>& from, RepeatedStages& repeat, std::vector<CombinedViews>& sums);

/// Stages that view_hologram runs for a hologram at so many illumination states of its light.
int64_t viewing_calls(int64_t states, const std::vector<Viewpoint>& from);

/// What showing one hologram and looking at it from all viewpoints takes, under a source of that full angle [rad].
struct ViewingNeed {
  double columns = 0, rows = 0;  ///< pixels of the first viewpoint's sensor
  double shown = 0;              ///< bytes of the field that leaves the panel
  double passing = 0;            ///< bytes that its transform, or the way to a sensor, takes beside it
};
/// @throws Error  for less than 1 sample per pixel, and as magnification and looking_bytes do
ViewingNeed viewing_need(const Slm& slm, int subpixels, const std::vector<double>& wavelengths, ImageSide image,
                         const PropagateParams& propagation, const std::vector<Viewpoint>& from,
                         double source_angle = 0);

/// Bytes of the sums and irradiances of `sets` kinds of holograms, seen by a sensor of that many pixels, and of the
/// pictures that they become.
double viewing_bytes(double sensor_pixels, size_t viewpoints, double sets, int64_t states);

/// Pictures in one exposure.
struct ViewSeries {
  std::vector<Image> images;  ///< irradiance as the sensor reads it [W/m²]
  double white = 1;           ///< [W/m²]
};

/// The views of one kind, in one exposure, as the camera's sensor reads them (view/sensor_noise.h).
ViewSeries expose_series(const std::vector<Viewpoint>& from, const std::vector<CombinedViews>& sums, ViewKind kind,
                         const CameraParams& camera);

/// States the curves of a sweep, where there is one, as the end of its stage: `position_m`; `sharpness`, the variance
/// of the irradiance over its squared mean, which is greatest where most of the picture is in focus; and
/// `mean_irradiance` [W/m²].
void report_sweep(const std::vector<Viewpoint>& from, const ViewSeries& sweep, RepeatedStages& repeat);

/// A sweep as a chart: the sharpness against the distance in focus, or the mean irradiance against the eye's place.
/// @throws Error  where there is no sweep
Chart sweep_chart(const std::vector<Viewpoint>& from, const ViewSeries& sweep);

}  // namespace holotrace
