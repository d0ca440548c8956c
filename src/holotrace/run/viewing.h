#pragma once

#include <optional>
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
#include "holotrace/run/stage.h"
#include "holotrace/view/combine_views.h"

namespace holotrace {

/// Why a view is taken: at one of the camera's distances, as a part of its sweep, for one eye of a stereo pair, for an eye
/// that is beside the eyebox, or for the eye where a display takes it to be.
enum class ViewKind { distance, sweep, eye, beside, measured };

/// Whether the job asks for views of that kind. Others are taken for its report, and change nothing else.
constexpr bool is_asked_for(ViewKind kind) { return kind != ViewKind::beside && kind != ViewKind::measured; }

/// Position and target of a camera.
struct Viewpoint {
  ViewKind kind = ViewKind::distance;
  std::string stage;    ///< stage of the report: "look at 300 mm", "sweep", "stereo", "look from beside the eyebox"
  double distance = 0;  ///< from the panel to the plane in focus [m]
  double position = 0;  ///< in a sweep: the distance, or x of the eye [m]
  CameraParams camera;  ///< with its eye in position
};

/// The viewpoints of a camera: one for each of its distances; a sweep from `sweep_from` to `sweep_to` in even steps, of
/// the plane in focus, or of the eye, which then looks at the first distance; and one for each eye of a stereo pair, at
/// the first distance. Viewpoints of one stage follow each other.
///
/// @param stereo   the eyes are centred at stereo.eye, stereo.eye_separation apart; 0: no pair
/// @throws Error   for a sweep of less than 2 views, without two different ends, to a distance below 0, or of time; a
///                 parallax sweep or a stereo pair without a pupil; as check_sensor does
std::vector<Viewpoint> viewpoints(const CameraParams& camera, const RenderParams& stereo = {});

/// Where and how holograms are viewed.
struct Viewing {
  Slm slm;  ///< panel with all of its effects; `show` says which are on
  ShowParams show;
  PropagateParams propagation;
  std::vector<Viewpoint> from;
};

/// Adds the camera's view of a hologram from each viewpoint to the sums, in each of its colours (wavelengths_shown). The
/// views are averaged over the illumination
/// states of the light and the panel (illumination_plan.h), whose light does not interfere,
///
///     I(x) = Σ_states weight · look(show(hologram, state), part of the source)
///
/// The field of a state is shown once and viewed from all viewpoints. Memory holds one field and, with more than
/// one state, one irradiance per viewpoint.
///
/// Stages: "show" for each state (facts `illumination_states`; `illumination_states_why` for partly coherent light),
/// and one for each stage of the viewpoints (viewing_calls). With an odd number of samples per pixel above 1, the first hologram's "show"
/// reports the fraction of the light on the panel in each order (i, j), averaged over illumination states, as facts
/// "order_efficiency i,j", whose sum is `efficiency`.
/// @param sums  one per viewpoint
/// @return      power on the panel at the first illumination state of the first colour [W]
/// @throws Error  as illumination states, show, look and CombinedViews::add do
double view_hologram(const Hologram& hologram, const Viewing& viewing, RepeatedStages& repeat,
                     std::vector<CombinedViews>& sums);

/// Wavelengths of the light in which a hologram is shown [m]: that of `show`, else all of a joint hologram, else its own.
std::vector<double> wavelengths_shown(const Hologram& hologram, const ShowParams& show);

/// Adds a camera's view of a hologram in light of one wavelength, averaged over the illumination states, to a sum.
void add_view(const Hologram& hologram, double wavelength, const Slm& slm, const Viewpoint& from, const Image& view,
              CombinedViews& sum);

/// sum += weight · view; an empty sum counts as 0.
void add_weighted(const Image& view, double weight, Image& sum);

/// Number of stages that view_hologram runs for each colour of a hologram with so many illumination states.
int64_t viewing_calls(int64_t states, const std::vector<Viewpoint>& from);

/// Memory needed to show one hologram and view it from all viewpoints, for a source or for the part of it that
/// moves light the farthest (widest_part, illumination_plan.h).
struct ViewingNeed {
  double columns = 0, rows = 0;  ///< pixels of the first viewpoint's sensor
  double shown = 0;              ///< bytes of the field that leaves the panel
  double passing = 0;            ///< bytes that its transform, or the propagation to a sensor, needs in addition
};
/// @param wavelengths  of the holograms [m]
/// @param stop         stop of their 4f systems, if they have one
/// @throws Error       for less than 1 sample per pixel, and as magnification and looking_bytes do
ViewingNeed viewing_need(const Viewing& viewing, const std::vector<double>& wavelengths, ImageSide image,
                         const std::optional<SpectralFilter>& stop = {}, const SourcePart& source = {});

/// Bytes of the sums and irradiances of `sets` kinds of holograms, seen by a sensor of that many pixels, and of the
/// pictures made of them.
double viewing_bytes(double sensor_pixels, size_t viewpoints, double sets, int64_t states);

}  // namespace holotrace
