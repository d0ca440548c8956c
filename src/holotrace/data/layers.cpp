#include "holotrace/data/layers.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

void check_slice(const Slice& slice, size_t index, const Layers& layers) {
  const Field& light = slice.light;
  check_grid(light.grid);
  require(std::isfinite(light.z), "expected slice {} at a finite place, got z = {} m", index, light.z);
  require(light.wavelength == layers.wavelength && light.grid.pitch == layers.slices.front().light.grid.pitch,
          "expected slices of one wavelength and pitch, {} and {}, got {} and {} in slice {}",
          format_length(layers.wavelength), format_length(layers.slices.front().light.grid.pitch),
          format_length(light.wavelength), format_length(light.grid.pitch), index);
  require(light.samples.nx == light.grid.nx && light.samples.ny == light.grid.ny,
          "expected {} × {} samples in slice {}, got {} × {}", light.grid.nx, light.grid.ny, index, light.samples.nx,
          light.samples.ny);
  require(slice.mask.size() == 0 || (slice.mask.nx == light.grid.nx && slice.mask.ny == light.grid.ny),
          "expected a mask of {} × {} samples in slice {}, or none, got {} × {}", light.grid.nx, light.grid.ny, index,
          slice.mask.nx, slice.mask.ny);
  for (const std::complex<float>& u : light.samples.values)
    require(std::isfinite(u.real()) && std::isfinite(u.imag()), "expected finite samples in slice {}, got {} + {}i",
            index, u.real(), u.imag());
  for (const float m : slice.mask.values)
    require(m >= 0 && m <= 1, "expected a mask in [0, 1] in slice {}, got {}", index, m);
}

}  // namespace

void check_layers(const Layers& layers) {
  check_wavelength(layers.wavelength);
  require(!layers.slices.empty(), "expected at least one slice, got none");
  for (size_t i = 0; i < layers.slices.size(); ++i) {
    check_slice(layers.slices[i], i, layers);
    require(i == 0 || layers.slices[i].depth() <= layers.slices[i - 1].depth(),
            "expected slices from far to near, got slice {} at {} after one at {}", i,
            format_length(layers.slices[i].depth()), i == 0 ? "" : format_length(layers.slices[i - 1].depth()));
  }
}

}  // namespace holotrace
