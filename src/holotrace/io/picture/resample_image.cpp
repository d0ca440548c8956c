#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/io/picture/image_file.h"

namespace holotrace {
namespace {

// The samples of a line from which one sample of the new line is made.
struct Taps {
  std::vector<int> places;
  std::vector<double> weights;  // their sum is 1
};

// Triangles whose half width is the distance between new samples, or between old ones where that is larger. Beyond its
// ends the line goes on as it ends.
std::vector<Taps> taps_of(int from, int to) {
  const double step = double(from) / to, reach = std::max(1.0, step);
  std::vector<Taps> all(static_cast<size_t>(to));
  for (int k = 0; k < to; ++k) {
    Taps& taps = all[size_t(k)];
    const double centre = (k + 0.5) * step - 0.5;
    double sum = 0;
    for (int i = int(std::ceil(centre - reach)); i <= int(std::floor(centre + reach)); ++i) {
      const double weight = 1 - std::abs(i - centre) / reach;
      if (weight <= 0) continue;
      taps.places.push_back(std::clamp(i, 0, from - 1));
      taps.weights.push_back(weight);
      sum += weight;
    }
    for (double& weight : taps.weights) weight /= sum;
  }
  return all;
}

}  // namespace

Image resample_image(const Image& image, int columns, int rows) {
  require(image.nx > 0 && image.ny > 0 && columns > 0 && rows > 0,
          "expected pictures with pixels to resample, got {} × {} and {} × {}", image.nx, image.ny, columns, rows);
  const std::vector<Taps> across = taps_of(image.nx, columns), down = taps_of(image.ny, rows);
  const auto channels = size_t(image.channels), old_row = size_t(image.nx) * channels;
  Image out(rows, columns, image.channels);
  parallel_for(0, rows, [&](int64_t j) {
    std::vector<double> line(old_row);
    const Taps& lines = down[size_t(j)];
    for (size_t t = 0; t < lines.places.size(); ++t) {
      const float* from = image.values.data() + size_t(lines.places[t]) * old_row;
      for (size_t i = 0; i < old_row; ++i) line[i] += lines.weights[t] * double(from[i]);
    }
    float* to = &out(int(j), 0);
    for (const Taps& taps : across)
      for (size_t c = 0; c < channels; ++c) {
        double sum = 0;
        for (size_t t = 0; t < taps.places.size(); ++t)
          sum += taps.weights[t] * line[size_t(taps.places[t]) * channels + c];
        *to++ = float(sum);
      }
  });
  return out;
}

}  // namespace holotrace
