#include "holotrace/wave/transfer.h"

#include <algorithm>

#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/wave/propagation_kernel.h"

namespace holotrace {
namespace {

using Complex = std::complex<double>;

double frequency_step(int padded, double pitch) { return 1 / (padded * pitch); }

// One factor of the paraxial kernel, at the frequencies 0 … padded/2.
std::vector<Complex> fresnel_axis(int padded, double pitch, double wavelength, double z, double largest_offset) {
  const double du = frequency_step(padded, pitch);
  if (std::abs(z) <= 2 * pitch * largest_offset / wavelength) {
    std::vector<Complex> transfer(size_t(padded / 2) + 1);
    for (size_t k = 0; k < transfer.size(); ++k)
      transfer[k] = cis_cycles(-wavelength * z / 2 * (double(k) * du) * (double(k) * du));
    return transfer;
  }
  const double inverse = 1 / (wavelength * z);
  const Complex scale = std::polar(pitch * std::sqrt(std::abs(inverse)), -std::copysign(pi / 4, z));
  AlignedVector<Complex> kernel(static_cast<size_t>(padded));
  for (int i = 0; i < padded; ++i) {
    const double x = std::min(i, padded - i) * pitch;
    kernel[size_t(i)] = scale * cis_cycles(x * x * inverse / 2);
  }
  Fft<double>(padded, FftDirection::forward)(kernel.data());
  return {kernel.begin(), kernel.begin() + padded / 2 + 1};
}

}  // namespace

template <class Real>
void fill_angular_spectrum(Propagator<Real>& p, int band_nx, int band_ny) {
  const double pitch = p.input.pitch, z = p.distance;
  const double du = frequency_step(p.padded_nx, pitch), dv = frequency_step(p.padded_ny, pitch);
  const double start = cycle_fraction(z, p.wavelength);
  p.band_nx = band_nx;
  p.band_ny = band_ny;
  p.transfer = Array2D<std::complex<Real>>(p.padded_ny / 2 + 1, p.padded_nx / 2 + 1);
  parallel_for(0, p.band_ny, [&](int64_t j) {
    for (int i = 0; i < p.band_nx; ++i)
      p.transfer(int(j), i) =
          std::complex<Real>(angular_spectrum_transfer(i * du, double(j) * dv, p.wavelength, z, start));
  });
}

template <class Real>
void fill_rayleigh_sommerfeld(Propagator<Real>& p) {
  const double pitch = p.input.pitch, area = pitch * pitch;
  const double start = cycle_fraction(std::abs(p.distance), p.wavelength);
  const int nx = p.padded_nx, ny = p.padded_ny;
  Array2D<Complex> kernel(ny, nx);
  parallel_for(0, ny / 2 + 1, [&](int64_t j) {
    Complex* row = kernel.row(int(j));
    for (int i = 0; i <= nx / 2; ++i) {
      const double x = i * pitch, y = double(j) * pitch;
      row[i] = area * rayleigh_sommerfeld_kernel(x * x + y * y, p.wavelength, p.distance, start);
      row[(nx - i) % nx] = row[i];
    }
    std::copy(row, row + nx, kernel.row((ny - int(j)) % ny));
  });
  fft_2d(kernel.values.data(), ny, nx, FftDirection::forward);
  p.transfer = Array2D<std::complex<Real>>(ny / 2 + 1, nx / 2 + 1);
  for (int j = 0; j <= ny / 2; ++j)
    for (int i = 0; i <= nx / 2; ++i) p.transfer(j, i) = std::complex<Real>(kernel(j, i));
  p.band_nx = nx / 2 + 1;
  p.band_ny = ny / 2 + 1;
}

template <class Real>
void fill_fresnel(Propagator<Real>& p) {
  const double pitch = p.input.pitch;
  const auto axis = [&](int padded, int pixels) {
    return fresnel_axis(padded, pitch, p.wavelength, p.distance, pixels * pitch / 2);
  };
  const std::vector<Complex> along_x = axis(p.padded_nx, p.input.nx + p.output.nx);
  const std::vector<Complex> along_y = axis(p.padded_ny, p.input.ny + p.output.ny);
  const Complex axial = cis_cycles(cycle_fraction(p.distance, p.wavelength));
  p.transfer = Array2D<std::complex<Real>>(p.padded_ny / 2 + 1, p.padded_nx / 2 + 1);
  for (int j = 0; j <= p.padded_ny / 2; ++j)
    for (int i = 0; i <= p.padded_nx / 2; ++i)
      p.transfer(j, i) = std::complex<Real>(axial * along_x[size_t(i)] * along_y[size_t(j)]);
  p.band_nx = p.padded_nx / 2 + 1;
  p.band_ny = p.padded_ny / 2 + 1;
}

template void fill_angular_spectrum(Propagator<float>&, int, int);
template void fill_angular_spectrum(Propagator<double>&, int, int);
template void fill_rayleigh_sommerfeld(Propagator<float>&);
template void fill_rayleigh_sommerfeld(Propagator<double>&);
template void fill_fresnel(Propagator<float>&);
template void fill_fresnel(Propagator<double>&);

}  // namespace holotrace
