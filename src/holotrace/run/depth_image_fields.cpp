#include "holotrace/run/depth_image_fields.h"

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/wave/layers/depth_layers.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {

using namespace literals;

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
  std::vector<Field> fields;
  for (size_t i = 0; i < wavelengths.size(); ++i)
    fields.push_back(sum_depth_image(job.image, job.panel, {wavelengths[i], has_cone ? cone : 0}, params, job.synthesis,
                                     job.frame, part_of(observer, int(i), int(wavelengths.size()))));
  return fields;
}

}  // namespace holotrace
