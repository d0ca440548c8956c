#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/calibration.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/calibrate.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// A measured value and its standard error.
struct Measured {
  double value = 0, error = 0;
};

/// The phase and amplitude measured at a level.
struct MeasuredLevel {
  int level = 0;
  double assumed_phase = 0;  ///< before the measurement [rad]
  Measured phase;            ///< relative to level 0 [rad]
  double amplitude = 1;      ///< relative to the largest
};

struct MeasuredTerm {
  int n = 0, m = 0;
  Measured rms;  ///< [rad]
};

/// How a photograph was seen, and how well the fitted panel explains it.
struct PhotographFit {
  std::string name;
  double correlation = 0;  ///< of the amplitudes of photograph and simulation
  double residual = 0;     ///< rms difference, relative to the mean light, of a pixel of mean light
};

/// A panel as it was found from photographs.
struct PanelFit {
  Slm slm;  ///< with the effects calibration, crosstalk, gaps, aberration and light map
  std::vector<MeasuredLevel> levels;
  Measured crosstalk;  ///< [pixels]
  Measured gap_light;  ///< modulus of the gaps' light in order 0, relative to that of lit pixels
  Measured gap_phase;  ///< [rad]
  std::vector<MeasuredTerm> aberration;
  double least_light = 1, most_light = 1;  ///< of the light map, relative to its mean
  double camera_scale = 1;                 ///< pixels of a photograph per pixel of the panel
  Measured camera_blur;        ///< variance of the camera's blur beyond its pixels' area, per axis [pixels²]
  double camera_rotation = 0;  ///< anticlockwise [rad]
  std::vector<PhotographFit> photographs;
  int iterations = 0;
  size_t pixels = 0;  ///< pixels of all photographs that were used
};

/// Finds a panel from photographs of test patterns, by least squares: the unknowns are those for which the program's own
/// simulation of the bench explains the photographs best.
///
/// 1. The largest values of all photographs are registered to those of their simulations (view/register), which gives
///    the camera's place; then wavefront, light and camera are fitted to `spots`.
/// 2. The curve is searched among φ(ℓ) = s·φ_M·(φ₀(ℓ)/φ_M)^γ for the assumed curve φ₀.
/// 3. The curvature, which spots alone cannot tell from the camera's scale, is searched with the patterns `focus`.
/// 4. All unknowns, and the camera's blur, are fitted to all photographs (Levenberg–Marquardt).
///
/// The distance counts as exact: an error of it appears as a curvature of the panel. Wavefront tilts cannot be told from
/// the camera's place and are left out. The gaps' light and the fill factor have the same effect on order 0; the fill
/// factor is the assumed one.
///
/// @param plan         patterns, each with the panel as it is assumed to be
/// @param photographs  linear light, one per pattern, of one camera that does not move
/// @throws Error       for photographs of different sizes, too dark or saturated ones, too few levels, no pattern `spots`,
///                     patterns that are not found in their photographs, and a fit that does not converge
PanelFit fit_panel(const CalibrationPlan& plan, const std::vector<Image>& photographs, const CalibrateParams& params,
                   const Observer& observer = {});

/// What a fit found, by name: values with their standard errors, in the units of the names.
nlohmann::ordered_json fit_json(const PanelFit& fit);

}  // namespace holotrace
