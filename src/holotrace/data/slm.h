#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/grid.h"

namespace holotrace {

/// What a panel's pixels do to light: delay it, weaken it, or both independently.
enum class Modulation { phase, amplitude, complex };

/// What a panel shows at one level, at its design wavelength.
struct CalibrationPoint {
  double phase = 0;      ///< [rad], not wrapped
  double amplitude = 1;  ///< modulus of the transmittance, in [0, 1]
};

/// A term of a wavefront error: Zernike polynomial Z_n^m in the OSA/ANSI norm (unit rms over the circle around the
/// panel), m of either sign, n − |m| even.
struct ZernikeTerm {
  int n = 0, m = 0;
  double rms = 0;  ///< [rad]
};

/// A pixel that shows the same level whatever it is sent.
struct DeadPixel {
  int column = 0, row = 0, level = 0;
};

/// In what a panel differs from an ideal one of its pitch, fill factor and levels. Each is on where it is not empty
/// or 0; with_effects turns off all but those named.
struct SlmEffects {
  std::vector<CalibrationPoint> calibration;  ///< one per level; none: even steps of phase or amplitude
  double crosstalk = 0;                       ///< σ of the Gaussian that blurs the phase [pixels]: fringing fields
  double gap_amplitude = 0, gap_phase = 0;    ///< of the light that the gaps between pixels send on [1, rad]
  double flicker = 0;                         ///< amplitude of the ripple of the phase in a frame, as a part of it
  std::vector<ZernikeTerm> aberration;        ///< static error of the phase: the panel's curvature
  std::shared_ptr<const Array2D<float>> phase_map;  ///< static error of the phase [rad], a value per pixel
  double dead_fraction = 0;                         ///< of the pixels, at random places and levels
  int64_t dead_seed = 1;                            ///< of those places
  std::vector<DeadPixel> dead_pixels;               ///< known ones
};

/// A spatial light modulator.
struct Slm {
  std::string name = "custom";
  Grid grid;
  Modulation modulation = Modulation::phase;
  int levels = 256;  ///< M: phase level ℓ shows range·ℓ/M at the design wavelength, amplitude level ℓ/(M−1)
  double fill_factor = 1;                  ///< F: lit part of a pixel's area, in (0, 1]
  double fill_x = 0, fill_y = 0;           ///< lit part of a pixel's side, per axis, in (0, 1]; both 0: √F
  double design_wavelength = 0;            ///< [m] where level M would show the phase range; 0: the wavelength in use
  double phase_range = 6.283185307179586;  ///< what level M would show at the design wavelength [rad]
  SlmEffects effects{};
  std::string preset{};  ///< name or file that it was read from (io/scene/slm_file.h); "": none
  std::string source{};  ///< where its figures are from, for people

  double lit_x() const { return fill_x > 0 ? fill_x : std::sqrt(fill_factor); }
  double lit_y() const { return fill_y > 0 ? fill_y : std::sqrt(fill_factor); }
};

/// A calibration at a fractional level ≥ 0: straight between its points, of which there are two or more; beyond the
/// last the phase goes on as before it, and the amplitude stays.
CalibrationPoint calibration_at(const std::vector<CalibrationPoint>& points, double level);

/// The names of the effects: calibration, crosstalk, gaps, flicker, aberration, phase-map, dead-pixels.
std::vector<std::string> slm_effect_names();

/// The panel with only those of its effects on; "all": all of them.
/// @throws Error for an unknown name, suggesting the nearest.
Slm with_effects(const Slm& slm, const std::vector<std::string>& names);

/// The names of those of a panel's effects that are on.
std::vector<std::string> effects_of(const Slm& slm);

/// @throws Error unless the grid is valid, levels are 2 … 65536, fill factors are in (0, 1], and every effect's figures
///         are in their range: a calibration with a point per level and a phase that never falls, amplitudes in
///         [0, 1], a map of the panel's pixels, dead pixels on the panel.
void check_slm(const Slm& slm);

}  // namespace holotrace
