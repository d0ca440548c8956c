#pragma once

#include <optional>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/encode/sample_loops.h"

// What every encoder begins with: checks of its input, and a hologram without levels.

namespace holotrace {

/// What the pixels of a hologram modulate: what the method writes, which for sgd and binary is what the panel can do.
Modulation modulation_of(const EncodeParams& params, const Slm& slm);

/// The panel with the effects that the levels compensate: those that are named or, if none are, those of its own file: with sgd all but
/// flicker, else its level table, crystal, wavefront errors and light.
Slm known_panel(const Slm& slm, const EncodeParams& params);

/// @throws Error  if a parameter is out of its range, an effect is unknown, or the panel has fewer levels
void check_encode_params(const Slm& slm, const EncodeParams& params);

/// Checks the parameters, and that the method fits the panel. Warns of an assumed polariser, and of effects that the levels
/// cannot compensate.
/// @throws Error  as check_encode_params does, and if the method does not fit the panel
void check_encoding(const Slm& slm, const EncodeParams& params, const Observer& observer);

/// Checks a field that is to be shown. Warns if it is not at the panel, is off the axis, or is dark.
/// @throws Error  if its grid differs from the panel's or a sample is not finite
void check_field_to_show(const Field& field, const Slm& slm, const Observer& observer);

/// The parts of that check: all but the samples; the samples; and the warning of a dark field.
/// @return  the moments of the samples, which tell whether all are finite
void check_head_to_show(const Field& head, const Slm& slm, const Observer& observer);
ModulusMoments check_samples_to_show(const Field& field, const Observer& observer);
void warn_of_dark_field(double wavelength, const Observer& observer);

/// A hologram of a field, all levels 0, with all that later stages need to know of it.
/// Facts: `encoder`, `levels`.
Hologram blank_hologram(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer);

/// The field that shows the real image: conj(U).
Field conjugate(const Field& field);

/// The stop (Hologram::filter) that a hologram with these parameters will name, known before encoding; none if it needs
/// none.
/// @throws Error  for a reference that is too steep for the pitch (off_axis.h)
std::optional<SpectralFilter> stop_of(const EncodeParams& params, const Grid& grid, double wavelength);

}  // namespace holotrace
