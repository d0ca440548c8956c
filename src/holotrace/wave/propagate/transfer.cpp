#include "holotrace/wave/propagate/transfer.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <utility>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/column_fft.h"
#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/large_buffer.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/propagation_axis.h"
#include "holotrace/wave/propagate/propagation_kernel.h"
#include "holotrace/wave/propagate/transfer_row.h"

namespace holotrace {
namespace {

/// Positions along an axis at which a kernel is sampled, in the order of the transform, and the weights there.
struct KernelSamples {
  std::vector<double> place, weight;

  int size() const { return int(place.size()); }
};

/// On a lattice all offsets from sample to sample. Elsewhere a period around them, tapered beyond the offsets in use.
KernelSamples kernel_samples(const PropagationAxis& axis) {
  KernelSamples samples;
  if (axis.is_on_lattice()) {
    const int least = axis.shift - (axis.inputs - 1);
    for (int n = 0; n < axis.padded; ++n) {
      const int step = axis.is_even ? std::min(n, axis.padded - n) : least + wrapped(n - least, axis.padded);
      samples.place.push_back(step * axis.input_pitch + axis.rest);
    }
    samples.weight.assign(samples.place.size(), 1);
    return samples;
  }
  const int size = axis.kernel_samples;
  const double pitch = axis.period() / size;
  const int least = int(std::ceil((axis.middle() - axis.period() / 2) / pitch));
  for (int n = 0; n < size; ++n) {
    const double x = (least + wrapped(n - least, size)) * pitch, unit = std::sqrt(2.0) * axis.edge;
    samples.place.push_back(x);
    samples.weight.push_back(std::erfc((x - axis.farthest() - axis.taper / 2) / unit) / 2 *
                             std::erfc((axis.nearest() - axis.taper / 2 - x) / unit) / 2);
  }
  return samples;
}

/// Forward transform of a kernel over the samples of both axes. Calls fill(y, x, count, line) for the kernel's values
/// at y and x[0 … count), and store(slot, column) for each slot of x; the column holds the frequencies of y in the
/// transform's order. A kernel that is even along an axis is sampled on half of it.
template <class Real, class Fill, class Store>
void transform_kernel(const PropagationAxis& x, const PropagationAxis& y, const Fill& fill, const Store& store) {
  using Complex = std::complex<Real>;
  const KernelSamples across = kernel_samples(x), down = kernel_samples(y);
  const int nx = across.size(), ny = down.size(), slots = x.slots(), rows = y.is_even ? ny / 2 + 1 : ny;
  const int blocks = (slots + column_block - 1) / column_block;
  const Fft<double> along_x(nx, FftDirection::forward);
  const ColumnFft<Real> along_y(ny);
  LargeBuffer<Complex> turned(size_t(blocks) * size_t(rows) * column_block);  // [block of slots][row][slot in block]
  parallel_for(
      0, rows,
      [&](int64_t j) {
        AlignedVector<std::complex<double>> line(static_cast<size_t>(nx));
        fill(down.place[size_t(j)], across.place.data(), size_t(x.is_even ? nx / 2 + 1 : nx), line.data());
        for (int i = 1; x.is_even && i < (nx + 1) / 2; ++i) line[size_t(nx - i)] = line[size_t(i)];
        if (!x.is_on_lattice())
          for (size_t i = 0; i < line.size(); ++i) line[i] *= down.weight[size_t(j)] * across.weight[i];
        along_x(line.data());
        int bin = wrapped(x.is_even ? 0 : x.first, nx), slot = 0;
        for (int b = 0; b < blocks; ++b) {
          Complex* const to = turned.data() + (size_t(b) * size_t(rows) + size_t(j)) * column_block;
          for (int c = 0; c < column_block; ++c, ++slot) {
            to[c] = slot < slots ? Complex(line[size_t(bin)]) : Complex();
            if (++bin == nx) bin = 0;
          }
        }
      },
      {}, 8);
  parallel_for(0, blocks, [&](int64_t b) {
    const size_t size = along_y.work_size();
    AlignedVector<Complex> work(3 * size);
    Complex *const samples = work.data(), *const spectrum = samples + size, *const columns = spectrum + size;
    std::copy_n(turned.data() + size_t(b) * size_t(rows) * column_block, size_t(rows) * column_block, samples);
    for (int j = 1; y.is_even && j < (ny + 1) / 2; ++j)
      copy_block(samples + j * column_block, samples + (ny - j) * column_block);
    along_y(FftDirection::forward, samples, spectrum, columns);
    turn_to_columns(spectrum, ny, columns);
    for (int c = 0; c < std::min(column_block, slots - int(b) * column_block); ++c)
      store(int(b) * column_block + c, columns + size_t(c) * size_t(ny));
  });
}

using ComplexDouble = std::complex<double>;

// Index of the frequency k of y in a row of the table.
template <class Real>
int place(const Propagator<Real>& p, int k) {
  if (!p.is_on_lattice()) return k - p.y.first;
  const int bin = wrapped(k, p.y.padded);
  return bin % p.y.parts * p.y.part_length() + bin / p.y.parts;
}

}  // namespace

namespace transfer {  // a name, because lambdas of the templates below hold it

/// The table of a propagator, a row for each slot of x.
template <class Real>
class Table {
 public:
  explicit Table(Propagator<Real>& p) : values_(p.transfer) {
    values_ = Array2D<std::complex<Real>>::unset(p.x.slots(), p.is_on_lattice() ? p.y.padded : p.y.frequencies());
    for (int k = p.y.first; k <= p.y.last; ++k) places_.push_back(place(p, k));
  }

