#include "holotrace/view/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

/// Sums over all values of an image. add(i, sums) adds what value i contributes to the sums of its row. Rows are added in their
/// order: the result does not depend on the number of threads.
template <size_t count, class Add>
std::array<double, count> sums_over(const Image& image, const Add& add) {
  using Sums = std::array<double, count>;
  const size_t in_row = size_t(image.nx) * size_t(image.channels);
  std::vector<Sums> rows(size_t(image.ny), Sums{});
  parallel_for(
      0, image.ny,
      [&](int64_t row) {
        Sums sums{};
        for (size_t i = size_t(row) * in_row; i < size_t(row + 1) * in_row; ++i) add(i, sums);
        rows[size_t(row)] = sums;
      },
      {}, 16);
  Sums all{};
  for (const Sums& row : rows)
    for (size_t n = 0; n < count; ++n) all[n] += row[n];
  return all;
}

void check_finite(const Image& image, std::string_view what) {
  const auto strange = sums_over<1>(image, [&](size_t i, auto& sums) { sums[0] += !std::isfinite(image.values[i]); });
  if (strange[0] == 0) return;
  const size_t channels = size_t(image.channels), nx = size_t(image.nx);
  for (size_t i = 0; i < image.values.size(); ++i)
    require(std::isfinite(image.values[i]), "expected finite values in the {}, got {} at row {}, column {}", what,
            image.values[i], i / channels / nx, i / channels % nx);
}

double rms_difference(const Image& reference, const Image& image, double scale) {
  const auto [squares] = sums_over<1>(image, [&](size_t i, auto& sums) {
    const double d = double(reference.values[i]) - scale * double(image.values[i]);
    sums[0] += d * d;
  });
  return std::sqrt(squares / double(image.values.size()));
}

double peak_of(const Image& reference) {
  const double peak =
      reference.values.empty() ? 0 : *std::max_element(reference.values.begin(), reference.values.end());
  require(peak > 0, "expected a reference with light in it, got one whose maximum is {}", peak);
  return peak;
}

// σ/μ from sums over n values; 0 where the mean is 0.
double contrast(double sum, double sum_of_squares, double n) {
  if (sum == 0) return 0;
  const double mean = sum / n;
  return std::sqrt(std::max(0.0, sum_of_squares / n - mean * mean)) / mean;
}

// 1 − (b − a)/(b + a) = 2a/(a + b), a and b the 1st and 99th percentiles (nearest rank).
double uniformity_of(std::vector<double> ratios) {
  if (ratios.empty()) return 0;
  const auto percentile = [&](double part) {
    const auto rank = ratios.begin() + std::ptrdiff_t(std::ceil(part * double(ratios.size()))) - 1;
    std::nth_element(ratios.begin(), rank, ratios.end());
    return std::max(0.0, *rank);
  };
  const double least = percentile(0.01), most = percentile(0.99);
  return most > 0 ? 2 * least / (least + most) : 0;
}

// A value below 0, as in a photograph less its offset, counts as 0.
double amplitude_psnr(const Image& reference, const Image& image, double peak) {
  const auto amplitude = [](const Image& of, size_t i) { return std::sqrt(std::max(0.0, double(of.values[i]))); };
  const auto [image_image, image_reference] = sums_over<2>(image, [&](size_t i, auto& sums) {
    sums[0] += amplitude(image, i) * amplitude(image, i);
    sums[1] += amplitude(image, i) * amplitude(reference, i);
  });
  const double scale = image_image > 0 ? image_reference / image_image : 0;
  const auto [squares] = sums_over<1>(image, [&](size_t i, auto& sums) {
    const double difference = amplitude(reference, i) - scale * amplitude(image, i);
    sums[0] += difference * difference;
  });
  return 10 * std::log10(peak * double(image.values.size()) / squares);
}

}  // namespace

ScaledError scaled_error(const Image& reference, const Image& image) {
  require(
      reference.nx == image.nx && reference.ny == image.ny && reference.channels == image.channels,
      "expected an image of {} × {} pixels and {} channel(s), as its reference, got {} × {} and {}; resample or crop "
      "one of them",
      reference.nx, reference.ny, reference.channels, image.nx, image.ny, image.channels);
  check_finite(reference, "reference");
  check_finite(image, "image");
  const double peak = peak_of(reference);
  const auto [image_image, image_reference] = sums_over<2>(image, [&](size_t i, auto& sums) {
    const double v = image.values[i];
    sums[0] += v * v;
    sums[1] += v * double(reference.values[i]);
  });
  const double scale = image_image > 0 ? image_reference / image_image : 0;
  const double rms_error = rms_difference(reference, image, scale);
  return {scale, rms_error, 20 * std::log10(peak / rms_error)};
}

