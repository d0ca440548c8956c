#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/choice.h"

namespace holotrace {

/// What a panel's pixels do to light: change its phase, its amplitude, or both independently.
enum class Modulation { phase, amplitude, complex };

/// The names in files.
inline constexpr std::initializer_list<Choice<Modulation>> modulation_names{
    {"phase", Modulation::phase}, {"amplitude", Modulation::amplitude}, {"complex", Modulation::complex}};

/// The phase and amplitude of a panel at one level, at its design wavelength.
struct CalibrationPoint {
  double phase = 0;      ///< phase [rad], not wrapped
  double amplitude = 1;  ///< modulus of the transmittance, in [0, 1]
  bool operator==(const CalibrationPoint&) const = default;
};

/// A term of a wavefront error: the Zernike polynomial Z_n^m in the OSA/ANSI normalization (unit rms over the circle
/// around the panel); m of either sign, n − |m| even.
struct ZernikeTerm {
  int n = 0, m = 0;
  double rms = 0;  ///< coefficient, the rms phase [rad]
  bool operator==(const ZernikeTerm&) const = default;
};

/// A pixel that always shows the same level.
struct DeadPixel {
  int column = 0, row = 0, level = 0;
  bool operator==(const DeadPixel&) const = default;
};

/// Whether light passes a panel's crystal twice, with a mirror behind it (liquid crystal on silicon), or once.
enum class CrystalPass { reflective, transmissive };

/// The names in files.
inline constexpr std::initializer_list<Choice<CrystalPass>> crystal_pass_names{
    {"reflective", CrystalPass::reflective}, {"transmissive", CrystalPass::transmissive}};

/// A wave plate: a retarder whose delay is the same everywhere.
struct WavePlate {
  double axis = 0;   ///< angle of its slow axis [rad]
  double delay = 0;  ///< of light along its slow axis, at the panel's design wavelength [rad]: π/2 a quarter of a wave
  bool operator==(const WavePlate&) const = default;
};

/// The liquid crystal of a panel, and the polarisers and wave plates on the bench. Angles are from x toward y as the
/// viewer sees the panel. slm/panel/crystal.h has the physics.
struct Crystal {
  CrystalPass pass = CrystalPass::reflective;
  double director = 0;  ///< angle of the molecules' long axes, the slow axis, where light enters [rad]
  double twist = 0;     ///< angle by which the director turns through the crystal [rad]; 0: parallel-aligned
  /// Delay of light along the director [rad] at each level, at the design wavelength, over the light's whole way
  /// through the crystal. Empty: the phases of the panel, which are those of its calibration or even steps.
  std::vector<double> delays{};
  std::optional<double> polariser{};       ///< axis of the light that meets the panel [rad]; none: unpolarised light
  std::optional<double> analyser{};        ///< axis of the polariser behind the panel [rad]; none: all light leaves
  std::vector<WavePlate> plates_before{};  ///< between polariser and panel, in the order of the light
  std::vector<WavePlate> plates_behind{};  ///< between panel and analyser, in the order of the light
};

/// The differences between a panel and an ideal one of its pitch, fill factor and levels. An effect is on if its value
/// is not empty or 0; with_effects turns off all but the named ones.
struct SlmEffects {
  std::vector<CalibrationPoint> calibration;  ///< one per level; none: even steps of phase or amplitude
  double crosstalk = 0;                       ///< σ of the Gaussian that blurs the phase [pixels]: fringing fields
  double gap_amplitude = 0, gap_phase = 0;    ///< amplitude and phase of the light from gaps between pixels [1, rad]
  double flicker = 0;                         ///< amplitude of the ripple of the phase in a frame, as a part of it
  std::vector<ZernikeTerm> aberration;        ///< static error of the phase: the panel's curvature
  std::shared_ptr<const Array2D<float>> phase_map;  ///< static error of the phase [rad], a value per pixel
  /// Irradiance of the light on each pixel, relative to that of even light: 0 or more. Empty: even.
  std::shared_ptr<const Array2D<float>> light_map;
  double dead_fraction = 0;            ///< fraction of dead pixels, at random places and levels
  int64_t dead_seed = 1;               ///< seed for those places
  std::vector<DeadPixel> dead_pixels;  ///< known dead pixels
  std::optional<Crystal> crystal{};    ///< the crystal between polarisers; none: levels act on all light alike
};

/// A spatial light modulator.
struct Slm {
  std::string name = "custom";
  Grid grid;
  Modulation modulation = Modulation::phase;
  int levels = 256;  ///< M: phase level ℓ shows range·ℓ/M at the design wavelength, amplitude level ℓ/(M−1)
  double fill_factor = 1;                  ///< F: lit part of a pixel's area, in (0, 1]
  double fill_x = 0, fill_y = 0;           ///< lit part of a pixel's side along x and y, in (0, 1]; both 0: √F
  double design_wavelength = 0;            ///< wavelength where level M would show the range [m]; 0: the one in use
  double phase_range = 6.283185307179586;  ///< phase of level M at the design wavelength [rad]
  SlmEffects effects{};
  std::string
      preset{};  ///< name of the preset, or path of the panel or scene file, that it was read from; "": made in memory
  std::string source{};  ///< citation: where its figures come from, as a text
  /// Effects that its own file or table states, in the place of those of a preset: the ones in use where none are named.
  std::vector<std::string> own_effects{};

  double lit_x() const { return fill_x > 0 ? fill_x : std::sqrt(fill_factor); }
  double lit_y() const { return fill_y > 0 ? fill_y : std::sqrt(fill_factor); }
};

/// The design wavelength of a panel, if it is known, else that of a helium-neon laser [m].
inline double usual_wavelength(const Slm& slm) { return slm.design_wavelength > 0 ? slm.design_wavelength : 632.8e-9; }

/// A calibration at a fractional level ≥ 0: linear interpolation between its points, of which there are at least two.
/// Beyond the last point the phase continues with the last slope, and the amplitude is constant.
CalibrationPoint calibration_at(const std::vector<CalibrationPoint>& points, double level);

/// The names of the effects: calibration, crosstalk, gaps, flicker, aberration, phase-map, light-map, dead-pixels, crystal.
std::vector<std::string> slm_effect_names();

/// The panel with only the named effects on; "all": all of them.
/// @throws Error for an unknown name, suggesting the nearest.
Slm with_effects(const Slm& slm, const std::vector<std::string>& names);

/// The panel with the named effects on; if none are named, with its own.
/// @throws Error  as with_effects does
Slm with_effects_or_own(const Slm& slm, const std::vector<std::string>& names);

/// The names of the effects of a panel that are on.
std::vector<std::string> effects_of(const Slm& slm);

/// @throws Error unless the grid is valid, levels are 2 … 65536, fill factors are in (0, 1], and the values of every
///         effect are in range: a calibration with a point per level and a phase that never falls, amplitudes in
///         [0, 1], a phase map and a light map with a value per pixel, dead pixels on the panel, a crystal with finite
///         angles and a delay per level, on a panel whose levels are not complex.
void check_slm(const Slm& slm);

}  // namespace holotrace
