#include "holotrace/wave/propagate/propagator.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/wave/propagate/convolve.h"
#include "holotrace/wave/propagate/propagation_axis.h"
#include "holotrace/wave/propagate/transfer.h"
#include "holotrace/wave/propagate/window_transform.h"
#include "holotrace/wave/shared/cost_model.h"

namespace holotrace {
namespace {

// Width of a tapered kernel's edge in standard deviations: 1e-11 of its light lies beyond in double, 1e-6 in float.
template <class Real>
constexpr double edge_widths = sizeof(Real) == sizeof(double) ? 7 : 5;

template <class Real>
double bytes_needed(const Propagator<Real>& p) {
  const PropagationAxis &x = p.x, &y = p.y;
  const bool is_on_lattice = p.is_on_lattice();
  const double columns = is_on_lattice ? y.padded : y.frequencies();
  const double transfer = 2.0 * sizeof(Real) * x.slots() * columns;
  const double rows = !is_on_lattice ? y.kernel_samples : y.is_even ? y.padded / 2.0 + 1 : y.padded;
  const double kernel = p.method == PropagationMethod::rayleigh_sommerfeld ? 2.0 * sizeof(Real) * x.slots() * rows : 0;
  const double use = is_on_lattice ? convolution_bytes(x, y, sizeof(Real)) : window_transform_bytes(x, y, sizeof(Real));
  return transfer + std::max(kernel, use);
}

}  // namespace

Grid propagation_output(const Grid& input, const PropagateParams& params) {
  check_ranges(params);
  Grid out{params.columns > 0 ? params.columns : input.nx, params.rows > 0 ? params.rows : input.ny, input.pitch,
           params.centre_x, params.centre_y};
  // A pitch that was written in another unit still counts as the input's.
  if (params.pitch > 0 && std::abs(params.pitch - input.pitch) > 1e-13 * input.pitch) out.pitch = params.pitch;
  return out;
}

template <class Real>
Propagator<Real> plan_propagator(const Grid& grid, double wavelength, double distance, const PropagateParams& params,
                                 const Observer& observer) {
  check_grid(grid);
  check_wavelength(wavelength, grid);
  require(std::isfinite(distance), "expected a finite distance to propagate over, got {} m", distance);
  Propagator<Real> p;
  p.input = grid;
  p.output = propagation_output(grid, params);
  p.wavelength = wavelength;
  p.distance = distance;
  p.x = make_axis_x(p.input, p.output, wavelength, distance);
  p.y = make_axis_y(p.input, p.output, wavelength, distance);
  if (params.is_periodic) {
    // A window that repeats has a spectrum of lines at the frequencies of the DFT. The transfer function at these
    // frequencies is exact, without padding or band limit.
    require(params.method == PropagationMethod::automatic || params.method == PropagationMethod::angular_spectrum,
            "expected the method angular-spectrum for a periodic window, got {}", method_name(params.method));
    p.method = PropagationMethod::angular_spectrum;
    observer.fact("method", std::string("angular-spectrum, periodic"));
    set_periodic_sampling(p.x);
    set_periodic_sampling(p.y);
    p.padded_nx = p.x.padded;
    p.padded_ny = p.y.padded;
    return p;
  }
  p.method = choose_method(p.x, p.y, params.method, observer);
  observer.fact("method", std::string(method_name(p.method)));
  for (PropagationAxis* axis : {&p.x, &p.y}) {
    const bool is_kernel = p.method == PropagationMethod::rayleigh_sommerfeld ||
                           (p.method == PropagationMethod::fresnel && takes_fresnel_kernel(*axis));
    set_sampling(*axis, p.method, is_kernel, edge_widths<Real>);
  }
  p.padded_nx = p.x.padded;
  p.padded_ny = p.y.padded;
  return p;
}

double propagation_bytes(const Grid& grid, double wavelength, double distance, const PropagateParams& params,
                         size_t bytes_per_real) {
  return bytes_per_real == sizeof(float) ? bytes_needed(plan_propagator<float>(grid, wavelength, distance, params))
                                         : bytes_needed(plan_propagator<double>(grid, wavelength, distance, params));
}

template <class Real>
Propagator<Real> make_propagator(const Grid& grid, double wavelength, double distance, const PropagateParams& params,
                                 const Observer& observer) {
  Propagator<Real> p = plan_propagator<Real>(grid, wavelength, distance, params, observer);
  require_memory(bytes_needed(p), fmt::format("a propagation of {} × {} samples, padded to {} × {},", grid.nx, grid.ny,
                                              p.x.padded, p.y.padded));
  switch (p.method) {
    case PropagationMethod::rayleigh_sommerfeld:
      fill_rayleigh_sommerfeld(p);
      break;
    case PropagationMethod::fresnel:
      fill_fresnel(p);
      break;
    default:
      fill_angular_spectrum(p);
      break;
  }
  return p;
}

template <class Real>
void check_field(const BasicField<Real>& field, const Propagator<Real>& p) {
  require(
      field.grid == p.input && field.wavelength == p.wavelength,
      "expected a field of {} × {} samples of {} at {}, centred at {}, {}, as the propagator was made for, got {} × "
      "{} of {} at {}, centred at {}, {}",
      p.input.nx, p.input.ny, format_length(p.input.pitch), format_length(p.wavelength),
      format_length(p.input.centre_x), format_length(p.input.centre_y), field.grid.nx, field.grid.ny,
      format_length(field.grid.pitch), format_length(field.wavelength), format_length(field.grid.centre_x),
      format_length(field.grid.centre_y));
}

template <class Real>
BasicField<Real> propagate(const BasicField<Real>& field, const Propagator<Real>& p, const Observer& observer) {
  check_field(field, p);
  BasicField<Real> out = p.is_on_lattice() ? convolve(field, p, observer) : transform_to_window(field, p, observer);
  copy_properties(field, out);
  return out;
}

template Propagator<float> plan_propagator(const Grid&, double, double, const PropagateParams&, const Observer&);
template Propagator<double> plan_propagator(const Grid&, double, double, const PropagateParams&, const Observer&);
template Propagator<float> make_propagator(const Grid&, double, double, const PropagateParams&, const Observer&);
template Propagator<double> make_propagator(const Grid&, double, double, const PropagateParams&, const Observer&);
template void check_field(const Field&, const Propagator<float>&);
template Field propagate(const Field&, const Propagator<float>&, const Observer&);
template FieldDouble propagate(const FieldDouble&, const Propagator<double>&, const Observer&);

std::optional<WindowShift> whole_shift(const Grid& grid, double wavelength, double distance,
                                       const PropagateParams& params) {
  if (distance != 0) return std::nullopt;
  const Grid window = propagation_output(grid, params);
  const PropagationAxis x = make_axis_x(grid, window, wavelength, 0), y = make_axis_y(grid, window, wavelength, 0);
  if (!x.is_on_lattice() || !y.is_on_lattice() || x.rest != 0 || y.rest != 0) return std::nullopt;
  return WindowShift{window, x.shift, y.shift};
}

namespace {

constexpr double from_memory = 1.4;

SummationWork convolution_work(const PropagationAxis& x, const PropagationAxis& y) {
  SummationWork work;
  const double rows = double(y.inputs) + y.outputs;
  for (int part = 0; part < x.parts; ++part) {
    const double columns = part_frequencies(x, part).count;
    work.fft_operations +=
        rows * fft_operations(x.part_length()) + 2 * columns * y.parts * fft_operations(y.part_length());
    work.samples += double(y.inputs) * x.inputs + double(y.outputs) * x.outputs + rows * columns +
                    columns * y.parts * (rows + y.part_length());
  }
  return work;
}

double window_operations(const WindowLength& window) {
  return (window.is_plain ? 1 : 2) * fft_operations(window.length);
}

SummationWork window_work(const PropagationAxis& x, const PropagationAxis& y) {
  const double columns = x.frequencies();
  const WindowLength to_x = window_length(x), to_y = window_length(y);
  SummationWork work;
  work.fft_operations = y.inputs * fft_operations(x.padded) + columns * fft_operations(y.padded) +
                        columns * window_operations(to_y) + y.outputs * window_operations(to_x);
  work.samples = y.inputs * (double(x.inputs) + columns) + columns * (2.0 * y.frequencies() + to_y.length + y.outputs) +
                 y.outputs * (columns + to_x.length + x.outputs);
  return work;
}

}  // namespace

SummationWork propagation_work(const Propagator<float>& plan) {
  return plan.is_on_lattice() ? convolution_work(plan.x, plan.y) : window_work(plan.x, plan.y);
}

double seconds_to_propagate(const Propagator<float>& plan) {
  return from_memory * processor_seconds(propagation_work(plan));
}

namespace {

void turn_around(PropagationAxis& axis) {
  std::swap(axis.inputs, axis.outputs);
  axis.offset = -axis.offset;
  axis.shift = -axis.shift;
  axis.rest = -axis.rest;
  axis.z = -axis.z;
}

void require_lattice(bool is_on_lattice) {
  require(is_on_lattice, "expected a propagation between windows of one pitch, got two pitches");
}

}  // namespace

template <class Real>
Propagator<Real> adjoint_of(const Propagator<Real>& p) {
  require_lattice(p.is_on_lattice());
  Propagator<Real> back = p;
  std::swap(back.input, back.output);
  back.distance = -p.distance;
  turn_around(back.x);
  turn_around(back.y);
  parallel_for(0, back.transfer.ny, [&](int64_t slot) {
    std::complex<Real>* row = back.transfer.row(int(slot));
    for (int i = 0; i < back.transfer.nx; ++i) row[i] = std::conj(row[i]);
  });
  return back;
}

template <class Real>
void filter_transfer(Propagator<Real>& p, const std::function<double(double)>& along_x,
                     const std::function<double(double)>& along_y) {
  require_lattice(p.is_on_lattice());
  // A column stores the frequencies of y part by part: frequency k is in part k modulo parts, at index k/parts.
  std::vector<Real> of_column(size_t(p.transfer.nx));
  for (int bin = 0; bin < p.y.padded; ++bin)
    of_column[size_t(bin % p.y.parts * p.y.part_length() + bin / p.y.parts)] =
        Real(along_y(double(std::min(bin, p.y.padded - bin)) / p.y.padded));
  parallel_for(0, p.transfer.ny, [&](int64_t slot) {
    const int k = p.x.is_even ? int(slot) : p.x.first + int(slot);
    const Real factor = Real(along_x(std::min(0.5, std::abs(double(k)) / p.x.padded)));
    std::complex<Real>* row = p.transfer.row(int(slot));
    for (int i = 0; i < p.transfer.nx; ++i) row[i] *= factor * of_column[size_t(i)];
  });
}

template <class Real>
double largest_transfer(const Propagator<Real>& p) {
  double most = 0;
  for (const std::complex<Real>& h : p.transfer.values) most = std::max(most, double(std::norm(h)));
  return std::sqrt(most);
}

template Propagator<float> adjoint_of(const Propagator<float>&);
template Propagator<double> adjoint_of(const Propagator<double>&);
template void filter_transfer(Propagator<float>&, const std::function<double(double)>&,
                              const std::function<double(double)>&);
template void filter_transfer(Propagator<double>&, const std::function<double(double)>&,
                              const std::function<double(double)>&);
template double largest_transfer(const Propagator<float>&);
template double largest_transfer(const Propagator<double>&);

}  // namespace holotrace
