#include "holotrace/view/register/channel.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/threads.h"

namespace holotrace {
namespace {

// The weights for one new pixel, of the old pixels first, first + 1, …
struct Window {
  int first = 0;
  std::vector<float> weights;
};

std::vector<Window> gaussian_windows(int old_count, int new_count, double pixel, double sigma) {
  std::vector<Window> windows(static_cast<size_t>(new_count));
  for (int i = 0; i < new_count; ++i) {
    const double centre = (i - (new_count - 1) / 2.0) * pixel + (old_count - 1) / 2.0;
    const double reach = std::max(3.5 * sigma, 1.0);  // 5e-4 of the light lies beyond
    const int first = std::clamp(int(std::ceil(centre - reach)), 0, old_count - 1);
    const int last = std::clamp(int(std::floor(centre + reach)), first, old_count - 1);
    Window& window = windows[size_t(i)];
    window.first = first;
    double sum = 0;
    for (int k = first; k <= last; ++k) sum += std::exp(-(k - centre) * (k - centre) / (2 * sigma * sigma));
    for (int k = first; k <= last; ++k)
      window.weights.push_back(float(std::exp(-(k - centre) * (k - centre) / (2 * sigma * sigma)) / sum));
  }
  return windows;
}

Channel filtered(const Channel& channel, int ny, int nx, double pixel, double sigma) {
  const std::vector<Window> across = gaussian_windows(channel.nx, nx, pixel, sigma);
  const std::vector<Window> down = gaussian_windows(channel.ny, ny, pixel, sigma);
  Channel narrow(channel.ny, nx), out(ny, nx);
  parallel_for(0, channel.ny, [&](int64_t row) {
    for (int i = 0; i < nx; ++i) {
      const Window& w = across[size_t(i)];
      float sum = 0;
      for (size_t k = 0; k < w.weights.size(); ++k) sum += w.weights[k] * channel(int(row), w.first + int(k));
      narrow(int(row), i) = sum;
    }
  });
  parallel_for(0, ny, [&](int64_t row) {
    const Window& w = down[size_t(row)];
    for (size_t k = 0; k < w.weights.size(); ++k)
      for (int i = 0; i < nx; ++i) out(int(row), i) += w.weights[k] * narrow(w.first + int(k), i);
  });
  return out;
}

}  // namespace

void cubic_weights(double t, double weights[4], double slopes[4]) {
  weights[0] = ((-0.5 * t + 1) * t - 0.5) * t;
  weights[1] = (1.5 * t - 2.5) * t * t + 1;
  weights[2] = ((-1.5 * t + 2) * t + 0.5) * t;
  weights[3] = (0.5 * t - 0.5) * t * t;
  slopes[0] = (-1.5 * t + 2) * t - 0.5;
  slopes[1] = (4.5 * t - 5) * t;
  slopes[2] = (-4.5 * t + 4) * t + 0.5;
  slopes[3] = (1.5 * t - 1) * t;
}

Channel mean_of_channels(const Image& image) {
  Channel channel(image.ny, image.nx);
  const size_t channels = size_t(image.channels);
  for (size_t i = 0; i < channel.values.size(); ++i) {
    double sum = 0;
    for (size_t c = 0; c < channels; ++c) sum += image.values[i * channels + c];
    channel.values[i] = float(sum / double(channels));
  }
  return channel;
}

Channel reduced(const Channel& channel, double pixel, double blur) {
  const auto count = [&](int old_count) { return std::max(1, int(std::floor(old_count / pixel + 1e-9))); };
  return filtered(channel, count(channel.ny), count(channel.nx), pixel, blur * pixel);
}

Channel without_shading(const Channel& channel, double extent) {
  Channel out = filtered(channel, channel.ny, channel.nx, 1, extent);
  for (size_t i = 0; i < out.values.size(); ++i) out.values[i] = channel.values[i] - out.values[i];
  return out;
}

Sample sample_cubic(const Channel& channel, double column, double row) {
  const int i = int(column), j = int(row);
  double across[4], across_slope[4], down[4], down_slope[4];
  cubic_weights(column - i, across, across_slope);
  cubic_weights(row - j, down, down_slope);
  Sample s{};
  for (int y = 0; y < 4; ++y) {
    double value = 0, slope = 0;
    for (int x = 0; x < 4; ++x) {
      const double v = channel(j - 1 + y, i - 1 + x);
      value += across[x] * v;
      slope += across_slope[x] * v;
    }
    s.value += down[y] * value;
    s.slope_u += down[y] * slope;
    s.slope_v += down_slope[y] * value;
  }
  return s;
}

}  // namespace holotrace
