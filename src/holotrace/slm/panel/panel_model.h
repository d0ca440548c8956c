#pragma once

#include <complex>
#include <memory>

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/rates.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/panel/illumination.h"

namespace holotrace {

struct PixelExpansion;

/// A panel under one illumination state, prepared for any number of patterns. It computes the field that leaves the
/// panel from the drive of its pixels, and gradients back. Both `show` and the encoder `sgd` use it.
///
/// Its input is the **drive**: a number for each pixel in units of levels, 0 ≤ ℓ ≤ M, not rounded. Whole numbers are the levels
/// of a hologram; between them the calibration is taken as linear. The light is a function of the drive alone:
///
///     drive, except of dead pixels → phase φ(ℓ), amplitude a(ℓ), flicker                pixel_response.h
///           → blur of both (crosstalk) → a·exp(iφ)                       crosstalk.h, pixel_expansion.h
///           → light on lit areas, γ in the gaps between them → static errors √m·exp(iψ)   static_errors.h
///           → band limited to n/2p                                                        pixel_expansion.h
///           → times the illumination √E·e(x, y)                                           illumination.h
///
/// The panel's spectrum, which repeats at every 1/p, is multiplied by the exact spectrum of the aperture. The
/// illumination is applied last, sample by sample. Light tilted by u₀ shifts the spectrum by u₀; what it shifts past
/// ±n/2p wraps around, where the panel's spectrum is the same except for the roll-off of the aperture.
///
/// The methods may be called from several threads at once. A model keeps the memory of its largest steps between
/// calls.
class PanelModel {
 public:
  /// @param slm         the panel, with the effects that are on (with_effects)
  /// @param params      subpixels n, fine_samples, irradiance E and shape of the light; wavelength, tilts and
  ///                    coherence come from the state
  /// @param modulation  modulation of the hologram
  /// @param levels      levels M of the hologram
  /// @param design_wavelength  λ₀, at which level M shows the phase range [m]; 0: the state's wavelength
  /// @throws Error      as show does
  PanelModel(const Slm& slm, const ShowParams& params, Modulation modulation, int levels, double design_wavelength,
             const IlluminationState& state);

  /// The same with another expansion of the light over a pixel.
  PanelModel(const Slm& slm, const ShowParams& params, Modulation modulation, int levels, double design_wavelength,
             const IlluminationState& state, const PixelExpansion& expansion);

  /// The field that leaves the panel: at z = 0, shape (n·ny, n·nx), n = params.subpixels.
  /// @param drive    shape (ny, nx), finite
  /// @param modulus  amplitudes in levels, same shape, for a complex modulation: a = modulus/(M−1)
  Field leave(const Array2D<float>& drive, const Array2D<float>* modulus = nullptr) const;

  /// The same into `field`, whose memory is reused.
  void leave(const Array2D<float>& drive, Field& field, const Array2D<float>* modulus = nullptr) const;

  /// What drives the pixels: shape (ny, nx).
  struct Pattern {
    const Array2D<float>& drive;
    const Array2D<float>* modulus = nullptr;  ///< amplitudes in levels, for a complex modulation
  };

  /// Gradients by the drive and, for a complex modulation, by the modulus; shape (ny, nx).
  struct Slopes {
    Array2D<float>& drive;
    Array2D<float>* modulus = nullptr;
  };

  /// Adds factor times the gradient ∂f/∂drive of a real function f of the field u that leaves, given
  /// g = ∂f/∂Re u + i·∂f/∂Im u:
  ///
  ///     ∂f/∂ℓ = Re Σ conj(g)·∂u/∂ℓ
  ///
  /// At whole levels of a calibration it is the slope toward the level above; for dead pixels it is 0.
  ///
  /// @param pattern   at which u was computed
  /// @param gradient  g, shape (n·ny, n·nx)
  void add_slopes(const Pattern& pattern, const Array2D<std::complex<float>>& gradient, double factor,
                  const Slopes& to) const;

  /// @throws Error  for a pattern that `leave` does not take
  void check_pattern(const Array2D<float>& drive, const Array2D<float>* modulus) const;

  /// All of the field that leaves but its samples.
  Field head() const;

  /// Power of the light on the panel [W].
  double power_in() const;

  /// What the processor does to `leave`, for the choice of a device.
  SummationWork work() const;

 private:
  friend class DevicePanel;
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

}  // namespace holotrace
