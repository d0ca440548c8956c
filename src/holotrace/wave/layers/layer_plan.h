#pragma once

#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/wave/layers/layer_spectrum.h"

namespace holotrace {

/// The angles of a slice's light that are kept along one axis, as offsets on the way to the panel
/// [m]: all up to `pass`, none from `end` on, with a smooth fall. An infinite `end` keeps the raster's whole band.
struct Taper {
  double pass = 0, end = 0;
};

/// Steepness α of tapers for a tolerance. They fall as ½·erfc(α·(2t − 1)), t from 0 at `pass` to 1 at `end`.
/// Diffraction reduces exp(−α²) to exp(−0.8α²) (below), so α = √(1.25·ln(2/tolerance)).
double taper_steepness(double tolerance);

/// What the taper of a slice depends on, along one axis.
struct SliceLight {
  double depth = 0, wavelength = 0,
         pitch = 0;         ///< distance from the panel on either side, and its pitch [m]
  double span = 0;          ///< largest offset of its light to a pixel of the panel [m]
  double radius = 0;        ///< half side of what a point's light covers on the panel [m], at most box_radius
  double steepness = 0;     ///< taper_steepness
  bool is_carried = false;  ///< carried from slice to slice
};

/// The taper of a slice of points at `depth` with the largest offset `span` to a pixel of the panel.
///
/// A sharp cut of the spectrum rings over √(λd) and more on the panel. A Gaussian edge of standard deviation
/// 0.56·√(λd) does not, because it is √2 wider than diffraction's own. Angles are kept up to the span and fall beyond,
/// if necessary past the panel's Nyquist angle (by up to a quarter; none of that light reaches the panel). If the
/// span itself is beyond the Nyquist angle, waves end at their box (Eq. 14) on the panel. The fall, 0.5·√(λd) wide,
/// then ends at that angle, because light beyond it would appear as replicas.
///
/// Light that is carried from slice to slice (`is_carried`) keeps all angles up to a fall that ends at the Nyquist
/// angle: what a slice lets through depends on more light than the part that reaches the panel undisturbed.
/// Waves whose boxes are smaller than their own acceptance (`radius`) end at their boxes in the same way.
Taper taper_of_points(const SliceLight& slice);

/// The taper of a slice given as a raster: its whole band or, if that would need a large window, the
/// angles that reach the panel. Light that is carried keeps its band, except for a fall that ends at the Nyquist angle.
/// Light that keeps to a narrower cone (`radius`) falls about the cone's border, over 0.5·√(λd): as much power is kept
/// beyond the border as is lost before it.
Taper taper_of_raster(const SliceLight& slice);

/// A slice, as needed to plan the window.
struct PlannedSlice {
  double depth = 0;  ///< behind the panel, below 0 in front of it [m]
  /// Largest offset between its light and a pixel or, if slices hide, also the slices on its way [m].
  double span_x = 0, span_y = 0;
  Taper x, y;
};

/// The window in samples of the panel's pitch, and the band of its spectrum.
struct LayerWindow {
  int nx = 0, ny = 0, reach_x = 0, reach_y = 0;
};

/// The smallest window whose repetitions light no pixel: span + reach of the light of each slice, and at least the
/// panel.
LayerWindow plan_window(const std::vector<PlannedSlice>& slices, const Grid& panel, double wavelength);

/// The taper at the frequencies 0, 1/side, … [1/m], `side` that of the window [m]; at most `most` frequencies.
AxisWeights taper_weights(const Taper& taper, double depth, double wavelength, double side, double steepness, int most);

}  // namespace holotrace
