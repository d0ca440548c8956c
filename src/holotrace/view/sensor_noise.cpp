#include "holotrace/view/sensor_noise.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/data/params/check_ranges.h"

namespace holotrace {
namespace {

// Random bits from a CounterRandom, with the interface that the standard library's distributions need.
struct Bits {
  using result_type = uint32_t;
  static constexpr uint32_t min() { return 0; }
  static constexpr uint32_t max() { return 0xffffffffu; }
  uint32_t operator()() { return uint32_t(random.uniform() * 0x1p32); }

  CounterRandom random;
};

}  // namespace

void check_sensor(const CameraParams& camera) {
  check_ranges(camera);
  require(camera.read_noise == 0 || camera.electrons > 0,
          "expected electrons above 0 with a read noise of {} electrons, got 0; set electrons", camera.read_noise);
}

Image add_sensor_noise(const Image& view, double white, const CameraParams& camera, uint32_t exposure) {
  check_sensor(camera);
  if (camera.electrons == 0) return view;
  require(std::isfinite(white) && white > 0, "expected a white above 0 W/m², got {} W/m²", white);
  Image reading = view;
  const size_t row = size_t(view.nx) * size_t(view.channels);
  parallel_for(0, view.ny, [&](int64_t j) {
    for (size_t i = size_t(j) * row; i < size_t(j + 1) * row; ++i) {
      Bits bits{CounterRandom(uint64_t(camera.noise_seed), exposure, i)};
      const double mean = std::max(0.0, camera.electrons * double(view.values[i]) / white);
      double electrons = mean > 0 ? double(std::poisson_distribution<int64_t>(mean)(bits)) : 0;
      if (camera.read_noise > 0) electrons += std::normal_distribution<double>(0, camera.read_noise)(bits);
      reading.values[i] = float(std::clamp(electrons, 0.0, camera.electrons) / camera.electrons * white);
    }
  });
  return reading;
}

}  // namespace holotrace
