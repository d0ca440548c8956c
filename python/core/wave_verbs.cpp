// Verbs of waves: propagate, synthesize, encode, show, expose.

#include <nanobind/stl/vector.h>

#include "holotrace/io/field/hologram_file.h"
#include "holotrace/slm/encode/encode.h"
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
  return watch.run("propagate", [&](const Observer& observer) {
    BasicField<Real> moved = propagate(field, metres, params, observer);
    moved.name = field.name;
    moved.frame = field.frame;
    moved.cone_wavelength = field.cone_wavelength;
    return moved;
  });
}

Field synthesize_sources(const Sources& sources, const Slm& panel, const nb::dict& given, Watch& watch) {
  SynthesizeParams params;
  set_params(given, params);
  return watch.run("synthesize",
                   [&](const Observer& observer) { return synthesize(sources, panel.grid, params, observer); });
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
  module.def("show", &show_hologram);
  module.def("expose", &expose_field, nb::arg("field"), nb::arg("slm"), nb::arg("distance").none(), nb::arg("params"),
             nb::arg("propagate"), nb::arg("watch"));
}

}  // namespace holotrace::python
