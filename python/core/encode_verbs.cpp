// The verb encode.

#include <nanobind/stl/vector.h>

#include "holotrace/io/picture/image_file.h"
#include "holotrace/run/encode_job.h"
#include "holotrace/slm/encode/target.h"
#include "nouns.h"
#include "params.h"
#include "watch.h"

namespace holotrace::python {
namespace {

EncodeParams encode_params(const nb::dict& given, Encoding method = Encoding::phase) {
  EncodeParams params;
  set_params(given, params);
  params.method = method_or(params.method, method);
  return params;
}

// The stages report to the watch; its facts are those of the last one.
template <class MakeJob>
std::vector<Hologram> encode_with(const EncodeParams& params, const Slm& slm, int frames, Watch& watch,
                                  const std::vector<Hologram>& last, const MakeJob& make_job) {
  return watch.run("encode", [&](const Observer& observer) {
    Report report;
    EncodeJob job = make_job(observer);
    job.last = last;
    return encode_job(job, frames, slm, params, report,
                      [&](const std::string& stage) { return watch.observer(stage); });
  });
}

std::vector<Hologram> encode_fields(const std::vector<Field>& fields, const Slm* panel,
                                    const std::vector<Hologram>& last, const nb::dict& given, Watch& watch) {
  const EncodeParams params = encode_params(given);
  require(!fields.empty(), "expected one field or more to encode, got none");
  const Slm slm = panel ? *panel : panel_for(fields.front().grid, params.method);
  std::vector<Hologram> holograms =
      encode_with(params, slm, 1, watch, last, [&](const Observer&) { return job_of_fields(fields, params); });
  if (!panel)
    for (Hologram& hologram : holograms) hologram.slm.reset();  // the panel was made up from the field's grid
  return holograms;
}

std::vector<Hologram> encode_picture(const Image& picture, const Slm& slm, nb::handle wavelengths,
                                     const std::vector<Hologram>& last, const nb::dict& given, Watch& watch) {
  const EncodeParams params = encode_params(given, Encoding::sgd);
  const std::vector<double> colours = to_wavelengths(wavelengths);
  return encode_with(params, slm, 1, watch, last, [&](const Observer& observer) {
    if (!params.resample) return job_of_picture(picture, slm, colours, params, observer);
    const TargetSize size = size_of_shape(target_size(slm.grid, params), picture.nx, picture.ny);
    EncodeParams of_size = params;
    of_size.target_columns = size.columns;
    of_size.target_rows = size.rows;
    return job_of_picture(resample_image(picture, size.columns, size.rows), slm, colours, of_size, observer);
  });
}

std::vector<Hologram> encode_stack(const FocalStack& stack, const Slm& slm, nb::handle wavelengths, int frames,
                                   const std::vector<Hologram>& last, const nb::dict& given, Watch& watch) {
  const EncodeParams params = encode_params(given, Encoding::sgd);
  const std::vector<double> colours = to_wavelengths(wavelengths);
  check_named(frames, range::at_least(1), Quantity::count, "frames");
  return encode_with(params, slm, frames, watch, last,
                     [&](const Observer&) { return job_of_stack(stack, slm, colours, params); });
}

std::vector<Hologram> encode_light_field(const LightField& light, const Slm& slm, nb::handle wavelengths, int frames,
                                         const std::vector<Hologram>& last, const nb::dict& given, Watch& watch) {
  const EncodeParams params = encode_params(given, Encoding::sgd);
  const std::vector<double> colours = to_wavelengths(wavelengths);
  check_named(frames, range::at_least(1), Quantity::count, "frames");
  return encode_with(params, slm, frames, watch, last, [&](const Observer& observer) {
    return job_of_light_field(light, slm, colours, params, frames, observer);
  });
}

}  // namespace

void bind_encode_verbs(nb::module_& module) {
  module.def("encode_fields", &encode_fields, nb::arg("fields"), nb::arg("slm").none(), nb::arg("last"),
             nb::arg("params"), nb::arg("watch"));
  module.def("encode_picture", &encode_picture);
  module.def("encode_stack", &encode_stack);
  module.def("encode_light_field", &encode_light_field);
}

}  // namespace holotrace::python
