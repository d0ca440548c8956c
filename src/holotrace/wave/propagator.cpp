#include "holotrace/wave/propagator.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/propagation_kernel.h"
#include "holotrace/wave/transfer.h"

namespace holotrace {
namespace {

// What the sampling condition says of one axis: a window of `offset` to the largest offset between
// input and output, samples `pitch` apart.
struct Axis {
  const char* name;
  double offset, pitch, wavelength, z;
  int padded;

  double critical() const { return critical_distance(offset, wavelength, pitch); }
  // Samples of the transfer function inside Matsushima's band, on one side of zero.
  double band_samples() const {
    const double du = 1 / (padded * pitch);
    return std::min(band_limit(wavelength, du, z) / du, double(padded / 2));
  }
  int band_samples_held() const { return int(band_samples()) + 1; }
  // With fewer samples than this the band's edge, which rings, is all there is.
  bool holds_angular_spectrum() const { return z <= critical() || band_samples() >= 8; }
  // Mean side of the input and output windows that makes it eight: (window/λz)·window/4 samples.
  double window_needed() const { return std::sqrt(4 * wavelength * z); }
  // The pitch at which the Rayleigh–Sommerfeld kernel is sampled well over the window.
  double pitch_needed() const { return wavelength / 2 * std::hypot(1.0, z / offset); }
};

std::string explain(const Axis& x, const Axis& y, double z) {
  const Axis& narrow = x.offset < y.offset ? x : y;
  const Axis& wide = x.offset < y.offset ? y : x;
  return fmt::format(
      "no method can sample a propagation over {} here: the window in {} would have to be {} or wider for the angular "
      "spectrum, or the pitch {} or finer for the Rayleigh–Sommerfeld kernel in {}",
      format_length(z), narrow.name, format_length(narrow.window_needed()), format_length(wide.pitch_needed()),
      wide.name);
}

const char* method_name(PropagationMethod method) {
  switch (method) {
    case PropagationMethod::angular_spectrum:
      return "angular-spectrum";
    case PropagationMethod::rayleigh_sommerfeld:
      return "rayleigh-sommerfeld";
    case PropagationMethod::fresnel:
      return "fresnel";
    case PropagationMethod::automatic:
      break;
  }
  return "auto";
}

PropagationMethod choose_method(const Axis& x, const Axis& y, const Observer& observer) {
  const double critical = std::max(x.critical(), y.critical());
  if (x.z >= critical) {
    observer.fact("why",
                  fmt::format("{} is at or beyond z* = {}, from which the kernel is sampled well over the window",
                              format_length(x.z), format_length(critical)));
    return PropagationMethod::rayleigh_sommerfeld;
  }
  require(x.holds_angular_spectrum() && y.holds_angular_spectrum(), "{}", explain(x, y, x.z));
  observer.fact("why", fmt::format("{} is below z* = {}, up to which the padded transfer function is sampled well",
                                   format_length(x.z), format_length(critical)));
  return PropagationMethod::angular_spectrum;
}

// A method named by the user must suit the distance, or say what would.
void check_method(PropagationMethod method, const Axis& x, const Axis& y, const Observer& observer) {
  const double critical = std::max(x.critical(), y.critical()), z = x.z;
  if (method == PropagationMethod::angular_spectrum)
    require(x.holds_angular_spectrum() && y.holds_angular_spectrum(),
            "the angular spectrum cannot sample a propagation over {}: it needs a window of {} × {} or wider; use "
            "rayleigh-sommerfeld, or a larger window",
            format_length(z), format_length(x.window_needed()), format_length(y.window_needed()));
  if (method == PropagationMethod::fresnel) {
    const double rho2 = (x.offset * x.offset + y.offset * y.offset) / 4;  // from the axis to the panel's corner
    const double neglected = pi / 4 * rho2 * rho2 / (x.wavelength * z * z * z);
    if (neglected > 0.1)
      observer.warn(fmt::format(
          "the paraxial Fresnel kernel neglects up to {:.2g} rad of a wave from the panel's corner over {}; the other "
          "methods are exact here",
          neglected, format_length(z)));
  }
  if (method != PropagationMethod::rayleigh_sommerfeld || z >= critical) return;
  const double pitch = std::min(x.pitch_needed(), y.pitch_needed());
  require(z >= critical / 20,
          "the Rayleigh–Sommerfeld kernel cannot be sampled over {} at a pitch of {}: it needs {} or finer; use "
          "angular-spectrum, or a finer pitch",
          format_length(z), format_length(x.pitch), format_length(pitch));
  observer.warn(fmt::format(
      "the Rayleigh–Sommerfeld kernel aliases near the window's edges over {}: it is sampled well from {} on, or at a "
      "pitch of {}; angular-spectrum holds here",
      format_length(z), format_length(critical), format_length(pitch)));
}

// A window that repeats has a spectrum of lines at the frequencies of the DFT: the transfer function there is
// all there is to know, without padding or band limit.
template <class Real>
void prepare_periodic(Propagator<Real>& p, const PropagateParams& params, const Observer& observer) {
  require(params.method == PropagationMethod::automatic || params.method == PropagationMethod::angular_spectrum,
          "expected the method angular-spectrum for a periodic window, got {}", method_name(params.method));
  require(p.output == p.input, "expected the output window of a periodic propagation to be the input's");
  p.padded_nx = p.input.nx;
  p.padded_ny = p.input.ny;
  p.method = PropagationMethod::angular_spectrum;
  observer.fact("method", std::string("angular-spectrum, periodic"));
  fill_angular_spectrum(p, p.padded_nx / 2 + 1, p.padded_ny / 2 + 1);
}

// The rows that are transformed along x, the quarter of the transfer function, and the whole of the
// Rayleigh–Sommerfeld kernel while it is transformed, in case that is the method.
template <class Real>
double bytes_needed(const Propagator<Real>& p) {
  const double padded = double(p.padded_nx) * p.padded_ny;
  const double rows = double(p.padded_nx) * std::max(p.input.ny, p.output.ny);
  return (rows + padded / 4) * sizeof(std::complex<Real>) + padded * sizeof(std::complex<double>);
}

// What one block of columns leaves in the band that is dropped, and in all.
struct BandEnergy {
  double dropped = 0, all = 0;
};

}  // namespace

Grid propagation_output(const Grid& input, const PropagateParams& params) {
  require(params.columns >= 0 && params.rows >= 0,
          "expected an output window of 0 (as the input) or more pixels, got {} × {}", params.columns, params.rows);
  Grid out = input;
  if (params.columns > 0) out.nx = params.columns;
  if (params.rows > 0) out.ny = params.rows;
  require(
      (out.nx - input.nx) % 2 == 0 && (out.ny - input.ny) % 2 == 0,
      "expected an output window that differs from the input's {} × {} by even numbers of pixels (both are centred), "
      "got {} × {}",
      input.nx, input.ny, out.nx, out.ny);
  return out;
}

template <class Real>
Propagator<Real> make_propagator(const Grid& grid, double wavelength, double distance, const PropagateParams& params,
                                 const Observer& observer) {
  check_grid(grid);
  check_wavelength(wavelength);
  require(std::isfinite(distance), "expected a finite distance to propagate over, got {} m", distance);
  require(distance != 0, "expected a distance other than 0 m for a propagator");

  Propagator<Real> p;
  p.input = grid;
  p.output = propagation_output(grid, params);
  p.wavelength = wavelength;
  p.distance = distance;
  if (params.is_periodic) {
    prepare_periodic(p, params, observer);
    return p;
  }
  p.padded_nx = fft_good_length(p.input.nx + p.output.nx);
  p.padded_ny = fft_good_length(p.input.ny + p.output.ny);
  require_memory(bytes_needed(p), fmt::format("a propagation of {} × {} samples, padded to {} × {},", grid.nx, grid.ny,
                                              p.padded_nx, p.padded_ny));
  const Axis x{"x",        (p.input.nx + p.output.nx) * grid.pitch / 2, grid.pitch, wavelength, std::abs(distance),
               p.padded_nx};
  const Axis y{"y",        (p.input.ny + p.output.ny) * grid.pitch / 2, grid.pitch, wavelength, std::abs(distance),
               p.padded_ny};
  p.method = params.method == PropagationMethod::automatic ? choose_method(x, y, observer) : params.method;
  check_method(p.method, x, y, observer);
  observer.fact("method", std::string(method_name(p.method)));
  switch (p.method) {
    case PropagationMethod::rayleigh_sommerfeld:
      fill_rayleigh_sommerfeld(p);
      break;
    case PropagationMethod::fresnel:
      fill_fresnel(p);
      break;
    default:
      fill_angular_spectrum(p, x.band_samples_held(), y.band_samples_held());
      break;
  }
  return p;
}

template <class Real>
BasicField<Real> propagate(const BasicField<Real>& field, const Propagator<Real>& p, const Observer& observer) {
  using Complex = std::complex<Real>;
  require(field.grid == p.input && field.wavelength == p.wavelength,
          "expected a field of {} × {} samples of {} at {}, as the propagator was made for, got {} × {} of {} at {}",
          p.input.nx, p.input.ny, format_length(p.input.pitch), format_length(p.wavelength), field.grid.nx,
          field.grid.ny, format_length(field.grid.pitch), format_length(field.wavelength));
  const int nx = p.padded_nx, ny = p.padded_ny;
  const Fft<Real> forward_x(nx, FftDirection::forward), backward_x(nx, FftDirection::backward);
  const Fft<Real> forward_y(ny, FftDirection::forward), backward_y(ny, FftDirection::backward);

  // Input sample i sits at index i of the padded window; output sample o at o − shift, modulo its size.
  const int shift_x = (p.output.nx - p.input.nx) / 2, shift_y = (p.output.ny - p.input.ny) / 2;
  const auto wrapped = [](int index, int size) { return index < 0 ? index + size : index; };

  // 1. Along x: only the rows that hold input.
  Array2D<Complex> spectrum(std::max(p.input.ny, p.output.ny), nx);
  parallel_for(0, p.input.ny, [&](int64_t j) {
    Complex* row = spectrum.row(int(j));
    std::copy_n(field.samples.row(int(j)), p.input.nx, row);
    forward_x(row);
  });
  observer.progress(0.25);

  // 2. Along y, a block of columns at a time in the cache: transform, multiply, transform back, and keep
  //    the rows that hold output.
  constexpr int block = 16;
  const int blocks = (nx + block - 1) / block;
  const bool is_band_limited = p.band_nx <= nx / 2 || p.band_ny <= ny / 2;
  std::vector<BandEnergy> energies(is_band_limited ? size_t(blocks) : 0);
  parallel_for(0, blocks, [&](int64_t b) {
    const int first = int(b) * block, count = std::min(block, nx - first);
    AlignedVector<Complex> columns(size_t(ny) * block);
    for (int j = 0; j < p.input.ny; ++j)
      for (int c = 0; c < count; ++c) columns[size_t(c) * ny + j] = spectrum(j, first + c);
    for (int c = 0; c < count; ++c) {
      Complex* column = columns.data() + size_t(c) * ny;
      forward_y(column);
      const int i = std::min(first + c, nx - first - c);
      if (is_band_limited)
        for (int j = 0; j < ny; ++j) {
          const double energy = std::norm(column[j]);
          energies[size_t(b)].all += energy;
          if (i >= p.band_nx || std::min(j, ny - j) >= p.band_ny) energies[size_t(b)].dropped += energy;
        }
      for (int j = 0; j < ny; ++j) {
        const Complex h = p.transfer(std::min(j, ny - j), i), u = column[j];
        column[j] = {h.real() * u.real() - h.imag() * u.imag(), h.real() * u.imag() + h.imag() * u.real()};
      }
      backward_y(column);
    }
    for (int o = 0; o < p.output.ny; ++o)
      for (int c = 0; c < count; ++c)
        spectrum(o, first + c) = columns[size_t(c) * ny + size_t(wrapped(o - shift_y, ny))];
  });
  observer.progress(0.75);

  // 3. Back along x: only the rows that hold output.
  BasicField<Real> out(p.output, field.wavelength, field.z + p.distance);
  out.image = field.image;
  out.filter = field.filter;
  const Real scale = Real(1.0 / (double(nx) * ny));
  parallel_for(0, p.output.ny, [&](int64_t o) {
    Complex* row = spectrum.row(int(o));
    backward_x(row);
    Complex* to = out.samples.row(int(o));
    for (int i = 0; i < p.output.nx; ++i) to[i] = row[wrapped(i - shift_x, nx)] * scale;
  });

  if (is_band_limited) {
    const auto sum = std::accumulate(energies.begin(), energies.end(), BandEnergy{}, [](BandEnergy a, BandEnergy b) {
      return BandEnergy{a.dropped + b.dropped, a.all + b.all};
    });
    observer.fact("energy_beyond_band", sum.all > 0 ? sum.dropped / sum.all : 0.0);
  }
  observer.progress(1);
  return out;
}

template Propagator<float> make_propagator(const Grid&, double, double, const PropagateParams&, const Observer&);
template Propagator<double> make_propagator(const Grid&, double, double, const PropagateParams&, const Observer&);
template Field propagate(const Field&, const Propagator<float>&, const Observer&);
template FieldDouble propagate(const FieldDouble&, const Propagator<double>&, const Observer&);

}  // namespace holotrace
