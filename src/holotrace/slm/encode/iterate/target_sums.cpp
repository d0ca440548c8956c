#include "holotrace/slm/encode/iterate/target_sums.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/threads.h"

namespace holotrace {
namespace {

const float* weights_of(const TargetPlane& target, int row) {
  return target.weight.size() == 0 ? nullptr : target.weight.row(row);
}

// Σ over rows of `work(row)`, in their order.
template <class Work>
double sum_of_rows(int rows, const Work& work) {
  std::vector<double> parts(static_cast<size_t>(rows));
  parallel_for(
      0, rows, [&](int64_t j) { parts[size_t(j)] = work(int(j)); }, {}, 16);
  double sum = 0;
  for (const double part : parts) sum += part;
  return sum;
}

}  // namespace

double target_power(const TargetPlane& target) {
  return sum_of_rows(target.amplitude.ny, [&](int j) {
    const float *a = target.amplitude.row(j), *w = weights_of(target, j);
    double sum = 0;
    for (int i = 0; i < target.amplitude.nx; ++i) sum += (w ? double(w[i]) : 1.0) * a[i] * a[i];
    return sum;
  });
}

ModulusSums fit_sums(const TargetPlane& target, const Field& shown) {
  const int nx = target.amplitude.nx, ny = target.amplitude.ny;
  std::vector<ModulusSums> rows(static_cast<size_t>(ny));
  parallel_for(
      0, ny,
      [&](int64_t j) {
        rows[size_t(j)] = modulus_sums(shown.samples.row(int(j)), target.amplitude.row(int(j)),
                                       weights_of(target, int(j)), size_t(nx));
      },
      {}, 16);
  ModulusSums sums;
  for (const ModulusSums& row : rows) {
    sums.cross += row.cross;
    sums.square += row.square;
  }
  return sums;
}

double modulus_error(const TargetPlane& target, const Field& shown, double scale) {
  return sum_of_rows(target.amplitude.ny, [&](int j) {
    const float *a = target.amplitude.row(j), *w = weights_of(target, j);
    const std::complex<float>* v = shown.samples.row(j);
    double sum = 0;
    for (int i = 0; i < target.amplitude.nx; ++i) {
      const double modulus = std::sqrt(double(v[i].real()) * v[i].real() + double(v[i].imag()) * v[i].imag());
      sum += (w ? double(w[i]) : 1.0) * std::pow(modulus - scale * a[i], 2);
    }
    return sum;
  });
}

double leave_residual(const TargetPlane& target, double scale, Field& shown) {
  return sum_of_rows(target.amplitude.ny, [&](int j) {
    return take_residual(shown.samples.row(j), target.amplitude.row(j), weights_of(target, j), float(scale),
                         size_t(target.amplitude.nx));
  });
}

void add_part(const Field& from, double factor, Field& to) {
  const bool is_first = to.samples.size() == 0;
  if (is_first) to = from;
  parallel_for(
      0, from.grid.ny,
      [&](int64_t j) {
        const std::complex<float>* source = from.samples.row(int(j));
        std::complex<float>* sum = to.samples.row(int(j));
        for (int i = 0; i < from.grid.nx; ++i) {
          const std::complex<float> part = float(factor) * source[i];
          sum[i] = is_first ? part : sum[i] + part;
        }
      },
      {}, 16);
}

double target_peak(const TargetPlane& target) {
  double peak = 0;
  for (size_t i = 0; i < target.amplitude.size(); ++i)
    if (target.weight.size() == 0 || target.weight.values[i] > 0)
      peak = std::max(peak, double(target.amplitude.values[i]));
  return peak;
}

}  // namespace holotrace
