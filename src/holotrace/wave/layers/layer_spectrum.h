#pragma once

#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"

namespace holotrace {

/// Spectrum of the light on a plane parallel to the panel. One spectrum serves all slices of depth: each slice adds its
/// light, the spectrum is carried from plane to plane, and it is transformed to samples once, at the end.
///
///     U(x, y) = Σ c(k, l)·exp(2πi(k·X/nx + l·Y/ny)),   X, Y in samples from pixel (0, 0), |k| ≤ K, |l| ≤ L
///
/// The window repeats after nx × ny samples of the panel's pitch. K may exceed nx/2: such frequencies fold onto others
/// when samples are made, as on a panel. Free space over d multiplies c by exp(−2πi·d·lag); the axial phase 2πd/λ is
/// left out here. Instead every slice adds its light with the axial phase of its whole distance to the panel.
struct LayerSpectrum {
  Grid panel;
  double wavelength = 0;                ///< [m]
  int nx = 0, ny = 0;                   ///< samples after which the window repeats
  int reach_x = 0, reach_y = 0;         ///< K and L
  Array2D<std::complex<float>> values;  ///< c at [k + K][l + L]
  Array2D<double> lag;                  ///< 1/λ − √(λ⁻² − u² − v²) at [|k|][|l|] [1/m]
  Array2D<float> inverse_cosine;        ///< 1/√(1 − λ²(u² + v²)); 0 where waves are evanescent
  double u(int k) const { return k / (nx * panel.pitch); }  ///< [1/m]
  double v(int l) const { return l / (ny * panel.pitch); }
};

/// A spectrum without light. Evanescent waves are left out: slices are many wavelengths from the panel.
LayerSpectrum make_layer_spectrum(const Grid& panel, double wavelength, int nx, int ny, int reach_x, int reach_y);

/// Bytes of a spectrum with its tables.
double layer_spectrum_bytes(int reach_x, int reach_y);

/// Samples of a slice on a raster of nx × ny samples that repeats with the window. Only `rows` hold light.
struct SliceSamples {
  int nx = 0, ny = 0;
  std::vector<int> rows;                ///< indices of these rows, each once
  Array2D<std::complex<float>> values;  ///< one row of samples for each entry of `rows`
};

/// Factors of the frequencies along one axis, for |k| = 0, 1, …; frequencies beyond the last factor are dropped.
using AxisWeights = std::vector<float>;

/// How the light of a slice is added to a spectrum.
struct AddedLight {
  double distance = 0;  ///< distance d that it travels [m], of either sign
  double scale = 1;
  bool is_of_points = false;  ///< samples of points, or of a raster
};

/// Adds scale·wx(k)·wy(l)·S(k, l)·exp(−2πi·d·lag) to c, where S is the transform of the samples. For points the term is
/// also multiplied by inverse_cosine. The samples are overwritten.
///
/// @param along_x,along_y  weights wx, wy; at most K + 1 and L + 1, and no more than the samples' raster holds
void add_light(LayerSpectrum& spectrum, SliceSamples&& samples, const AxisWeights& along_x, const AxisWeights& along_y,
               const AddedLight& light);

/// Propagates the light over `distance` [m].
void carry(LayerSpectrum& spectrum, double distance);

/// Multiplies the light by 1 − mask. The mask starts at sample (column, row), counted from pixel (0, 0); light
/// outside it passes. The light that the mask's edges scatter is multiplied by the weights at |k|, |l|, which
/// keep what reaches the panel.
void hide(LayerSpectrum& spectrum, const Array2D<float>& mask, int column, int row, const AxisWeights& along_x,
          const AxisWeights& along_y);

/// Samples [0, columns) × [0, rows) of the light, from pixel (0, 0) of the panel on: the panel's own, or nx × ny.
Array2D<std::complex<float>> samples_of(const LayerSpectrum& spectrum, int columns, int rows);

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
