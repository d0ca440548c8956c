#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/slm.h"
#include "holotrace/wave/shared/placed_field.h"

namespace holotrace {

/// The first step of look (camera.h), which does not depend on the distance: the light that passes the encoder's stop
/// and the camera's pupil, in the pupil's plane. A program that changes only the focus keeps it.
///
/// All of it is done on the device that propagation.device names, and the light stays there. The device `auto` is the one
/// that is expected to be the fastest, by the rates of stage_on_device.h: the transfer of the shown light counts, unless it is
/// there already. If it fails, a warning says why, and the processor takes over.
/// @param returns  whether the caller needs the light on the processor: its return then counts for `auto`
/// @return         the shown light itself if all of it passes unchanged; empty light if none arrives
/// @throws Error   as look does
/// Facts: those of the stop and the propagation; `device`, its name.
PlacedField light_in_pupil(const PlacedField& shown, const Slm& slm, const PropagateParams& propagation,
                           const CameraParams& camera, const Observer& observer = {}, bool returns = false);

/// The columns begin … end − 1 of a row.
struct OpenColumns {
  int32_t begin = 0, end = 0;
};

/// The samples in each row of a grid whose centres lie in a camera's pupil.
/// @throws Error  if there are none
std::vector<OpenColumns> columns_in_pupil(const Grid& grid, const CameraParams& camera);

/// The part of the pupil's plane that light of the panel reaches. Light leaves the panel up to the
/// angle that its samples represent; half a panel is added for diffraction.
std::optional<Grid> pupil_window(const Grid& shown, double wavelength, const CameraParams& camera);

/// A propagation to a window of the same pitch, by the same method.
PropagateParams to_window(const Grid& window, const PropagateParams& propagation);

/// Samples beside each edge of the window for the light that a stop spreads; a periodic window needs none.
int margin_of(const std::optional<SpectralFilter>& stop, const Grid& shown, const PropagateParams& window);

/// The sensor's window with explicit size and pitch, for a field whose window is not that of the light shown: in the
/// pupil it is smaller, behind a stop larger.
PropagateParams with_its_size(PropagateParams sensor, const Grid& shown);

/// Warns if the eye is outside the viewing zone, in which at least half of order 0 is seen.
void warn_outside_eyebox(const Field& shown, const Slm& slm, const CameraParams& camera, const Observer& observer);

}  // namespace holotrace
