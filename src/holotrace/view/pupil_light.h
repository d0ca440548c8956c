#pragma once

#include <optional>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// The first step of look (camera.h), which does not depend on the distance: the light that passes the encoder's stop
/// and the camera's pupil, in the pupil's plane. A program that changes only the focus keeps it.
/// @return        nothing if all light passes unchanged; a field without samples if none arrives
/// @throws Error  as look does
std::optional<Field> light_in_pupil(const Field& shown, const Slm& slm, const PropagateParams& propagation,
                                    const CameraParams& camera, const Observer& observer = {});

/// The part of the pupil's plane that light of the panel reaches. Light leaves the panel up to the
/// angle that its samples represent; half a panel is added for diffraction.
std::optional<Grid> pupil_window(const Grid& shown, double wavelength, const CameraParams& camera);

/// A propagation to a window of the same pitch, by the same method and on the same device.
PropagateParams to_window(const Grid& window, const PropagateParams& propagation);

/// Samples beside each edge of the window for the light that a stop spreads; a periodic window needs none.
int margin_of(const std::optional<SpectralFilter>& stop, const Grid& shown, const PropagateParams& window);

/// The sensor's window with explicit size and pitch, for a field whose window is not that of the light shown: in the
/// pupil it is smaller, behind a stop larger.
PropagateParams with_its_size(PropagateParams sensor, const Grid& shown);

/// Warns if the eye is outside the viewing zone, in which at least half of order 0 is seen.
void warn_outside_eyebox(const Field& shown, const Slm& slm, const CameraParams& camera, const Observer& observer);

}  // namespace holotrace
