#pragma once

#include <complex>

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/moments.h"

namespace holotrace {

/// A panel under the light of one moment, made ready for any number of patterns: from what its pixels are driven with
/// to the field that leaves it, and back for gradients. `show` and the encoder `sgd` both stand on it.
///
/// A pattern is a **drive**: a value in levels per pixel, 0 ≤ ℓ ≤ M, whole ones those of a hologram, fractional ones
/// between them as far as the calibration is linear there. What is shown is a function of the drive alone:
///
///     drive → phase φ(ℓ), amplitude a(ℓ) → static errors, flicker → blur of the phase (crosstalk)
///           → a·exp(iφ) on lit areas, the gaps' light between → times the illumination → cut to the band n/2p
class PanelModel {
 public:
  /// @param slm         the panel, with the effects that are on (with_effects)
  /// @param modulation  of the hologram: phase or amplitude
  /// @param levels      M of the hologram
  /// @param design_wavelength  at which level M shows the phase range [m]
  /// @throws Error      as show does
  PanelModel(const Slm& slm, const ShowParams& params, Modulation modulation, int levels, double design_wavelength,
             const Moment& moment);

  /// The field that leaves the panel: at z = 0, shape (n·ny, n·nx), n = params.subpixels.
  /// @param drive  shape (ny, nx), finite
  Field leave(const Array2D<float>& drive) const;

  /// The gradient ∂f/∂drive of a real function f of the field u that leaves, from g = ∂f/∂Re u + i·∂f/∂Im u:
  ///
  ///     ∂f/∂ℓ = Re Σ conj(g)·∂u/∂ℓ
  ///
  /// @param drive     at which u was taken
  /// @param gradient  g, shape (n·ny, n·nx)
  /// @return          shape (ny, nx)
  Array2D<float> pull_back(const Array2D<float>& drive, const Array2D<std::complex<float>>& gradient) const;
};

}  // namespace holotrace
