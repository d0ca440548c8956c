#include "holotrace/run/depth_image_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/wave/layers/depth_layers.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {

using namespace literals;

namespace {

void warn_of_depths(const DepthImage& image, const Observer& observer) {
  const Image& picture = image.picture;
  size_t lit = 0, lost = 0;
  double nearest = HUGE_VAL;
  for (size_t i = 0; i < std::min(image.depth.size(), picture.values.size() / size_t(picture.channels)); ++i) {
    const double depth = double(image.depth.values[i]);
    if (depth != 0) nearest = std::min(nearest, std::abs(depth));
    const auto* values = picture.values.data() + i * size_t(picture.channels);
    const bool is_lit = std::any_of(values, values + picture.channels, [](float value) { return value > 0; });
    lit += is_lit;
    lost += is_lit && depth == 0;
  }
  if (lost > 0)
    observer.warn(fmt::format(
        "{} of {} pixels with light have no depth and are left out; give them one, or make them black", lost, lit));
  constexpr double far = 10;  // [m]: no panel shows differences of depth there
  if (nearest > far && nearest < HUGE_VAL)
    observer.warn(fmt::format(
        "the nearest depth is {}, where the panel shows no depth; if the file has millimetres, divide its values "
        "by 1000",
        format_length(nearest)));
}

}  // namespace

std::vector<Field> depth_image_fields(const DepthImageJob& job, const Observer& observer) {
  require(job.synthesis.method == SynthesisMethod::automatic || job.synthesis.method == SynthesisMethod::layers,
          "expected the method layers for a picture with depths, got {}; leave it out",
          method_name(job.synthesis.method));
  const std::vector<double> wavelengths = job.wavelengths.empty() ? std::vector{532_nm} : job.wavelengths;
  DepthImageParams params = job.params;
  const double cone = view_wavelength(wavelengths, params.has_common_cone);
  if (params.projection == Projection::perspective && params.field_of_view == 0 && wavelengths.size() > 1)
    params.field_of_view = std::asin(acceptance_sine(cone, job.panel.pitch));
  const bool has_cone = params.has_common_cone && wavelengths.size() > 1;
  warn_of_depths(job.image, observer);
  std::vector<Field> fields;
  for (size_t i = 0; i < wavelengths.size(); ++i)
    fields.push_back(sum_depth_image(job.image, job.panel, {wavelengths[i], has_cone ? cone : 0}, params, job.synthesis,
                                     job.frame, part_of(observer, int(i), int(wavelengths.size()))));
  return fields;
}

}  // namespace holotrace
