#pragma once

#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/wave/layers/layer_spectrum.h"

namespace holotrace {

/// Which angles of a slice's light are kept along one axis, as the offsets that they bridge on the way to the panel
/// [m]: all up to `pass`, none from `end` on, smoothly between. An infinite `end` keeps the raster's whole band.
struct Taper {
  double pass = 0, end = 0;
};

/// How steep tapers are at a tolerance: they fall as ½·erfc(α·(2t − 1)), t from 0 at `pass` to 1 at `end`. Diffraction
/// makes exp(−0.8α²) of their exp(−α²) (below), so that α = √(1.25·ln(2/tolerance)).
double taper_steepness(double tolerance);

/// The taper of a slice of points at `depth`, whose largest offset to a pixel of the panel is `span`.
///
/// A sharp cut of the spectrum rings over √(λd) on the panel and further; a Gaussian edge of standard deviation
/// 0.56·√(λd) does not, as it is √2 wider than diffraction's own. So angles are kept up to the span and fall beyond it,
/// past the panel's Nyquist angle where need be (by up to a quarter; none of that light meets the panel). Where the
/// span itself is beyond the Nyquist angle, waves end at their box (Eq. 14) on the panel: the fall, 0.5·√(λd) wide,
/// then ends at that angle, as light beyond it would show as replicas.
///
/// Light that is carried from slice to slice (`is_carried`) keeps all angles up to a fall that ends at the Nyquist
/// angle: what a slice lets through depends on more of the light than what reaches the panel undisturbed.
/// Waves whose boxes are smaller than their own acceptance (`radius`) end at their boxes in the same way.
///
/// @param radius  half-side of the boxes [m], at most box_radius
Taper taper_of_points(double span, double depth, double wavelength, double pitch, double radius, double steepness,
                      bool is_carried);

/// The taper of a slice that is a raster: its whole band, or where the window would have to be large for that, the
/// angles that reach the panel. Light that is carried keeps its band, but for a fall that ends at the Nyquist angle.
/// Light that keeps to a narrower cone (`radius`) falls about the cone's border, 0.5·√(λd) wide: as much power is kept
/// beyond the border as is lost before it.
///
/// @param radius  half-side of what a point's light covers on the panel [m], at most box_radius
Taper taper_of_raster(double span, double depth, double wavelength, double pitch, double radius, double steepness,
                      bool is_carried);

/// A slice as the window sees it.
struct PlannedSlice {
  double depth = 0;
  /// Largest offset between its light and a pixel, or where slices hide also what lies on its way [m].
  double span_x = 0, span_y = 0;
  Taper x, y;
};

/// The window: its samples of the panel's pitch, and the band of its spectrum.
struct LayerWindow {
  int nx = 0, ny = 0, reach_x = 0, reach_y = 0;
};

/// The smallest window whose repetitions light no pixel: span + reach of the light of each slice, no smaller than the
/// panel.
LayerWindow plan_window(const std::vector<PlannedSlice>& slices, const Grid& panel, double wavelength);

/// The taper at frequencies 0, 1/side, … [1/m], `side` the window's [m]; `most` frequencies at most.
AxisWeights taper_weights(const Taper& taper, double depth, double wavelength, double side, double steepness, int most);

}  // namespace holotrace
