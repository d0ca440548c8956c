// The extension module holotrace._core: nouns and verbs of the library, for the classes and functions of the package.

#include <nanobind/nanobind.h>
#include <tbb/global_control.h>

#include <memory>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/estimate/machine/calibrate.h"
#include "holotrace/io/user_cache.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/stage_on_device.h"
#include "nouns.h"
#include "watch.h"

namespace holotrace::python {
namespace {

// The speeds of this machine are kept between runs, as the program does. Nothing is read
// or measured before it is needed.
void keep_what_was_measured() {
  const auto ignore = [](const std::string&) {};
  set_summation_rates([ignore] { return keep_summation_rates(calibration_key(), calibrate_summation, ignore); });
  set_device_rates([ignore](Device& device) {
    return keep_device_rates(
        device_calibration_key(device.info()), [&] { return calibrate_device(device); }, ignore);
  });
  set_program_store({load_kept_program, keep_program, keep_compiler_log});
}

std::unique_ptr<tbb::global_control>& thread_limit() {
  static std::unique_ptr<tbb::global_control> limit;
  return limit;
}

}  // namespace
}  // namespace holotrace::python

NB_MODULE(_core, module) {
  using namespace holotrace::python;
  nb::exception<holotrace::Error>(module, "Error", PyExc_ValueError);
  nb::class_<Watch>(module, "Watch")
      .def(nb::init<nb::object>(), nb::arg("progress").none())
      .def_prop_ro("facts", &Watch::facts)
      .def_prop_ro("curves", &Watch::curves)
      .def_prop_ro("warnings", &Watch::warnings);
  // Other libraries, such as PyTorch, may hold nouns when the interpreter ends. A test turns the reports on.
  nb::set_leak_warnings(false);
  module.def("set_leak_warnings", &nb::set_leak_warnings);
  bind_params(module);
  bind_fields(module);
  bind_holograms(module);
  bind_pictures(module);
  bind_scenes(module);
  bind_wave_verbs(module);
  bind_view_verbs(module);
  bind_encode_verbs(module);
  bind_run_verbs(module);
  bind_estimate_verbs(module);
  bind_gradients(module);
  module.def("set_threads", [](int count) {
    thread_limit().reset();
    if (count > 0)
      thread_limit() =
          std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, size_t(count));
  });
  module.attr("__version__") = HOLOTRACE_VERSION;
  keep_what_was_measured();
}
