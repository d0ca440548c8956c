#pragma once

#include <string>
#include <vector>

#include "holotrace/data/hologram.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/params/render.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/source_part.h"
#include "holotrace/run/repeated_stages.h"
#include "holotrace/run/viewpoints.h"
#include "holotrace/view/combine_views.h"

namespace holotrace {

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
/// @return      the light on the panel at the first illumination state [W]
/// @throws Error  as illumination states, show, look and CombinedViews::add do
double view_hologram(const Hologram& hologram, const Slm& slm, const ShowParams& show,
                     const PropagateParams& propagation, const std::vector<Viewpoint>& from, RepeatedStages& repeat,
                     std::vector<CombinedViews>& sums);

/// Stages that view_hologram runs for a hologram at so many illumination states of its light.
int64_t viewing_calls(int64_t states, const std::vector<Viewpoint>& from);

/// What showing one hologram and looking at it from all viewpoints takes, with a source, or with that part of it which
/// moves light the furthest (widest_part, moment_plan.h).
struct ViewingNeed {
  double columns = 0, rows = 0;  ///< pixels of the first viewpoint's sensor
  double shown = 0;              ///< bytes of the field that leaves the panel
  double passing = 0;            ///< bytes that its transform, or the way to a sensor, takes beside it
};
/// @throws Error  for less than 1 sample per pixel, and as magnification and looking_bytes do
ViewingNeed viewing_need(const Slm& slm, int subpixels, const std::vector<double>& wavelengths, ImageSide image,
                         const PropagateParams& propagation, const std::vector<Viewpoint>& from,
                         const SourcePart& source = {});

/// Bytes of the sums and irradiances of `sets` kinds of holograms, seen by a sensor of that many pixels, and of the
/// pictures that they become.
double viewing_bytes(double sensor_pixels, size_t viewpoints, double sets, int64_t states);

}  // namespace holotrace
