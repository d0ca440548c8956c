#pragma once

#include <cstdint>

#include "holotrace/data/image.h"
#include "holotrace/data/params/camera.h"

namespace holotrace {

/// What a sensor reads of a whole exposure, whose light comes in electrons and whose reader errs:
///
///     n ~ Poisson(N·I/white),   reading = clamp(n + σ·g, 0, N)·white/N,   g ~ Normal(0, 1)
///
/// N = camera.electrons is what a white pixel holds, its full well; σ = camera.read_noise. Below the full well a
/// reading of m electrons has the variance m + σ². I is the sum of all frames and colours that one exposure takes: a
/// channel of a picture in colour is a pixel of its own, and its light below 0 (CombinedViews) counts as none. Levels of the
/// picture's file round the reading once more. Numbers come from counters: the same for the same seed and `exposure`.
///
/// @param view      irradiance [W/m²]
/// @param white     irradiance that fills a pixel [W/m²], above 0
/// @param exposure  of several: each has a noise of its own
/// @return          irradiance as read, in [0, white]; the view itself where camera.electrons is 0
/// @throws Error    as check_sensor does, and for a white that is not above 0
/// Reference: J. R. Janesick, Photon Transfer, 2007, chapters 3 and 5. Poisson numbers are the standard library's.
Image add_sensor_noise(const Image& view, double white, const CameraParams& camera, uint32_t exposure = 0);

/// @throws Error  for electrons beyond 0 … 1e12, a read noise below 0, or one without electrons
void check_sensor(const CameraParams& camera);

}  // namespace holotrace
