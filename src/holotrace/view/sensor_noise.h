#pragma once

#include <cstdint>

#include "holotrace/data/image.h"
#include "holotrace/data/params/camera.h"

namespace holotrace {

/// The reading of a sensor after a whole exposure, with shot noise and read noise:
///
///     n ~ Poisson(N·I/white),   reading = clamp(n + σ·g, 0, N)·white/N,   g ~ Normal(0, 1)
///
/// N = camera.electrons is the full well, the electrons of a white pixel; σ = camera.read_noise. Below the full well a
/// reading of m electrons has the variance m + σ². I is the sum of all frames and colours of one exposure. Each channel
/// of a colour picture counts as a pixel of its own; negative light (CombinedViews) counts as 0. The levels of the
/// picture's file add another rounding. Random numbers come from counters, fixed by the seed and `exposure`.
///
/// @param view      irradiance [W/m²]
/// @param white     irradiance that fills a pixel [W/m²], above 0
/// @param exposure  number of the exposure; each has its own noise
/// @return          irradiance as read, in [0, white]; the view itself if camera.electrons is 0
/// @throws Error    as check_sensor does, and for a white that is not above 0
/// Reference: J. R. Janesick, Photon Transfer, 2007, chapters 3 and 5. Poisson numbers: standard library.
Image add_sensor_noise(const Image& view, double white, const CameraParams& camera, uint32_t exposure = 0);

/// @throws Error  for electrons outside 0 … 1e12, a read noise below 0, or a read noise without electrons
void check_sensor(const CameraParams& camera);

}  // namespace holotrace
