// Verbs of waves: propagate, synthesize, encode, show, expose.

#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "holotrace/io/picture/depth_image_file.h"
#include "holotrace/run/depth_image_fields.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/synthesize.h"
#include "nouns.h"
#include "params.h"
#include "watch.h"

namespace holotrace::python {
namespace {

template <class Real>
BasicField<Real> propagate_field(const BasicField<Real>& field, nb::handle distance, const nb::dict& given,
                                 Watch& watch) {
  const double metres = to_length(distance, "distance");
  PropagateParams params;
  set_params(given, params);
  return watch.run("propagate", [&](const Observer& observer) { return propagate(field, metres, params, observer); });
}

Field synthesize_sources(const Sources& sources, const Slm& panel, const nb::dict& given, Watch& watch) {
  SynthesizeParams params;
  set_params(given, params);
  return watch.run("synthesize",
                   [&](const Observer& observer) { return synthesize(sources, panel.grid, params, observer); });
}

// The picture is of linear light, with depths in metres.
std::vector<Field> sum_depths(const DepthImage& image, const Slm& panel, nb::handle wavelengths, const nb::dict& stages,
                              uint32_t frame, Watch& watch) {
  DepthImageJob job{image, panel.grid, to_wavelengths(wavelengths), {}, {}, frame};
  set_params(nb::cast<nb::dict>(stages["depth_image"]), job.params);
  set_params(nb::cast<nb::dict>(stages["synthesize"]), job.synthesis);
  return watch.run("synthesize", [&](const Observer& observer) { return depth_image_fields(job, observer); });
}

DepthImage make_depth_image(const Image& picture, const In2<float>& depth) {
  DepthImage image{picture, to_array(depth, "depths")};
  leave_out_empty_pixels(image);
  check_depth_image(image);
  return image;
}

Field show_hologram(const Hologram& hologram, const Slm& panel, const nb::dict& given, Watch& watch) {
  ShowParams params;
  set_params(given, params);
  return watch.run("show", [&](const Observer& observer) { return show(hologram, panel, params, observer); });
}

Image expose_field(const Field& shown, const Slm& panel, nb::handle distance, const nb::dict& given,
                   const nb::dict& propagation, Watch& watch) {
  const double metres = to_length(distance, "distance");
  CameraParams params;
  set_params(given, params);
  PropagateParams path;
  set_params(propagation, path);
  return watch.run("expose",
                   [&](const Observer& observer) { return look(shown, panel, metres, path, params, observer); });
}

}  // namespace

void bind_wave_verbs(nb::module_& module) {
  module.def("propagate", &propagate_field<float>, nb::arg("field"), nb::arg("distance").none(), nb::arg("params"),
             nb::arg("watch"));
  module.def("propagate", &propagate_field<double>, nb::arg("field"), nb::arg("distance").none(), nb::arg("params"),
             nb::arg("watch"));
  module.def("synthesize", &synthesize_sources);
  nb::class_<DepthImage> depth_image(module, "DepthImage");
  bind_bytes<DepthImage>(depth_image);
  depth_image.def_static("make", &make_depth_image);
  depth_image.def_static("load", [](const std::string& picture, const std::string& depth, nb::handle near,
                                    nb::handle far, const std::string& scale) {
    DepthImageParams params;
    nb::dict given;
    given["depth_scale"] = scale;
    set_params(given, params);
    const double white = to_length(near, "near"), black = to_length(far, "far");
    const nb::gil_scoped_release release;
    return load_depth_image(picture, depth, white, black, params.scale);
  });
  depth_image.def_prop_ro("picture", [](const DepthImage& i) { return i.picture; });
  depth_image.def_prop_ro("depth", [](nb::handle self) { return view(self, nb::cast<DepthImage&>(self).depth); });
  module.def("depth_image_fields", &sum_depths, nb::arg("image"), nb::arg("slm"), nb::arg("wavelengths").none(),
             nb::arg("stages"), nb::arg("frame"), nb::arg("watch"));
  module.def("show", &show_hologram);
  module.def("expose", &expose_field, nb::arg("field"), nb::arg("slm"), nb::arg("distance").none(), nb::arg("params"),
             nb::arg("propagate"), nb::arg("watch"));
}

}  // namespace holotrace::python
