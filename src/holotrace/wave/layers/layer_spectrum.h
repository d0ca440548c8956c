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

}  // namespace holotrace
