#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/calibration.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/calibrate.h"
#include "holotrace/data/slm.h"
#include "holotrace/view/register/channel.h"
#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// Brightness of a photograph: value = gain·irradiance + offset.
struct PhotoExposure {
  double gain = 1, offset = 0;
};

/// What a calibration looks for.
struct Unknowns {
  /// Blur by the camera beyond the area of its pixels: variance per axis [samples of the window²]. It also takes up what
  /// the interpolation between samples loses, and may be below 0.
  double blur = 0;
  Similarity camera;               ///< from places in a photograph to places in the window of the simulation [samples]
  std::vector<double> light;       ///< coefficients of ln(irradiance), one per LightTerm
  std::vector<double> aberration;  ///< rms of each Zernike term [rad]
  std::vector<double> phases;      ///< of the measured levels [rad]; the first is 0 by definition
  std::vector<double> amplitude;   ///< coefficients of ln(amplitude of a level): Legendre polynomials from degree 1 on
  double crosstalk = 0;            ///< [pixels]
  std::complex<double> gap;        ///< light of the gaps in order 0, relative to that of lit pixels: γ·(1 − F)/F
  std::vector<PhotoExposure> exposures;
};

/// The groups of unknowns that a fit may change. Gains and offsets of the photographs always change.
enum class UnknownKind { camera, blur, light, aberration, phase, amplitude, crosstalk, gap, exposure };

/// One unknown: a member of Unknowns by kind and index.
struct Unknown {
  UnknownKind kind;
  size_t index;
};

/// A product of Legendre polynomials of x and y, which are −1 … 1 over the panel.
struct LightTerm {
  int x = 0, y = 0;
};

/// The panel that is calibrated, and the functions in which its unknowns are expanded.
struct UnknownsBasis {
  Slm slm;                  ///< as it is assumed to be, without effects
  double wavelength = 0;    ///< [m]
  std::vector<int> levels;  ///< measured levels, ascending, the first 0
  std::vector<LightTerm> light;
  std::vector<ZernikeTerm> aberration;
  int amplitude_order = 0;
};

/// The basis for the patterns: every level that occurs in them, all terms up to the orders of the parameters. Piston and
/// tilt of the wavefront are left out: photographs do not show the one, and cannot tell the other from the camera's place.
UnknownsBasis make_basis(const std::vector<TestPattern>& patterns, const CalibrateParams& params);

/// An even panel of the assumed phases.
Unknowns first_guess(const UnknownsBasis& basis, const Slm& assumed, size_t photographs);

double& value_of(Unknowns& unknowns, const Unknown& unknown);

/// Amplitude of a level relative to level 0.
double amplitude_of(const UnknownsBasis& basis, const Unknowns& unknowns, double level);

/// ∂ ln(amplitude of a level)/∂ coefficient k.
double amplitude_term(const UnknownsBasis& basis, size_t k, double level);

/// The values of a light term or a Zernike term at each pixel of the panel.
Array2D<float> light_term_on(const Grid& grid, const LightTerm& term);
Array2D<float> zernike_on(const Grid& grid, const ZernikeTerm& term);

/// Fill factor and gap amplitude that send the light `gap` to order 0: the assumed fill factor, or the next smaller one
/// for which the amplitude is 1.
struct GapFigures {
  double fill_factor = 1, amplitude = 0, phase = 0;
};
GapFigures gap_figures(double assumed_fill, std::complex<double> gap);

/// The simulated bench: a panel with the unknowns, and the plane of the sensor. The model is that of PanelModel in
/// order 0, with two differences that do not matter for smooth functions: wavefront and light are multiplied after the
/// pixels' aperture, not before.
class CalibrationBench {
 public:
  CalibrationBench(UnknownsBasis basis, double distance);

  const UnknownsBasis& basis() const { return basis_; }
  const Grid& window() const { return propagator_.output; }  ///< samples in the plane of the sensor

  /// Light of even amplitude and phase that leaves the panel with a pattern.
  Field leave(const Hologram& pattern, const Unknowns& unknowns) const;

  /// The factor of light and wavefront: √irradiance·exp(iψ), per pixel.
  Array2D<std::complex<float>> smooth_factor(const Unknowns& unknowns) const;

  /// Field in the window of light `left` times `factor`.
  Field at_sensor(const Field& left, const Array2D<std::complex<float>>& factor) const;

  /// Irradiance in the window, with the camera's blur.
  Channel irradiance(const Hologram& pattern, const Unknowns& unknowns) const;

  /// Changes of the irradiance in the window per unit of each unknown that changes the light; an empty Channel for an
  /// unknown that has no effect on this pattern.
  struct Response {
    Channel irradiance;
    std::vector<Channel> slopes;
  };
  Response respond(const Hologram& pattern, const Unknowns& unknowns, const std::vector<Unknown>& of) const;

 private:
  Field slope_of(const Hologram& pattern, const Unknowns& unknowns, const Unknown& of, const Field& left) const;

  UnknownsBasis basis_;
  Propagator<float> propagator_;
  std::vector<Array2D<float>> light_, aberration_;  // the terms, per pixel
};

}  // namespace holotrace
