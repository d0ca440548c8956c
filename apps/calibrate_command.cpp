// holotrace calibrate: test patterns for a panel, and the panel that their photographs show.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/calibrate/fit_panel.h"
#include "holotrace/calibrate/patterns.h"
#include "holotrace/data/chart.h"
#include "holotrace/io/calibration/calibration_files.h"
#include "holotrace/io/files/output.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/io/picture/chart_file.h"

namespace holotrace {
namespace {

/// The phase of each level: assumed, measured with its standard errors, and as written to the panel file.
Chart curve_chart(const PanelFit& fit) {
  Chart chart{"Phase of each level", "level", "phase [rad]", {}, false, false, false, {}};
  Series curve{"fitted curve", {}, {}}, measured{"measured levels", {}, {}, true, false},
      assumed{"assumed before", {}, {}};
  assumed.is_dashed = true;
  const std::vector<CalibrationPoint>& points = fit.slm.effects.calibration;
  for (size_t level = 0; level < points.size(); ++level) {
    curve.x.push_back(double(level));
    curve.y.push_back(points[level].phase);
  }
  std::vector<Series> bars;
  for (const MeasuredLevel& level : fit.levels) {
    measured.x.push_back(level.level);
    measured.y.push_back(level.phase.value);
    assumed.x.push_back(level.level);
    assumed.y.push_back(level.assumed_phase);
    Series bar{"",
               {double(level.level), double(level.level)},
               {level.phase.value - level.phase.error, level.phase.value + level.phase.error}};
    bar.colour = 1;
    bars.push_back(bar);
  }
  chart.series = {curve, measured, assumed};
  chart.series.insert(chart.series.end(), bars.begin(), bars.end());
  return chart;
}

/// The rms difference between each photograph and its simulation.
Chart residual_chart(const PanelFit& fit) {
  Chart chart{"Photographs against the fitted panel",
              "photograph",
              "rms difference, of the mean light",
              {},
              false,
              false,
              false,
              {}};
  Series rms{"", {}, {}, true, false};
  for (size_t n = 0; n < fit.photographs.size(); ++n) {
    rms.x.push_back(double(n + 1));
    rms.y.push_back(fit.photographs[n].residual);
  }
  chart.series = {rms};
  return chart;
}

struct PatternOptions {
  std::string slm = "pluto", wavelength, distance = "300 mm", output;
  Flags flags;
};

struct FitOptions {
  std::string plan, photographs, output, name;
  bool is_json = false;
  Flags flags;
};

void write_patterns(const PatternOptions& o) {
  TestPatternParams params;
  o.flags.apply(params);
  const double distance = parse_length_flag("--distance", o.distance, range::positive);
  const Slm slm = load_slm(o.slm);
  const double wavelength = o.wavelength.empty() ? usual_wavelength(slm) : parse_wavelength_flag(o.wavelength);
  CalibrationPlan plan{distance, make_test_patterns(slm, wavelength, distance, params)};
  const double least = slm.grid.pitch * std::max(slm.grid.width(), slm.grid.height()) / wavelength;
  if (distance < least)
    say_warnings({fmt::format("higher orders overlap with the picture of order 0 at {}; from {} on they lie beside it",
                              format_length(distance), format_length(least))});
  say_warnings(save_plan(o.output, plan));
  fmt::print("{} patterns and {}\n", plan.patterns.size(), plan_path(o.output));
}

void print_table(const PanelFit& fit) {
  fmt::print("{:<12} {:>10} {:>10} {:>10} {:>10}\n", "level", "phase", "+-", "assumed", "amplitude");
  for (const MeasuredLevel& level : fit.levels)
    fmt::print("{:<12} {:>6.4f} rad {:>10.4f} {:>10.4f} {:>10.4f}\n", level.level, level.phase.value, level.phase.error,
               level.assumed_phase, level.amplitude);
  fmt::print("\n{:<26} {:.4f} +- {:.4f} pixels\n", "crosstalk", fit.crosstalk.value, fit.crosstalk.error);
  fmt::print("{:<26} {:.4f} +- {:.4f} of the lit pixels' light, phase {:.3f} +- {:.3f} rad\n",
             "gaps, amplitude in order 0", fit.gap_light.value, fit.gap_light.error, fit.gap_phase.value,
             fit.gap_phase.error);
  for (const MeasuredTerm& term : fit.aberration)
    fmt::print("{:<26} {:.4f} +- {:.4f} rad rms\n", fmt::format("Zernike n = {}, m = {}", term.n, term.m),
               term.rms.value, term.rms.error);
  fmt::print("{:<26} {:.3f} to {:.3f} of its mean\n", "irradiance", fit.least_light, fit.most_light);
  fmt::print("{:<26} {:.4f} pixels per pixel of the panel, turned by {:.3f} deg, blur of variance {:.3f} pixels2\n",
             "camera", fit.camera_scale, fit.camera_rotation * 180 / pi, fit.camera_blur.value);
  fmt::print("\n{:<16} {:>12} {:>10}\n", "photograph", "correlation", "residual");
  for (const PhotographFit& p : fit.photographs)
    fmt::print("{:<16} {:>12.4f} {:>10.4f}\n", p.name, p.correlation, p.residual);
}

void fit_photographs(const FitOptions& o, const GlobalFlags& global) {
  CalibrateParams params;
  o.flags.apply(params);
  check_output(o.output, {".toml"});
  const CalibrationPlan plan = load_plan(o.plan);
  const std::vector<Image> photographs = load_photographs(o.photographs, plan);
  Console console(global.is_quiet);
  PanelFit fit = fit_panel(plan, photographs, params, console.watch("calibrate"));
  console.finish();
  fit.slm.name = o.name.empty() ? std::filesystem::path(o.output).stem().string() : o.name;
  fit.slm.source = fmt::format("holotrace calibrate: {} photographs at {}, {} from the panel", photographs.size(),
                               format_length(fit.slm.design_wavelength), format_length(plan.distance));
  const std::string name = std::filesystem::path(o.output).filename().string();
  const std::string picture = name.substr(0, name.size() - 5) + ".png";
  Observer charts;
  charts.on_warning = [&](const std::string& sentence) { console.watch("chart").warn(sentence); };
  say_warnings(write_together(o.output, record_in_text(o.output), [&](const OutputSet& set) {
    try_save_chart(set, path_with_suffix(picture, "_curve"), curve_chart(fit), charts);
    try_save_chart(set, path_with_suffix(picture, "_residuals"), residual_chart(fit), charts);
    save_panel(set.path(name), fit.slm, [&] { return set.record(); });
  }));
  if (o.is_json)
    fmt::print("{}\n", fit_json(fit).dump(2));
  else
    print_table(fit);
}

}  // namespace

void add_calibrate_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("calibrate", "panel file from photographs of test patterns");
  command->require_subcommand(1);

