// The parameters of every stage, from the lists in data/params/, and the known lights.

#include <nanobind/stl/vector.h>

#include "holotrace/data/depth_image.h"
#include "holotrace/data/named_light.h"
#include "holotrace/data/params/animate.h"
#include "holotrace/data/params/calibrate.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/params/eye.h"
#include "holotrace/data/params/panel_image.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/params/render.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/params/trace.h"
#include "holotrace/view/register/register.h"
#include "nouns.h"
#include "params.h"

namespace holotrace::python {

void bind_params(nb::module_& module) {
  module.def("parameters", [] {
    nb::dict stages;
    stages["trace"] = list_params(TraceParams());
    stages["render"] = list_params(RenderParams());
    stages["synthesize"] = list_params(SynthesizeParams());
    stages["encode"] = list_params(EncodeParams());
    stages["show"] = list_params(ShowParams());
    stages["propagate"] = list_params(PropagateParams());
    stages["camera"] = list_params(CameraParams());
    stages["animate"] = list_params(AnimateParams());
    stages["eye"] = list_params(EyeParams());
    stages["patterns"] = list_params(TestPatternParams());
    stages["calibrate"] = list_params(CalibrateParams());
    stages["register"] = list_params(RegisterParams());
    stages["panel_image"] = list_params(PanelImageParams());
    stages["depth_image"] = list_params(DepthImageParams());
    return stages;
  });
  module.def(
      "length", [](nb::handle value, const char* name) { return to_length(value, name); }, nb::arg("value").none(),
      nb::arg("name"));
  module.def(
      "position",
      [](nb::handle value, const char* name) {
        const Vec3 place = to_position(value, name);
        return nb::make_tuple(place.x, place.y, place.z);
      },
      nb::arg("value").none(), nb::arg("name"));
  module.def(
      "angle", [](nb::handle value, const char* name) { return to_angle(value, name); }, nb::arg("value").none(),
      nb::arg("name"));
  module.def(
      "count", [](nb::handle value, const char* name) { return to_count(value, name); }, nb::arg("value").none(),
      nb::arg("name"));
  module.def(
      "number", [](nb::handle value, const char* name) { return to_number(value, name); }, nb::arg("value").none(),
      nb::arg("name"));
  module.def(
      "text", [](nb::handle value, const char* name) { return to_text(value, name); }, nb::arg("value").none(),
      nb::arg("name"));
  module.def("light", [](const std::string& name) {
    const NamedLight& light = light_named(name);
    return nb::make_tuple(light.name, light.wavelength, light.bandwidth, light.source);
  });
  module.def("light_names", [] {
    std::vector<std::string> names;
    for (const NamedLight& light : named_lights()) names.push_back(light.name);
    return names;
  });
  module.def("wavelengths", [](nb::handle value) {
    return nb::tuple([&] {
      nb::list list;
      for (const double one : to_wavelengths(value)) list.append(one);
      return list;
    }());
  });
}

}  // namespace holotrace::python
