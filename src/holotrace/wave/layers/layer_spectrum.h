#pragma once

#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"

namespace holotrace {

/// Light on a plane parallel to the panel as its spectrum, one for all slices of depth: their light is added to it, it
/// is carried from plane to plane, and made samples once, at the end.
///
///     U(x, y) = Σ c(k, l)·exp(2πi(k·X/nx + l·Y/ny)),   X, Y in samples from pixel (0, 0), |k| ≤ K, |l| ≤ L
///
/// The window repeats after nx × ny samples of the panel's pitch. K may exceed nx/2: such frequencies fold onto others
/// when samples are made, as on a panel. Free space over d takes c to c·exp(−2πi·d·lag) here, its axial phase 2πd/λ
/// left out: every slice adds its light with the axial phase of the whole way to the panel.
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

/// A dark spectrum. Evanescent waves are left out: slices are many wavelengths away.
LayerSpectrum make_layer_spectrum(const Grid& panel, double wavelength, int nx, int ny, int reach_x, int reach_y);

/// Bytes of a spectrum with its tables.
double layer_spectrum_bytes(int reach_x, int reach_y);

/// Samples of a slice on a raster that repeats with the window: nx × ny of them, of which only `rows` hold light.
struct SliceSamples {
  int nx = 0, ny = 0;
  std::vector<int> rows;                ///< their indices, each once
  Array2D<std::complex<float>> values;  ///< one row for each of them
};

/// What frequencies are multiplied with, for one axis: at |k| = 0, 1, …; none beyond.
using AxisWeights = std::vector<float>;

/// Adds scale·wx(k)·wy(l)·S(k, l)·exp(−2πi·d·lag), S being the transform of the samples; for points times
/// inverse_cosine too. The samples are spent.
///
/// @param along_x,along_y  weights, at most K + 1 and L + 1 and no more than the samples' raster holds
/// @param distance         d that the light travels [m], of either sign
void add_light(LayerSpectrum& spectrum, SliceSamples&& samples, const AxisWeights& along_x, const AxisWeights& along_y,
               double distance, double scale, bool is_of_points);

/// The light `distance` [m] further on.
void carry(LayerSpectrum& spectrum, double distance);

/// Multiplies the light by 1 − mask, sample (0, 0) of the mask being sample (column, row) from pixel (0, 0); outside
/// the mask it is let through. What the mask's edges scatter is kept with the weights at |k|, |l|: those that reach the
/// panel.
void hide(LayerSpectrum& spectrum, const Array2D<float>& mask, int column, int row, const AxisWeights& along_x,
          const AxisWeights& along_y);

/// The samples [0, columns) × [0, rows) of the light, pixel (0, 0) of the panel first: the panel's, or nx × ny.
Array2D<std::complex<float>> samples_of(const LayerSpectrum& spectrum, int columns, int rows);

}  // namespace holotrace
