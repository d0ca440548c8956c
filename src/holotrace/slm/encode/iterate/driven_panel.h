#pragma once

#include <optional>

#include "holotrace/base/array.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/slm/panel/pixel_expansion.h"
#include "holotrace/slm/panel/pixel_response.h"

namespace holotrace {

/// What drives the pixels of a panel: levels, not rounded, shape (ny, nx).
struct Drive {
  Array2D<float> level;    ///< levels of phase, or of amplitude
  Array2D<float> modulus;  ///< levels of amplitude, if the modulation is complex; otherwise empty

  /// A drive like another one, of zeros.
  static Drive like(const Drive& other) {
    return {Array2D<float>(other.level.ny, other.level.nx), Array2D<float>(other.modulus.ny, other.modulus.nx)};
  }
};

/// Calls work for each array of values that a drive has.
template <class Work>
void each_array(Drive& drive, const Work& work) {
  work(drive.level);
  if (drive.modulus.size() > 0) work(drive.modulus);
}

/// How an update takes a panel. With crosstalk, light and slopes may be approximate.
struct PanelDetail {
  bool is_hard = true;  ///< whether drives are whole levels: between them, two levels have their own slopes
  PixelDetail light = PixelDetail::as_shown;
  PixelDetail slopes = PixelDetail::as_shown;  ///< exact if it is the same as that of the light
};

/// A panel at one wavelength, for gradient descent: levels give light, and gradients go back.
///
/// A phase panel without effects is exp(2πi·c·ℓ) pixel by pixel, one sample per pixel; the pixels' aperture is then part
/// of the propagation. Every other panel, and light of several samples per pixel, uses the PanelModel.
class DrivenPanel {
 public:
  /// @param slm       panel with the effects that are on
  /// @param hologram  its levels, modulation and wavelength are used
  /// @param subpixels  samples of the light per pixel and axis; odd numbers hold whole diffraction orders
  DrivenPanel(const Slm& slm, const Hologram& hologram, double wavelength, int subpixels = 1);

  /// Whether the propagation must include the pixels' aperture.
  PixelAperture aperture() const { return model_ ? PixelAperture::left_out : PixelAperture::included; }

  /// Levels of 2π of phase; 0 if the levels do not cover that, or are only two.
  double levels_per_cycle() const { return levels_per_cycle_; }

  /// Mean number of levels that change the light by its own modulus: per radian of phase, or for an amplitude panel from
  /// dark to bright, as for the modulus of a complex modulation.
  double levels_per_radian() const { return levels_per_radian_; }

  /// Cycles of phase per level of a phase panel without effects.
  double cycles_per_level() const { return cycles_per_level_; }

  /// The model of a panel with effects, of several samples per pixel, or that modulates more than the phase; otherwise none.
  const PanelModel* model(PixelDetail detail) const;

  /// Whether slopes are those halfway between two levels (add_slope).
  bool takes_middle(const PanelDetail& detail) const { return has_two_levels_ && detail.is_hard; }

  /// Only then details of the light over a pixel differ.
  bool has_crosstalk() const { return coarse_.has_value(); }

  /// Writes the light that leaves the panel to `u`.
  void leave(const Drive& drive, Field& u, const PanelDetail& detail = {}) const;

  /// Adds factor·∂f/∂drive to `slope`, given g = ∂f/∂Re u + i·∂f/∂Im u, as if the panel's light had the detail of the slopes.
  ///
  /// Of two levels the slope is that halfway between them, where the phase moves the light from one level's toward the
  /// other's; at a level itself, it moves it across that direction and says nothing about the other level.
  void add_slope(const Drive& drive, const Field& u, const Field& g, double factor, Drive& slope,
                 const PanelDetail& detail = {}) const;

 private:
  void set_steps_of_crystal(const PixelResponse& response, int levels);

  double cycles_per_level_, levels_per_cycle_, levels_per_radian_;
  bool has_two_levels_;
  std::optional<PanelModel> model_, coarse_, mean_;  // for each PixelDetail; the last two only with crosstalk
};

}  // namespace holotrace
