#include "holotrace/slm/encode/device_levels.h"

#include <fmt/format.h>

#include <complex>
#include <vector>

namespace holotrace {
namespace {

constexpr const char* place_of_sample =
#include "kernels/sample_place_kernel.h.inc"
    ;
constexpr const char* level_source =
#include "kernels/level_kernel.h.inc"
    ;
constexpr const char* interference_source =
#include "kernels/interference_kernel.h.inc"
    ;
constexpr const char* double_phase_source =
#include "kernels/double_phase_kernel.h.inc"
    ;
constexpr const char* pixel_source =
#include "kernels/pixel_levels.cl.inc"
    ;

}  // namespace

Kernel kernel_of_pixels(const char* name) {
  return {name,
          {place_of_sample, level_source, interference_source, double_phase_source, pixel_source},
          fmt::format("-D GROUP={}", samples_of_group)};
}

WaveThere send_wave(const ShownPixels<DeviceSamples>& shown, const ReferenceWave& wave, const DeviceField& band,
                    int first) {
  using Factor = std::vector<std::complex<double>>::const_iterator;
  const auto upload = [&](Factor from, int count) {
    return band.device->upload(std::vector<std::complex<float>>(from, from + count), "a reference wave");
  };
  const Grid& grid = band.head.grid;
  return {upload(wave.along_x.begin(), grid.nx), upload(wave.along_y.begin() + first, grid.ny),
          unit_for(shown.moments.largest)};
}

}  // namespace holotrace