Metrics compare(const Image& reference, const Image& image, const CompareParams& params) {
  Metrics m;
  static_cast<ScaledError&>(m) = scaled_error(reference, image);
  require(params.bright > 0 && params.bright <= 1,
          "expected a bright region from a part in (0, 1] of the maximum, got {}", params.bright);
  const double peak = peak_of(reference);
  m.psnr_amplitude = amplitude_psnr(reference, image, peak);
  m.psnr_unscaled = 20 * std::log10(peak / rms_difference(reference, image, 1));
  m.ssim = structural_similarity(reference, image, m.scale, peak);
  m.ssim_unscaled = structural_similarity(reference, image, 1, peak);
  static_cast<BrightMetrics&>(m) = compare_bright(reference, image, params.bright * peak);
  const auto [image_sum, reference_sum] = sums_over<2>(image, [&](size_t i, auto& sums) {
    sums[0] += image.values[i];
    sums[1] += reference.values[i];
  });
  m.power_ratio = image_sum / reference_sum;
  return m;
}

BrightMetrics compare_bright(const Image& reference, const Image& image, double threshold) {
  double sum = 0, bright_sum = 0, ratio_sum = 0, ratio_squares = 0;
  std::vector<double> ratios;
  for (size_t i = 0; i < image.values.size(); ++i) {
    const double r = reference.values[i], v = image.values[i];
    sum += v;
    if (r < threshold) continue;
    bright_sum += v;
    ratio_sum += v / r;
    ratio_squares += v / r * (v / r);
    ratios.push_back(v / r);
  }
  const double count = double(ratios.size());
  return {.speckle_contrast = contrast(ratio_sum, ratio_squares, count),
          .bright_fraction = sum > 0 ? bright_sum / sum : 0,
          .uniformity = uniformity_of(std::move(ratios))};
}

double psnr_of_black(const Image& reference) {
  check_finite(reference, "reference");
  return 20 * std::log10(peak_of(reference) / rms_difference(reference, reference, 0));
}

double speckle_contrast(const Image& image) {
  check_finite(image, "image");
  double sum = 0, squares = 0;
  for (float v : image.values) {
    sum += v;
    squares += double(v) * v;
  }
  return contrast(sum, squares, double(image.values.size()));
}

template <class Real>
FieldMetrics compare(const BasicField<Real>& reference, const BasicField<Real>& field) {
  require(reference.grid.nx == field.grid.nx && reference.grid.ny == field.grid.ny,
          "expected a field of {} × {} samples, as its reference, got {} × {}", reference.grid.nx, reference.grid.ny,
          field.grid.nx, field.grid.ny);
  double rr = 0, ff = 0, dd = 0;
  std::complex<double> rf = 0;
  for (size_t i = 0; i < field.samples.size(); ++i) {
    const std::complex<double> r(reference.samples.values[i]), f(field.samples.values[i]);
    rr += std::norm(r);
    ff += std::norm(f);
    dd += std::norm(f - r);
    rf += std::conj(r) * f;
  }
  require(rr > 0, "expected a reference field with light in it, got one that is dark everywhere");
  FieldMetrics m;
  m.relative_error = std::sqrt(dd / rr);
  m.scale = ff > 0 ? std::conj(rf) / ff : 0;
  m.correlation = ff > 0 ? rf / std::sqrt(rr * ff) : 0;
  double residual = 0;  // summed, not computed from the correlation, which rounds errors below 1e-8 to 0
  for (size_t i = 0; i < field.samples.size(); ++i)
    residual += std::norm(m.scale * std::complex<double>(field.samples.values[i]) -
                          std::complex<double>(reference.samples.values[i]));
  m.scaled_error = std::sqrt(residual / rr);
  return m;
}

