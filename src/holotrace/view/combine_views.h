#pragma once

#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/image.h"
#include "holotrace/data/report.h"

namespace holotrace {

/// What a camera sees of holograms that are shown one after the other: the mean over frames, and the sum over path
/// groups and lights, which do not interfere. There is one picture per wavelength, combined to a colour picture. Eₕ is
/// the illumination of hologram h, vₕ its view in the light of the brightest hologram, rₙ the reach of wavelength n
/// (axial_reach, camera.h) and Mₙ a column of colour_matrix (data/spectrum.h):
///
///     Iₙ = Σ_names ⟨(Eₕ/max E)·vₕ⟩,    rgb = Σₙ Mₙ·Iₙ·(max r/rₙ)     (one wavelength: I itself, one channel)
///
/// with ⟨·⟩ the mean over the frames of a name.
/// The brightest hologram is lit fully and every other one in proportion: colours, path groups and lights keep their
/// ratios. The last factor is the camera's white balance, for the axis on which it looks: a panel accepts a cone that
/// grows with the wavelength, so without it near white objects would look too red. Colours without
/// a common cone (TraceParams::has_common_cone) are not balanced off the axis: long waves reach farther.
class CombinedViews {
 public:
  /// @param wavelengths  wavelengths of the light that all holograms together would show [m]; one without a hologram is
  ///                     dark. Empty: those of the holograms
  explicit CombinedViews(std::vector<double> wavelengths = {}) : wavelengths_(std::move(wavelengths)) {}

  /// Adds the view of a hologram. Holograms of one wavelength [m] and name are frames of each other.
  /// @param illumination  Hologram::illumination [W/m²] ≥ 0
  /// @param view          one channel [W/m²], taken with the light of the brightest hologram
  /// @param reach         reach of this wavelength, above 0, in a unit that all wavelengths share
  /// @throws Error        for a size that differs from earlier views, an illumination below 0 or a reach of 0
  void add(double wavelength, const std::string& name, double illumination, const Image& view, double reach = 1);

  /// The picture [W/m²]: one channel for one wavelength, otherwise red, green and blue. These may be negative where the
  /// speckle of the wavelengths differs. @throws Error before any view
  Image image() const;

  /// Mean irradiance over the sensor, added up over all wavelengths [W/m²].
  double mean_irradiance() const;

  /// Light on the panel relative to that of the brightest hologram: Σ ⟨Eₕ⟩/max E.
  double relative_illumination() const;

  /// Wavelengths [m]: those given to the constructor, or those of the holograms in their order.
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

/// A picture in red, green and blue as it looks in light of the given wavelengths: radiance_at for one wavelength,
/// otherwise M·W·rgb (colour_matrix), the same picture if the wavelengths can show all colours. A picture of one
/// channel counts as grey: it stays as it is for one wavelength, and becomes three channels for more.
Image seen_at(const Image& rgb, const std::vector<double>& wavelengths);

/// A picture of CombinedViews, or one in the scene's colours, as the CIE 1931 standard observer sees it in light of the given
/// wavelengths: three channels of linear sRGB, Σₙ Cₙ·Iₙ with the columns Cₙ of cie_colour_matrix (data/cie.h) and Iₙ the light at
/// each wavelength, got back by W·rgb. Up to three wavelengths with different colours it is exact. Colours outside of sRGB are
/// mixed with white (within_gamut).
Image in_cie_colours(const Image& image, const std::vector<double>& wavelengths);

/// The pixels of a view, without light, in the plane in focus. Their centre is counted from that of the render.
Image sensor_at(const ViewPlace& place, int rows, int columns);

/// A render as a view of rows × columns pixels should show it: in the colours of the view's light (seen_at), each pixel
/// the mean over its area (project_render).
/// @param render  radiance of 1 or 3 channels
/// @return        one channel for one wavelength, otherwise three
Image render_at(const Image& render, const ViewPlace& place, int rows, int columns);

/// A picture that shows the same window as another, on its pixels: each the mean over its area.
/// @throws Error  unless the ratios of width to height agree to half a pixel
Image on_pixels_of(const Image& picture, const Image& other);

/// A colour picture as grey, by its luminance 0.2126·R + 0.7152·G + 0.0722·B (ITU-R BT.709, linear light). A grey picture
/// is not changed.
Image luminance_of(const Image& image);

}  // namespace holotrace