  /// Places in a row of the frequencies of y in use, first to last.
  const std::vector<int>& places() const { return places_; }

  /// Begins a row: 0 where no frequency is in use. The caller sets its values at all places().
  std::complex<Real>* begin_row(int slot) const {
    std::complex<Real>* row = values_.row(slot);
    if (places_.size() < size_t(values_.nx)) std::fill_n(row, values_.nx, std::complex<Real>());
    return row;
  }

 private:
  Array2D<std::complex<Real>>& values_;
  std::vector<int> places_;
};

}  // namespace transfer

namespace {

template <class Real>
int frequency_of_slot(const Propagator<Real>& p, int slot) {
  return p.x.is_even ? slot : p.x.first + slot;
}

// On a lattice, the factor that shifts outputs by a fraction of a pitch, exp(i2πu·rest). In an even spectrum the two
// frequencies ±1/2p share one sample, which gets their mean.
ComplexDouble part_of_pitch(const PropagationAxis& axis, int k) {
  if (axis.rest == 0 || !axis.is_on_lattice()) return 1;
  const ComplexDouble turn = cis_cycles(k * axis.rest / axis.period());
  return 2 * std::abs(k) == axis.padded ? ComplexDouble(turn.real()) : turn;
}

// Transmission of the smooth edges of the band.
double passing(const PropagationAxis& axis, int k) {
  const double u = k / axis.period();
  const auto passing_edge = [](const BandEdge& edge, double beyond) {
    return edge.deviation > 0 ? std::erfc(beyond / (std::sqrt(2.0) * edge.deviation)) / 2 : 1.0;
  };
  return passing_edge(axis.low, axis.low.at - u) * passing_edge(axis.high, u - axis.high.at);
}

// Further factors of one axis, apart from the transfer function, at the frequencies in use.
std::vector<ComplexDouble> beside_transfer(const PropagationAxis& axis) {
  std::vector<ComplexDouble> factors;
  for (int k = axis.first; k <= axis.last; ++k) factors.push_back(passing(axis, k) * part_of_pitch(axis, k));
  return factors;
}

// One factor of the paraxial kernel, at the frequencies in use.
std::vector<ComplexDouble> fresnel_axis(const PropagationAxis& axis) {
  const double lambda = axis.wavelength, z = axis.z, du = 1 / axis.period();
  std::vector<ComplexDouble> factor;
  if (!takes_fresnel_kernel(axis)) {
    factor = beside_transfer(axis);
    for (int k = axis.first; k <= axis.last; ++k)
      factor[size_t(k - axis.first)] *= cis_cycles(-lambda * z / 2 * (k * du) * (k * du));
    return factor;
  }
  const KernelSamples samples = kernel_samples(axis);
  const int n = std::max(1, samples.size());
  const double inverse = 1 / (lambda * z), ratio = double(axis.padded) / n;
  const ComplexDouble scale =
      std::polar(ratio * axis.input_pitch * std::sqrt(std::abs(inverse)), -std::copysign(pi / 4, z));
  AlignedVector<ComplexDouble> kernel;
  for (size_t i = 0; i < size_t(n); ++i)
    kernel.push_back(scale * samples.weight[i] * cis_cycles(samples.place[i] * samples.place[i] * inverse / 2));
  Fft<double>(n, FftDirection::forward)(kernel.data());
  for (int k = axis.first; k <= axis.last; ++k) factor.push_back(kernel[size_t(wrapped(k, n))]);
  return factor;
}

// The transfer function at one u and many v, times a factor.
struct Column {
  double u, wavelength, z, start;
  const std::vector<double>&v, &v2;  // v and v² [1/m]

