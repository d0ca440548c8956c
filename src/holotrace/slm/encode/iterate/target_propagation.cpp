#include "holotrace/slm/encode/iterate/target_propagation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/slm/panel/pixel_kernel.h"
#include "holotrace/wave/propagate/adjoint.h"
#include "holotrace/wave/propagate/convolve.h"

namespace holotrace {
namespace {

std::vector<Vec2> places_of(PixelSamples samples) {
  switch (samples) {
    case PixelSamples::middle:
      return {{0, 0}};
    case PixelSamples::diagonal:
      return {{-0.25, -0.25}, {0.25, 0.25}};
    case PixelSamples::four:
      return {{-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}};
  }
  return {};
}

Grid finer(Grid grid, int subpixels) {
  grid.nx *= subpixels;
  grid.ny *= subpixels;
  grid.pitch /= subpixels;
  return grid;
}

}  // namespace

TargetPropagation::TargetPropagation(const Slm& slm, double wavelength, double z, const TargetOptics& optics)
    : shifts_(places_of(optics.samples)) {
  const Grid grid = finer(slm.grid, optics.subpixels);
  const double samples = double(shifts_.size()) * optics.subpixels * optics.subpixels;
  const double scale = std::pow(samples, -0.25);  // along each axis: T holds 1/√samples
  const auto passing = [&](double lit) {
    return [=](double f) {
      const double in_pixels = f * optics.subpixels;
      const double dimmed = optics.aperture == PixelAperture::included ? aperture_spectrum(in_pixels, lit) : 1;
      const bool is_inside = optics.stop >= 1 || in_pixels <= optics.stop / 2 * (1 + 1e-9);
      return is_inside ? scale * dimmed : 0;
    };
  };
  there_ = make_propagator<float>(grid, wavelength, z);
  if (optics.aperture == PixelAperture::included || optics.stop < 1 || samples > 1)
    filter_transfer<float>(there_, passing(slm.lit_x()), passing(slm.lit_y()));
}

std::vector<size_t> samples_of(SampleGroup group, size_t count) {
  std::vector<size_t> all(count);
  std::iota(all.begin(), all.end(), size_t(0));
  if (group == SampleGroup::all) return all;
  require(count == 4, "expected four samples per pixel for a group of them, got {}", count);
  if (group == SampleGroup::falling) return {0, 3};
  if (group == SampleGroup::rising) return {1, 2};
  return {size_t(group) - size_t(SampleGroup::first)};
}

std::vector<Vec2> TargetPropagation::shifts_of(SampleGroup group) const {
  std::vector<Vec2> shifts;
  for (const size_t sample : samples_of(group, shifts_.size())) shifts.push_back(shifts_[sample]);
  return shifts;
}

std::vector<Field> TargetPropagation::to_plane(const Field& panel, SampleGroup group) const {
  std::vector<ConvolutionLink<float>> links;
  for (const Vec2& shift : shifts_of(group)) links.push_back({&there_, false, shift.x, shift.y});
  return convolve_to_many(panel, links);
}

Field TargetPropagation::to_panel(const std::vector<Field>& plane, SampleGroup group) const {
  const std::vector<Vec2> shifts = shifts_of(group);
  std::vector<ConvolutionLink<float>> links;
  std::vector<const Field*> fields;
  for (size_t i = 0; i < plane.size(); ++i) {
    links.push_back({&there_, true, -shifts[i].x, -shifts[i].y});
    fields.push_back(&plane[i]);
  }
  return convolve_to_sum(fields, links);
}

}  // namespace holotrace
