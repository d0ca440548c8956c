#pragma once

#include <complex>
#include <vector>

#include "holotrace/calibrate/unknowns.h"
#include "holotrace/data/field.h"
#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

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
