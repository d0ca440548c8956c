#pragma once

#include "holotrace/slm/encode/frequency_band.h"
#include "holotrace/slm/encode/sample_kernels.h"
#include "holotrace/wave/transform/line_transform.h"

// The transforms of a field limited to a stop, on an OpenCL device: along rows, then along columns, and back. Only
// frequencies that pass are between them. The transforms do not divide by the number of samples.

namespace holotrace {

/// @param scales  a factor for each column
inline LineTransform rows_to_spectrum(const Grid& grid, const PassBand& pass, const DeviceBuffer& scales) {
  return {grid.nx, FftDirection::forward, {grid.nx, 0, {&scales}}, {pass.x.count, pass.x.first}};
}
inline LineTransform columns_to_spectrum(const Grid& grid, const PassBand& pass) {
  return {grid.ny, FftDirection::forward, {grid.ny}, {pass.y.count, pass.y.first}};
}
inline LineTransform columns_from_spectrum(const Grid& grid, const PassBand& pass) {
  return {grid.ny, FftDirection::backward, {pass.y.count, pass.y.first}, {grid.ny}};
}
inline LineTransform rows_from_spectrum(const Grid& grid, const PassBand& pass) {
  return {grid.nx, FftDirection::backward, {pass.x.count, pass.x.first}, {grid.nx}};
}

/// The fraction of a field's power in a part of its spectrum, by Parseval's theorem.
/// @param inside  Σ|bin|² of that part of the spectrum of unit·U
inline double part_of_power(double inside, const ModulusMoments& moments, double unit, const Grid& grid) {
  const double all = moments.square * unit * unit;
  return all > 0 ? inside / (all * double(grid.pixels())) : 1.0;
}

}  // namespace holotrace
