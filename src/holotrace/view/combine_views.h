#pragma once

#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// What a camera sees of holograms that are shown one after the other: the mean over frames, the sum over path groups and
/// lights that do not interfere, one picture per wavelength, and from these a picture in colour. With Eₕ the
/// illumination of hologram h, vₕ its view under the light of the brightest, rₙ the reach of wavelength n
/// (axial_reach, camera.h) and Mₙ of colour_matrix (data/spectrum.h),
///
///     Iₙ = Σ_names mean_frames (Eₕ/max E)·vₕ,    rgb = Σₙ Mₙ·Iₙ·(max r/rₙ)     (one wavelength: I itself, one channel)
///
/// So the brightest hologram is lit fully and every other one in proportion: colours, path groups and lights keep their
/// ratios. The last factor is the camera's white balance, taken on the axis where it looks: a panel accepts a cone that
/// grows with the wavelength, so of a near white it would see more red. Colours that keep to
/// no common cone (TraceParams::has_common_cone) are off balance away from the axis: long waves reach farther.
class CombinedViews {
 public:
  /// @param wavelengths  of the light that all holograms together would show [m]; one of which no hologram comes is
  ///                     dark. None: those that come
  explicit CombinedViews(std::vector<double> wavelengths = {}) : wavelengths_(std::move(wavelengths)) {}

  /// Adds the view of a hologram. Holograms of one wavelength [m] and name are frames of each other.
  /// @param illumination  Hologram::illumination [W/m²] ≥ 0
  /// @param view          one channel [W/m²], taken with the light of the brightest
  /// @param reach         of this wavelength, above 0, on a scale that all wavelengths share
  /// @throws Error        for another size than that of the views before, an illumination below 0 or a reach of 0
  void add(double wavelength, const std::string& name, double illumination, const Image& view, double reach = 1);

  /// The picture: one channel for one wavelength, else red, green and blue, which may be negative where the
  /// wavelengths' speckle differs. [W/m²]. @throws Error before any view
  Image image() const;

  /// Mean irradiance over the sensor, of all wavelengths together [W/m²].
  double mean_irradiance() const;

  /// Light on the panel over that of the brightest hologram: Σ mean_frames Eₕ/max E.
  double relative_illumination() const;

  /// Wavelengths [m], in the order in which they came where none were given.
  std::vector<double> wavelengths() const;

 private:
  struct Group {
    double wavelength = 0, reach = 1;
    std::string name;
    int frames = 0;
    double illumination = 0;    // Σ E
    std::vector<double> light;  // Σ E·v
  };

  double brightest() const { return brightest_ > 0 ? brightest_ : 1; }
  Image irradiance(double wavelength) const;

  std::vector<double> wavelengths_;
  std::vector<Group> groups_;
  double brightest_ = 0, pitch_ = 0, centre_x_ = 0, centre_y_ = 0;
  int nx_ = 0, ny_ = 0;
};

/// A picture in red, green and blue as light of those wavelengths shows it: radiance_at for one wavelength, else
/// M·W·rgb (colour_matrix), which is the picture itself where the wavelengths tell all colours. A picture of one
/// channel is that of grey things: it is kept for one wavelength, and turned to three channels for more.
Image seen_at(const Image& rgb, const std::vector<double>& wavelengths);

}  // namespace holotrace
