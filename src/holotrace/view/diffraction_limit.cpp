#include "holotrace/view/diffraction_limit.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/frequency.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"

namespace holotrace {

namespace {

/// H at the frequencies of 2·count samples, repeated with the period 1/pitch, and 1 at frequency 0.
/// @param cutoff  c [1/m]
std::vector<double> transfer(int count, double pitch, double cutoff) {
  const auto value = [&](double cycles) {  // per pixel
    const double limit = cutoff * pitch;
    double sum = 0;
    for (int repeat = -int(std::ceil(limit)) - 1; repeat <= int(std::ceil(limit)) + 1; ++repeat)
      sum += std::max(0.0, 1 - std::abs(cycles + repeat) / limit);
    return sum;
  };
  std::vector<double> factors;
  for (int k = 0; k < 2 * count; ++k) factors.push_back(value(double(k) / (2 * count)) / value(0));
  return factors;
}

/// A line of one channel of an image: values[start + i·stride].
struct Line {
  size_t start, stride;
};

/// Filters two lines at once, as real and imaginary part, each followed by its reflection: the filter is even and real.
void filter_two(std::vector<float>& values, const Line& a, const Line& b, const std::vector<double>& factors,
                std::vector<std::complex<double>>& buffer) {
  const size_t length = factors.size(), count = length / 2;
  for (size_t i = 0; i < count; ++i) {
    buffer[i] = {values[a.start + i * a.stride], values[b.start + i * b.stride]};
    buffer[length - 1 - i] = buffer[i];
  }
  Fft<double>(int(length), FftDirection::forward)(buffer.data());
  for (size_t k = 0; k < length; ++k) buffer[k] *= factors[k] / double(length);
  Fft<double>(int(length), FftDirection::backward)(buffer.data());
  for (size_t i = 0; i < count; ++i) {  // rounding can give a black pixel a value just below 0
    values[a.start + i * a.stride] = float(std::max(0.0, buffer[i].real()));
    values[b.start + i * b.stride] = float(std::max(0.0, buffer[i].imag()));
  }
}

void filter_lines(std::vector<float>& values, const std::vector<Line>& lines, const std::vector<double>& factors) {
  const auto work = [&](int64_t pair) {
    const size_t first = 2 * size_t(pair), second = std::min(first + 1, lines.size() - 1);
    std::vector<std::complex<double>> buffer(factors.size());
    filter_two(values, lines[first], lines[second], factors, buffer);
  };
  parallel_for(0, int64_t(lines.size() + 1) / 2, work, {}, 16);
}

}  // namespace

void limit_to_panel(FocalStack& stack, const Grid& panel, double wavelength) {
  check_grid(panel);
  check_focal_stack(stack);
  check_wavelength(wavelength);
  const double pitch = stack.grid.pitch;
  for (size_t k = 0; k < stack.pictures.size(); ++k) {
    Image& picture = stack.pictures[k];
    const auto cutoff = [&](double side) {
      return std::min(side / (wavelength * stack.distances[k]), 1 / panel.pitch);
    };
    const size_t channels = size_t(picture.channels), width = size_t(picture.nx) * channels;
    std::vector<Line> rows, columns;
    for (size_t row = 0; row < size_t(picture.ny); ++row)
      for (size_t channel = 0; channel < channels; ++channel) rows.push_back({row * width + channel, channels});
    for (size_t column = 0; column < width; ++column) columns.push_back({column, width});
    filter_lines(picture.values, rows, transfer(picture.nx, pitch, cutoff(panel.width())));
    filter_lines(picture.values, columns, transfer(picture.ny, pitch, cutoff(panel.height())));
  }
}

void limit_to_pupil(Image& picture, double pitch, double wavelength, double distance, double diameter) {
  check_wavelength(wavelength);
  require(picture.channels >= 1 && picture.nx > 0 && picture.ny > 0, "expected a picture with pixels");
  require(pitch > 0 && distance > 0 && diameter > 0,
          "expected a pitch, a distance and a diameter of a pupil above 0 m, got {}, {} and {} m", pitch, distance,
          diameter);
  const double cutoff = diameter / (wavelength * distance) * pitch;  // [cycles per pixel]
  // Beyond three Airy radii hardly any light is left; edges are continued by reflection that far.
  const auto rim = [&](int count) { return std::min(count, int(std::ceil(3 * 1.22 / cutoff))); };
  const auto length = [&](int count) { return fft_good_length(count + 2 * rim(count)); };
  const int left = rim(picture.nx), top = rim(picture.ny), nx = length(picture.nx), ny = length(picture.ny);
  const auto reflected = [](int i, int count) {
    const int inside = ((i % (2 * count)) + 2 * count) % (2 * count);
    return inside < count ? inside : 2 * count - 1 - inside;
  };
  Array2D<std::complex<float>> wide(ny, nx);
  for (int c = 0; c < picture.channels; ++c) {
    parallel_for(0, ny, [&](int64_t j) {
      for (int i = 0; i < nx; ++i)
        wide(int(j), i) = picture(reflected(int(j) - top, picture.ny), reflected(i - left, picture.nx), c);
    });
    fft_2d(wide.values.data(), ny, nx, FftDirection::forward);
    parallel_for(0, ny, [&](int64_t j) {
      const double v = std::abs(double(signed_frequency(int(j), ny))) / ny;
      for (int i = 0; i < nx; ++i) {
        const double u = std::hypot(double(signed_frequency(i, nx)) / nx, v) / cutoff;
        const double h = u < 1 ? 2 / pi * (std::acos(u) - u * std::sqrt((1 - u) * (1 + u))) : 0;
        wide(int(j), i) *= float(h / (double(nx) * ny));
      }
    });
    fft_2d(wide.values.data(), ny, nx, FftDirection::backward);
    for (int j = 0; j < picture.ny; ++j)
      for (int i = 0; i < picture.nx; ++i) picture(j, i, c) = std::max(0.0F, wide(top + j, left + i).real());
  }
}

}  // namespace holotrace
