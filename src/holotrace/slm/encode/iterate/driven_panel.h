#pragma once

#include <optional>

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/panel/panel_model.h"

namespace holotrace {

/// A panel at one wavelength as descent sees it: light of one sample per pixel for levels, and the gradient back.
///
/// A phase panel without effects is exp(2πi·c·ℓ) pixel by pixel, the pixels' aperture being a part of the propagation:
/// all else goes through the PanelModel.
class DrivenPanel {
 public:
  /// @param slm       with the effects that are on
  /// @param hologram  its levels, modulation and wavelength
  DrivenPanel(const Slm& slm, const Hologram& hologram, double wavelength);

  /// Whether the propagation has to take the pixels' aperture into account.
  PixelAperture aperture() const { return model_ ? PixelAperture::left_out : PixelAperture::included; }

  /// Levels in a whole turn of the phase, 0 where they do not reach so far.
  double turn() const { return turn_; }

  /// On the whole.
  double levels_per_radian() const { return levels_per_radian_; }

  /// The light that leaves it, in `u`.
  void leave(const Array2D<float>& drive, Field& u) const;

  /// Adds factor·∂f/∂drive to `slope`, from g = ∂f/∂Re u + i·∂f/∂Im u.
  void add_slope(const Array2D<float>& drive, const Field& u, const Field& g, double factor,
                 Array2D<float>& slope) const;

 private:
  double cycles_per_level_, turn_, levels_per_radian_;
  std::optional<PanelModel> model_;
};

}  // namespace holotrace
