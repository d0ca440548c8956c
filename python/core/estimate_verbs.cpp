// The verbs compare, limits, estimate and calibrate. Tables of figures go to Python as JSON.

#include <nanobind/stl/complex.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>

#include "holotrace/calibrate/fit_panel.h"
#include "holotrace/calibrate/patterns.h"
#include "holotrace/estimate/limits.h"
#include "holotrace/io/calibration/calibration_files.h"
#include "holotrace/run/estimate/job_estimate.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/compare.h"
#include "holotrace/view/register/register.h"
#include "nouns.h"
#include "params.h"
#include "watch.h"

namespace holotrace::python {
namespace {

nb::dict compare_images(const Image& reference, const Image& image) {
  Metrics m;
  {
    const nb::gil_scoped_release release;
    const bool are_alike = reference.channels == image.channels;
    m = are_alike ? compare(reference, image) : compare(luminance_of(reference), luminance_of(image));
  }
  nb::dict metrics;
  metrics["psnr"] = m.psnr;
  metrics["psnr_unscaled"] = m.psnr_unscaled;
  metrics["psnr_amplitude"] = m.psnr_amplitude;
  metrics["ssim"] = m.ssim;
  metrics["ssim_unscaled"] = m.ssim_unscaled;
  metrics["scale"] = m.scale;
  metrics["rms_error"] = m.rms_error;
  metrics["speckle_contrast"] = m.speckle_contrast;
  metrics["bright_fraction"] = m.bright_fraction;
  metrics["power_ratio"] = m.power_ratio;
  metrics["uniformity"] = m.uniformity;
  return metrics;
}

nb::dict compare_fields(const FieldDouble& reference, const FieldDouble& field) {
  FieldMetrics m;
  {
    const nb::gil_scoped_release release;
    m = compare(reference, field);
  }
  nb::dict metrics;
  metrics["relative_error"] = m.relative_error;
  metrics["scaled_error"] = m.scaled_error;
  metrics["scale"] = m.scale;
  metrics["correlation"] = m.correlation;
  return metrics;
}

// The photograph on the simulation's pixels; the figures are those of `holotrace compare --register`.
nb::tuple register_photograph(Image photograph, Image simulation, const nb::dict& given, Watch& watch) {
  RegisterParams params;
  set_params(given, params);
  Registration pose;
  AlignedImage aligned = watch.run("register", [&](const Observer& observer) {
    if (photograph.channels != simulation.channels) {
      photograph = luminance_of(photograph);
      simulation = luminance_of(simulation);
    }
    pose = register_image(photograph, simulation, params, observer);
    AlignedImage image = align_image(photograph, pose, simulation.ny, simulation.nx);
    image.image.pitch = simulation.pitch;
    return image;
  });
  const PixelRectangle& covered = aligned.covered;
  nb::dict figures = compare_images(cropped(simulation, covered), cropped(aligned.image, covered));
  figures["magnification"] = pose.scale;
  figures["rotation"] = pose.rotation;
  figures["shift_x_pixels"] = pose.shift_x;
  figures["shift_y_pixels"] = pose.shift_y;
  figures["gain"] = pose.gain;
  figures["offset"] = pose.offset;
  figures["place_error_pixels"] = pose.uncertainty;
  figures["correlation"] = pose.correlation;
  figures["overlap"] = pose.overlap;
  figures["residual"] = pose.residual;
  figures["compared_columns"] = covered.columns;
  figures["compared_rows"] = covered.rows;
  figures["compared_first_column"] = covered.first_column;
  figures["compared_first_row"] = covered.first_row;
  return nb::make_tuple(nb::cast(std::move(aligned.image)), figures);
}

std::string limits_of(const Slm& slm, nb::handle wavelengths, nb::handle distance, const Job* scene) {
  LimitsQuestion question;
  question.slm = slm;
  question.wavelengths = to_wavelengths(wavelengths);
  question.distance = to_length(distance, "distance");
  check_named(question.distance, range::positive, Quantity::length, "distance");
  if (scene) question.points = points_of(scene->scene);
  return limits_json(question).dump();
}

std::string estimate_cost_of(const Job& job, double frames_per_second, Watch& watch) {
  check_named(frames_per_second, range::positive, Quantity::number, "frames_per_second");
  return watch.run("estimate",
                   [&](const Observer&) { return cost_json(answer_about_cost(job, frames_per_second, false)).dump(); });
}

CalibrationPlan make_plan(const Slm& slm, nb::handle wavelength, nb::handle distance, const nb::dict& given) {
  TestPatternParams params;
  set_params(given, params);
  const double metres = to_length(distance, "distance"), colour = to_wavelength(wavelength);
  check_named(metres, range::positive, Quantity::length, "distance");
  const nb::gil_scoped_release release;
  return {metres, make_test_patterns(slm, colour, metres, params)};
}

nb::tuple calibrate(const CalibrationPlan& plan, const std::vector<Image>& photographs, const nb::dict& given,
                    Watch& watch) {
  CalibrateParams params;
  set_params(given, params);
  PanelFit fit =
      watch.run("calibrate", [&](const Observer& observer) { return fit_panel(plan, photographs, params, observer); });
  const std::string figures = fit_json(fit).dump();
  return nb::make_tuple(nb::cast(std::move(fit.slm)), figures);
}

}  // namespace

void bind_estimate_verbs(nb::module_& module) {
  nb::class_<CalibrationPlan> plan(module, "CalibrationPlan");
  bind_bytes<CalibrationPlan>(plan);
  plan.def_static("make", &make_plan, nb::arg("slm"), nb::arg("wavelength").none(), nb::arg("distance").none(),
                  nb::arg("params"));
  plan.def_static("load", &load_plan);
  plan.def_ro("distance", &CalibrationPlan::distance);
  plan.def_prop_ro("names", [](const CalibrationPlan& p) {
    std::vector<std::string> names;
    for (const TestPattern& pattern : p.patterns) names.push_back(pattern.name);
    return names;
  });
  plan.def_prop_ro("holograms", [](const CalibrationPlan& p) {
    std::vector<Hologram> holograms;
    for (const TestPattern& pattern : p.patterns) holograms.push_back(pattern.hologram);
    return holograms;
  });
  plan.def("save", [](const CalibrationPlan& p, const std::string& folder) {
    const nb::gil_scoped_release release;
    save_plan(folder, p);
  });
  plan.def("photographs", [](const CalibrationPlan& p, const std::string& folder) {
    const nb::gil_scoped_release release;
    return load_photographs(folder, p);
  });
  module.def("compare_images", &compare_images);
  module.def("compare_fields", &compare_fields);
  module.def("register_image", &register_photograph);
  module.def("limits", &limits_of, nb::arg("slm"), nb::arg("wavelengths").none(), nb::arg("distance").none(),
             nb::arg("scene").none());
  module.def("estimate", &estimate_cost_of);
  module.def("calibrate", &calibrate);
  module.def("save_panel", [](const Slm& slm, const std::string& path) {
    const nb::gil_scoped_release release;
    save_panel(path, slm);
  });
}

}  // namespace holotrace::python
