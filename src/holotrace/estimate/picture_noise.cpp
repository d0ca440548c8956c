#include "holotrace/estimate/picture_noise.h"

#include <cmath>

#include "holotrace/base/error.h"

namespace holotrace {

double picture_noise(const Image& a, const Image& b) {
  require(a.nx == b.nx && a.ny == b.ny && a.channels == b.channels,
          "expected two pictures of one size, got {} × {} and {} × {} pixels", a.nx, a.ny, b.nx, b.ny);
  double error = 0, light = 0;
  for (size_t i = 0; i < a.values.size(); ++i) {
    const double difference = double(a.values[i]) - b.values[i], mean = (double(a.values[i]) + b.values[i]) / 2;
    error += difference * difference / 2;
    light += mean * mean;
  }
  require(light > 0, "expected pictures with light, got dark ones");
  return std::sqrt(error / light);
}

}  // namespace holotrace
