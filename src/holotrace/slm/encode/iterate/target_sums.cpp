#include "holotrace/slm/encode/iterate/target_sums.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/threads.h"
#include "holotrace/slm/encode/iterate/descent_kernel.h"

namespace holotrace {

using descent_kernel::mean_along;

namespace {

const float* weights_of(const Array2D<float>& weight, int row) {
  return weight.size() == 0 ? nullptr : weight.row(row);
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
    const float *a = target.amplitude.row(j), *w = weights_of(target.weight, j);
    double sum = 0;
    for (int i = 0; i < target.amplitude.nx; ++i) sum += (w ? double(w[i]) : 1.0) * a[i] * a[i];
    return sum;
  });
}

double target_power(const ViewTargets& views) {
  double power = 0;
  for (const Array2D<float>& amplitude : views.amplitudes)
    for (const float a : amplitude.values) power += double(a) * a;
  return power;
}

namespace {

int samples_across(const Field& field, const Array2D<float>& pixels) { return field.samples.nx / pixels.nx; }

}  // namespace

void add_power(const Field& samples, double factor, Array2D<float>& power) {
  const int n = samples_across(samples, power);
  parallel_for(
      0, power.ny,
      [&](int64_t row) {
        float* to = power.row(int(row));
        if (n == 1) return add_power(samples.samples.row(int(row)), float(factor), to, size_t(power.nx));
        for (int j = 0; j < n; ++j) {
          const std::complex<float>* v = samples.samples.row(int(row) * n + j);
          for (int i = 0; i < power.nx * n; ++i) to[i / n] += float(factor) * std::norm(v[i]);
        }
      },
      {}, 16);
}

void add_power(const std::vector<Field>& samples, double factor, Array2D<float>& power) {
  for (const Field& field : samples) add_power(field, factor, power);
}

Array2D<float> power_of(const std::vector<Field>& samples, const Grid& pixels) {
  Array2D<float> power(pixels.ny, pixels.nx);
  add_power(samples, 1, power);
  return power;
}

Array2D<float> pixel_means(const SamplePower& power) {
  const int ny = power[0].ny, nx = power[0].nx;
  // Along a row, from the left and the right samples of its pixels; and in the same way along the columns.
  const auto along_row = [&](size_t first, int j, std::vector<float>& means) {
    const float *left = power[first].row(j), *right = power[first + 1].row(j);
    for (int i = 0; i < nx; ++i)
      means[size_t(i)] =
          mean_along(left[i], right[i], i > 0 ? right[i - 1] : left[0], i + 1 < nx ? left[i + 1] : right[nx - 1]);
  };
  auto means = Array2D<float>::unset(ny, nx);
  parallel_for(
      0, ny,
      [&](int64_t row) {
        const int j = int(row);
        std::vector<float> above(static_cast<size_t>(nx)), upper(above), lower(above), below(above);
        j > 0 ? along_row(2, j - 1, above) : along_row(0, j, above);
        along_row(0, j, upper);
        along_row(2, j, lower);
        j + 1 < ny ? along_row(0, j + 1, below) : along_row(2, j, below);
        for (size_t i = 0; i < size_t(nx); ++i) means.row(j)[i] = mean_along(upper[i], lower[i], above[i], below[i]);
      },
      {}, 16);
  return means;
}

void multiply(const Array2D<float>& factor, Field& samples) {
  const int n = samples_across(samples, factor);
  parallel_for(
      0, factor.ny,
      [&](int64_t row) {
        const float* by = factor.row(int(row));
        if (n == 1) return multiply_by_real(by, samples.samples.row(int(row)), size_t(factor.nx));
        for (int j = 0; j < n; ++j) {
          std::complex<float>* v = samples.samples.row(int(row) * n + j);
          for (int i = 0; i < factor.nx * n; ++i) v[i] *= by[i / n];
        }
      },
      {}, 16);
}

void multiply(const Array2D<float>& factor, std::vector<Field>& samples) {
  for (Field& field : samples) multiply(factor, field);
}

ModulusSums fit_sums(const Array2D<float>& amplitude, const Array2D<float>& weight, const Array2D<float>& power) {
  const int nx = amplitude.nx, ny = amplitude.ny;
  std::vector<ModulusSums> rows(static_cast<size_t>(ny));
  parallel_for(
      0, ny,
      [&](int64_t j) {
        rows[size_t(j)] =
            modulus_sums(power.row(int(j)), amplitude.row(int(j)), weights_of(weight, int(j)), size_t(nx));
      },
      {}, 16);
  ModulusSums sums;
  for (const ModulusSums& row : rows) {
    sums.cross += row.cross;
    sums.square += row.square;
  }
  return sums;
}

double modulus_error(const TargetPlane& target, const Array2D<float>& power, double scale) {
  return sum_of_rows(target.amplitude.ny, [&](int j) {
    const float *a = target.amplitude.row(j), *w = weights_of(target.weight, j), *light = power.row(j);
    double sum = 0;
    for (int i = 0; i < target.amplitude.nx; ++i)
      sum += (w ? double(w[i]) : 1.0) * std::pow(std::sqrt(double(light[i])) - scale * a[i], 2);
    return sum;
  });
}

double leave_residual(const Array2D<float>& amplitude, const Array2D<float>& weight, double scale,
                      Array2D<float>& power) {
  return sum_of_rows(amplitude.ny, [&](int j) {
    return take_residual(power.row(j), amplitude.row(j), weights_of(weight, j), float(scale), size_t(amplitude.nx));
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
  std::vector<double> peaks(size_t(target.amplitude.ny));
  parallel_for(
      0, target.amplitude.ny,
      [&](int64_t j) {
        const float *a = target.amplitude.row(int(j)), *w = weights_of(target.weight, int(j));
        for (int i = 0; i < target.amplitude.nx; ++i)
          if (!w || w[i] > 0) peaks[size_t(j)] = std::max(peaks[size_t(j)], double(a[i]));
      },
      {}, 16);
  return peaks.empty() ? 0 : *std::max_element(peaks.begin(), peaks.end());
}

bool is_smooth(const TargetPlane& target) {
  const Array2D<float>& a = target.amplitude;
  const auto counts = [&](int j, int i) { return target.weight.size() == 0 || target.weight(j, i) > 0; };
  const double steps = sum_of_rows(a.ny, [&](int j) {
    double squares = 0;
    for (int i = 0; i < a.nx; ++i) {
      if (!counts(j, i)) continue;
      const double to_right = i + 1 < a.nx && counts(j, i + 1) ? a(j, i + 1) - a(j, i) : 0;
      const double below = j + 1 < a.ny && counts(j + 1, i) ? a(j + 1, i) - a(j, i) : 0;
      squares += to_right * to_right + below * below;
    }
    return squares;
  });
  const double pixels = sum_of_rows(a.ny, [&](int j) {
    const float* w = weights_of(target.weight, j);
    return w ? double(std::count_if(w, w + a.nx, [](float one) { return one > 0; })) : double(a.nx);
  });
  const double peak = target_peak(target);
  return steps / 16 <= 1e-4 * peak * peak * pixels;
}

}  // namespace holotrace
