#pragma once

#include <optional>

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/panel/panel_model.h"

namespace holotrace {

/// A panel at one wavelength, for gradient descent: levels give light of one sample per pixel, and gradients go back.
///
/// A phase panel without effects is exp(2πi·c·ℓ) pixel by pixel; the pixels' aperture is then part of the propagation.
/// Every other panel uses the PanelModel.
class DrivenPanel {
 public:
  /// @param slm       panel with the effects that are on
  /// @param hologram  its levels, modulation and wavelength are used
  DrivenPanel(const Slm& slm, const Hologram& hologram, double wavelength);

  /// Whether the propagation must include the pixels' aperture.
  PixelAperture aperture() const { return model_ ? PixelAperture::left_out : PixelAperture::included; }

  /// Levels in a whole turn of phase; 0 if the levels do not cover a turn.
  double turn() const { return turn_; }

  /// Mean number of levels per radian of phase.
  double levels_per_radian() const { return levels_per_radian_; }

  /// Writes the light that leaves the panel to `u`.
  void leave(const Array2D<float>& drive, Field& u) const;

  /// Adds factor·∂f/∂drive to `slope`, given g = ∂f/∂Re u + i·∂f/∂Im u.
  void add_slope(const Array2D<float>& drive, const Field& u, const Field& g, double factor,
                 Array2D<float>& slope) const;

 private:
  double cycles_per_level_, turn_, levels_per_radian_;
  std::optional<PanelModel> model_;
};

}  // namespace holotrace