  CLI::App* patterns = command->add_subcommand("patterns", "test patterns to show on the panel, and their plan");
  auto p = std::make_shared<PatternOptions>();
  add_slm(*patterns, p->slm, "pluto");
  patterns
      ->add_option("--wavelength", p->wavelength,
                   "wavelength of the light [design wavelength of the panel, or 632.8 nm]")
      ->type_name("WAVELENGTH");
  patterns->add_option("--distance", p->distance, "distance from the panel to the camera's bare sensor [300 mm]")
      ->type_name("LENGTH");
  patterns->add_option("-o,--output", p->output, "folder for the patterns and calibration.toml")
      ->required()
      ->type_name("FOLDER");
  p->flags.add(*patterns, TestPatternParams());
  patterns->callback([p] { write_patterns(*p); });

  CLI::App* fit = command->add_subcommand("fit", "panel that explains the photographs of the patterns best");
  auto f = std::make_shared<FitOptions>();
  fit->add_option("plan", f->plan, "plan that `holotrace calibrate patterns` wrote")
      ->required()
      ->type_name("calibration.toml");
  fit->add_option("photographs", f->photographs,
                  "folder of the photographs, each named as its pattern: .png, .tif, .jpg or .exr")
      ->required()
      ->type_name("FOLDER");
  fit->add_option("-o,--output", f->output,
                  "panel file for --slm: NAME.toml, with NAME_phase.csv, NAME_light.exr and the charts NAME_curve.png "
                  "and NAME_residuals.png")
      ->required()
      ->type_name("FILE.toml");
  fit->add_option("--name", f->name, "name of the panel [that of the file]")->type_name("NAME");
  fit->add_flag("--json", f->is_json, "as JSON");
  f->flags.add(*fit, CalibrateParams());
  fit->callback([f, &global] { fit_photographs(*f, global); });
}

}  // namespace holotrace
