#pragma once

#include <vector>

#include "holotrace/data/calibration.h"
#include "holotrace/data/params/calibrate.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// The test patterns that determine a panel from photographs by a bare sensor at `distance`.
///
/// `spots` and `levels`: the panel is divided into cells of about √(6λz) on a side. Each cell shows a lens in two levels,
///
///     level(x) = upper if cos(k·r(x)) ≥ 0, else lower,   r the distance to a place of its own on the sensor
///
/// whose first order comes to a focus there, with an amplitude of |t(upper) − t(lower)|/π times that of a perfect lens.
/// The places are random, so that the picture has one pose only, and at most one period of 3 pixels away: short periods
/// lose contrast by crosstalk, long ones do not. In `spots` all cells have the same two levels, about half a wave apart;
/// where the spots lie shows the slope of the wavefront, and how bright they are, the light on the panel. In `levels`
/// each cell compares its own pair of levels.
///
/// `focus`: cos(arg Σ exp(i(θ − k·r))) in two levels, for a few spots near the middle: the light of the whole panel
/// interferes there, which shows the wavefront as a whole.
///
/// @param slm   the panel as it is assumed to be: pixels, pitch, levels, and a first guess of the phase of each level
/// @throws Error  for a panel of amplitudes, for fewer than 64 × 64 pixels, and for more measured levels than it has
std::vector<TestPattern> make_test_patterns(const Slm& slm, double wavelength, double distance,
                                            const TestPatternParams& params);

/// The phase that the panel is assumed to show at a level [rad]: its calibration, or even steps.
double assumed_phase(const Slm& slm, double level, double wavelength);

}  // namespace holotrace
