#pragma once

#include <complex>
#include <memory>

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/panel/illumination_states.h"

namespace holotrace {

/// A panel under the light of one illumination state, made ready for any number of patterns: from what its pixels are driven with
/// to the field that leaves it, and back for gradients. `show` and the encoder `sgd` both stand on it.
///
/// A pattern is a **drive**: a value in levels per pixel, 0 ≤ ℓ ≤ M, whole ones those of a hologram, fractional ones
/// between them as far as the calibration is linear there. What is shown is a function of the drive alone:
///
///     drive, dead pixels aside → phase φ(ℓ), amplitude a(ℓ), flicker                    pixel_response.h
///           → blur of both (crosstalk) → a·exp(iφ)                                        crosstalk.h
///           → on lit areas, the gaps' light γ between → static errors exp(iψ)             static_errors.h
///           → cut to the band n/2p                                                        pixel_line.h
///           → times the illumination √E·e(x, y)                                           illumination.h
///
/// The panel's spectrum, which repeats at every 1/p, meets the aperture's exactly. The light comes last, sample by
/// sample: tilted light by u₀ moves all that by u₀, and what it moves past ±n/2p comes in on the other side, where the
/// panel's spectrum is the same, but for the aperture's roll-off there.
///
/// The methods may be called from several threads at a time. A model keeps the memory of its largest steps from call to
/// call.
class PanelModel {
 public:
  /// @param slm         the panel, with the effects that are on (with_effects)
  /// @param params      subpixels n, fine_samples, irradiance E and shape of the light; wavelength, tilts and the
  ///                    coherence are the state's
  /// @param modulation  of the hologram
  /// @param levels      M of the hologram
  /// @param design_wavelength  λ₀ at which level M shows the phase range [m]; 0: the state's wavelength
  /// @throws Error      as show does
  PanelModel(const Slm& slm, const ShowParams& params, Modulation modulation, int levels, double design_wavelength,
             const IlluminationState& state);

  /// The field that leaves the panel: at z = 0, shape (n·ny, n·nx), n = params.subpixels.
  /// @param drive    shape (ny, nx), finite
  /// @param modulus  amplitudes in levels, same shape, where the modulation is complex: a = modulus/(M−1)
  Field leave(const Array2D<float>& drive, const Array2D<float>* modulus = nullptr) const;

  /// The same into `field`, whose memory is used again.
  void leave(const Array2D<float>& drive, Field& field, const Array2D<float>* modulus = nullptr) const;

  /// The gradient ∂f/∂drive of a real function f of the field u that leaves, from g = ∂f/∂Re u + i·∂f/∂Im u:
  ///
  ///     ∂f/∂ℓ = Re Σ conj(g)·∂u/∂ℓ
  ///
  /// At whole levels of a calibration it is that toward the level above; of dead pixels it is 0.
  ///
  /// @param drive     at which u was taken
  /// @param gradient  g, shape (n·ny, n·nx)
  /// @return          shape (ny, nx)
  Array2D<float> pull_back(const Array2D<float>& drive, const Array2D<std::complex<float>>& gradient) const;

  /// Power of the light on the panel [W].
  double power_in() const;

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

}  // namespace holotrace