template <class Real>
double relative_error(const std::vector<BasicField<Real>>& reference, const std::vector<BasicField<Real>>& fields) {
  require(reference.size() == fields.size(), "expected a field of {} wavelength(s), as its reference, got {}",
          reference.size(), fields.size());
  double rr = 0, dd = 0;
  for (size_t n = 0; n < fields.size(); ++n) {
    const BasicField<Real>&r = reference[n], &f = fields[n];
    require(r.grid.nx == f.grid.nx && r.grid.ny == f.grid.ny,
            "expected a field of {} × {} samples, as its reference, got {} × {}", r.grid.nx, r.grid.ny, f.grid.nx,
            f.grid.ny);
    require(std::abs(f.wavelength / r.wavelength - 1) <= 1e-9,
            "expected a field at {}, as its reference, got one at {}; give both the same order of wavelengths",
            format_length(r.wavelength), format_length(f.wavelength));
    for (size_t i = 0; i < f.samples.size(); ++i) {
      const std::complex<double> u(r.samples.values[i]);
      rr += std::norm(u);
      dd += std::norm(std::complex<double>(f.samples.values[i]) - u);
    }
  }
  require(rr > 0, "expected a reference field with light in it, got one that is dark everywhere");
  return std::sqrt(dd / rr);
}

template double relative_error(const std::vector<Field>&, const std::vector<Field>&);
template double relative_error(const std::vector<FieldDouble>&, const std::vector<FieldDouble>&);
template FieldMetrics compare(const BasicField<float>&, const BasicField<float>&);
template FieldMetrics compare(const BasicField<double>&, const BasicField<double>&);

namespace {

// Weighted means over the window of a, b, a², b² and ab, and of the noise of a and its square.
using Moments = std::array<double, 7>;

std::vector<double> gaussian_window(int size) {
  constexpr double sigma = 1.5;
  std::vector<double> window(static_cast<size_t>(size));
  double sum = 0;
  for (int i = 0; i < size; ++i) {
    const double x = i - (size - 1) / 2.0;
    sum += window[size_t(i)] = std::exp(-x * x / (2 * sigma * sigma));
  }
  for (double& w : window) w /= sum;
  return window;
}

double similarity(const Moments& m, double L) {
  const double c1 = (0.01 * L) * (0.01 * L), c2 = (0.03 * L) * (0.03 * L);
  const double of_a = m[2] - m[0] * m[0], variance_b = m[3] - m[1] * m[1], covariance = m[4] - m[0] * m[1];
  const double of_noise = m[6] - m[5] * m[5];
  const double variance_a = of_noise > 0 ? std::max(0.0, of_a - of_noise) : of_a;  // the noise may be more than all
  return (2 * m[0] * m[1] + c1) * (2 * covariance + c2) /
         ((m[0] * m[0] + m[1] * m[1] + c1) * (variance_a + variance_b + c2));
}

}  // namespace

double structural_similarity(const Image& reference, const Image& image, double s, double L,
                             std::span<const float> noise) {
  const int size = std::min({11, (reference.nx - 1) / 2 * 2 + 1, (reference.ny - 1) / 2 * 2 + 1});
  const std::vector<double> window = gaussian_window(size);
  const int nx = reference.nx - size + 1, ny = reference.ny - size + 1;
  std::vector<double> row_sum(static_cast<size_t>(ny));
  // The window is separable: first down the columns of one row of windows, then along this row.
  parallel_for(0, ny, [&](int64_t j) {
    std::vector<Moments> column(static_cast<size_t>(reference.nx));
    for (int channel = 0; channel < reference.channels; ++channel) {
      for (int i = 0; i < reference.nx; ++i) {
        Moments m{};
        for (int k = 0; k < size; ++k) {
          const double a = reference(int(j) + k, i, channel), b = s * image(int(j) + k, i, channel);
          const double w = window[size_t(k)];
          const size_t at = size_t(&reference(int(j) + k, i, channel) - reference.values.data());
          const double d = noise.empty() ? 0 : noise[at];
          m[0] += w * a, m[1] += w * b, m[2] += w * a * a, m[3] += w * b * b, m[4] += w * a * b;
          m[5] += w * d, m[6] += w * d * d;
        }
        column[size_t(i)] = m;
      }
      for (int i = 0; i < nx; ++i) {
        Moments m{};
        for (int k = 0; k < size; ++k)
          for (size_t q = 0; q < m.size(); ++q) m[q] += window[size_t(k)] * column[size_t(i + k)][q];
        row_sum[size_t(j)] += similarity(m, L);
      }
    }
  });
  double sum = 0;
  for (double row : row_sum) sum += row;
  return std::min(1.0, sum / (double(nx) * ny * reference.channels));
}

}  // namespace holotrace
