#pragma once

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/plane_optics.h"

namespace holotrace {

/// A panel at one wavelength as descent sees it: light of one sample per pixel for levels, and the gradient back.
///
/// A phase panel without effects is exp(2πi·c·ℓ) pixel by pixel, the pixels' aperture being a part of the propagation.
class DrivenPanel {
 public:
  DrivenPanel(const Slm& slm, const Hologram& hologram, double wavelength);

  /// Whether the propagation has to take the pixels' aperture into account.
  PixelAperture aperture() const;

  /// Levels in a whole turn of the phase, 0 where they do not reach so far.
  double turn() const { return cycles_per_level_ > 0 ? 1 / cycles_per_level_ : 0; }

  /// The light that leaves it, in `u`.
  void leave(const Array2D<float>& drive, Field& u) const;

  /// Adds ∂f/∂drive to `slope`, from g = ∂f/∂Re u + i·∂f/∂Im u.
  void add_slope(const Array2D<float>& drive, const Field& u, const Field& g, double factor,
                 Array2D<float>& slope) const;

 private:
  double cycles_per_level_ = 0;
};

}  // namespace holotrace