  void fill(const ComplexDouble& factor, std::vector<std::complex<double>>& to) const {
    for (size_t j = 0; j < v.size(); ++j) to[j] = factor * angular_spectrum_transfer(u, v[j], wavelength, z, start);
  }
  void fill(const ComplexDouble& factor, std::vector<std::complex<float>>& to) const {
    const double k = 1 / wavelength;
    if (u * u + v2.back() > k * k) {  // evanescent waves decay
      for (size_t j = 0; j < v.size(); ++j)
        to[j] = std::complex<float>(factor * angular_spectrum_transfer(u, v[j], wavelength, z, start));
      return;
    }
    transfer_row({u * u, k, z, start}, v2.data(), v2.size(), to.data());
    if (factor != 1.0)
      for (std::complex<float>& h : to) h *= std::complex<float>(factor);
  }
};

}  // namespace

template <class Real>
void fill_angular_spectrum(Propagator<Real>& p) {
  const double z = p.distance, du = 1 / p.x.period(), dv = 1 / p.y.period();
  const double start = cycle_fraction(z, p.wavelength);
  const std::vector<ComplexDouble> exactly_beside = beside_transfer(p.y);
  const std::vector<std::complex<Real>> beside(exactly_beside.begin(), exactly_beside.end());
  const bool is_plain =
      std::all_of(beside.begin(), beside.end(), [](const std::complex<Real>& factor) { return factor == Real(1); });
  // The function is even in v: each |v| is computed once.
  const int least = p.y.first <= 0 && p.y.last >= 0 ? 0 : std::min(std::abs(p.y.first), std::abs(p.y.last));
  const int most = std::max(std::abs(p.y.first), std::abs(p.y.last));
  std::vector<double> v, v2;
  for (int j = least; j <= most; ++j) v.push_back(j * dv);
  for (const double of_v : v) v2.push_back(of_v * of_v);
  const transfer::Table<Real> table(p);
  const std::vector<int>& places = table.places();
  parallel_for(0, p.x.slots(), [&](int64_t slot) {
    const int i = frequency_of_slot(p, int(slot));
    std::vector<std::complex<Real>> column(v.size()), in_order(p.is_on_lattice() ? places.size() : 0);
    const auto at = [&](int j) { return column.data() + (j - least); };
    Column{i * du, p.wavelength, z, start, v, v2}.fill(passing(p.x, i) * part_of_pitch(p.x, i), column);
    std::complex<Real>* row = table.begin_row(int(slot));
    std::complex<Real>* line = p.is_on_lattice() ? in_order.data() : row;
    auto next = line;
    if (p.y.first < 0) next = std::reverse_copy(at(std::abs(std::min(p.y.last, -1))), at(-p.y.first) + 1, next);
    if (p.y.last >= 0) std::copy(at(std::max(p.y.first, 0)), at(p.y.last) + 1, next);
    if (!is_plain) multiply(line, line, beside.data(), beside.size());
    if (line == row) return;
    for (size_t n = 0; n < in_order.size(); ++n) row[places[n]] = in_order[n];
  });
}

template <class Real>
void fill_rayleigh_sommerfeld(Propagator<Real>& p) {
  const double start = cycle_fraction(std::abs(p.distance), p.wavelength);
  const int nx = p.is_on_lattice() ? p.x.padded : p.x.kernel_samples;
  const int ny = p.is_on_lattice() ? p.y.padded : p.y.kernel_samples;
  const double scale = p.input.pitch * p.input.pitch * (double(p.x.padded) / nx) * (double(p.y.padded) / ny);
  const transfer::Table<Real> table(p);
  transform_kernel<Real>(
      p.x, p.y,
      [&](double y, const double* x, size_t count, ComplexDouble* line) {
        rayleigh_sommerfeld_row({y, p.wavelength, p.distance, start, scale}, x, count, line);
      },
      [&](int slot, const std::complex<Real>* column) {
        std::complex<Real>* row = table.begin_row(slot);
        int bin = wrapped(p.y.first, ny);
        for (const int at : table.places()) {
          row[at] = column[bin];
          if (++bin == ny) bin = 0;
        }
      });
}

template <class Real>
void fill_fresnel(Propagator<Real>& p) {
  const std::vector<ComplexDouble> along_x = fresnel_axis(p.x), along_y = fresnel_axis(p.y);
  const ComplexDouble axial = cis_cycles(cycle_fraction(p.distance, p.wavelength));
  const transfer::Table<Real> table(p);
  parallel_for(0, p.x.slots(), [&](int64_t slot) {
    // On an even axis frequency −slot is always in use; +slot is not, if it is the middle of the spectrum.
    const int i = p.x.is_even ? -int(slot) : p.x.first + int(slot);
    std::complex<Real>* row = table.begin_row(int(slot));
    for (size_t k = 0; k < along_y.size(); ++k)
      row[table.places()[k]] = std::complex<Real>(axial * along_x[size_t(i - p.x.first)] * along_y[k]);
  });
}

template void fill_angular_spectrum(Propagator<float>&);
template void fill_angular_spectrum(Propagator<double>&);
template void fill_rayleigh_sommerfeld(Propagator<float>&);
template void fill_rayleigh_sommerfeld(Propagator<double>&);
template void fill_fresnel(Propagator<float>&);
template void fill_fresnel(Propagator<double>&);

}  // namespace holotrace
