#include "holotrace/slm/panel/show.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/calibration.h"
#include "holotrace/slm/panel/checks.h"
#include "holotrace/slm/panel/crystal.h"
#include "holotrace/slm/panel/panel_field_by_device.h"
#include "holotrace/slm/panel/panel_model.h"

namespace holotrace {
namespace {

void check_levels_of(const Hologram& hologram, const Array2D<uint16_t>& level) {
  for (int j = 0; j < level.ny; ++j)
    for (int i = 0; i < level.nx; ++i)
      require(level(j, i) < hologram.levels, "expected levels below {}, got {} at row {}, column {}", hologram.levels,
              level(j, i), j, i);
}

void check_hologram(const Hologram& hologram, const Slm& slm) {
  check_levels(hologram.levels);
  check_wavelength(hologram.wavelength, slm.grid);
  require_grid_of(slm, hologram.grid, "hologram");
  require(hologram.level.nx == hologram.grid.nx && hologram.level.ny == hologram.grid.ny,
          "expected {} × {} levels, as the hologram's grid says, got {} × {}", hologram.grid.nx, hologram.grid.ny,
          hologram.level.nx, hologram.level.ny);
  check_levels_of(hologram, hologram.level);
  const bool is_complex = hologram.modulation == Modulation::complex;
  require(
      !is_complex || (hologram.modulus_level.nx == hologram.grid.nx && hologram.modulus_level.ny == hologram.grid.ny),
      "expected levels of amplitude beside those of phase in a complex hologram of {} × {} pixels, got {} × {}",
      hologram.grid.nx, hologram.grid.ny, hologram.modulus_level.nx, hologram.modulus_level.ny);
  if (is_complex) check_levels_of(hologram, hologram.modulus_level);
}

// Errors and warnings as in encode; encode has already warned of the hologram's own panel.
void check_modulation(const Hologram& hologram, const Slm& slm, const Slm& with, const Observer& observer) {
  require(hologram.modulation != Modulation::phase || slm.modulation != Modulation::amplitude,
          "expected a hologram of amplitudes for the amplitude panel \"{}\", got one of phases; encode with "
          "\"amplitude\" or \"off-axis\", or show it on a phase panel",
          slm.name);
  require(
      hologram.modulation != Modulation::complex || slm.modulation == Modulation::complex,
      "expected a hologram of phase or of amplitude alone for the panel \"{}\", which has no more, got one of both; "
      "encode with \"double-phase\" or \"off-axis\", or show it on a panel whose modulation is complex",
      slm.name);
  const bool was_told = hologram.slm && hologram.slm->modulation == Modulation::phase;
  if (hologram.modulation == Modulation::amplitude && slm.modulation == Modulation::phase && !was_told &&
      !with.effects.crystal)
    observer.warn(
        fmt::format("the SLM \"{}\" modulates phase and the hologram amplitude: it is shown as if behind a crossed "
                    "polariser that turns phase into amplitude",
                    slm.name));
}

void check_light(const ShowParams& params) {
  require(params.beam_radius == 0 || params.light == Wavefront::gaussian,
          "expected a beam radius only with Gaussian light, got {}; set light to gaussian, or leave out beam_radius",
          format_length(params.beam_radius));
  require(params.source_distance == 0 || params.light == Wavefront::spherical,
          "expected a source distance only with spherical light, got {}; set light to spherical, or leave out "
          "source_distance",
          format_length(params.source_distance));
}

// The stop is centred on the light that the encoder's order is to take. Tilted light moves the order,
// and the stop with it. The stop does not follow the tilt of a single illumination state.
SpectralFilter under_tilt(SpectralFilter stop, const ShowParams& params, double wavelength) {
  stop.u0 += std::sin(params.tilt_x) / wavelength;
  stop.v0 += std::sin(params.tilt_y) / wavelength;
  return stop;
}

Array2D<float> drive_of(const Array2D<uint16_t>& level) {
  Array2D<float> drive(level.ny, level.nx);
  for (size_t i = 0; i < level.size(); ++i) drive.values[i] = float(level.values[i]);
  return drive;
}

// The names of `names` that are not in `others`.
std::string missing_in(const std::vector<std::string>& others, const std::vector<std::string>& names) {
  std::vector<std::string> missing;
  for (const std::string& name : names)
    if (std::find(others.begin(), others.end(), name) == others.end()) missing.push_back(name);
  return fmt::format("{}", fmt::join(missing, ", "));
}

// Levels that compensate effects are right only for a panel with exactly these effects. Flicker does not count: its
// mean is the phase of the level, and no level can compensate it.
void warn_other_effects(const Hologram& hologram, const Slm& with, const Observer& observer) {
  if (hologram.effects.empty()) return;
  std::vector<std::string> on = effects_of(with);
  std::erase(on, "flicker");
  const std::string allowed = fmt::format("{}", fmt::join(hologram.effects, ", "));
  const std::string unknown = missing_in(hologram.effects, on), off = missing_in(on, hologram.effects);
  if (!unknown.empty())
    observer.warn(
        fmt::format("the hologram compensates {} but not {}, which are modelled on the SLM \"{}\"; sgd compensates all "
                    "effects but flicker",
                    allowed, unknown, with.name));
  if (!off.empty())
    observer.warn(fmt::format(
        "the hologram compensates {}, which is not modelled on the SLM \"{}\"; name {} in [show] effects, or "
        "encode without",
        off, with.name, off));
}

// The largest difference of a level's phase [rad] or amplitude.
double largest_step(const std::vector<CalibrationPoint>& a, const std::vector<CalibrationPoint>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i)
    largest = std::max({largest, std::abs(a[i].phase - b[i].phase), std::abs(a[i].amplitude - b[i].amplitude)});
  return largest;
}

double rms_between(const std::vector<ZernikeTerm>& a, const std::vector<ZernikeTerm>& b) {
  std::map<std::pair<int, int>, double> terms;
  for (const ZernikeTerm& term : a) terms[{term.n, term.m}] += term.rms;
  for (const ZernikeTerm& term : b) terms[{term.n, term.m}] -= term.rms;
  double squares = 0;
  for (const auto& [order, rms] : terms) squares += rms * rms;
  return std::sqrt(squares);
}

// Levels are right for the data of the panel for which they were found, which may have been measured anew since.
void warn_newer_data(const Hologram& hologram, const Slm& with, const Observer& observer) {
  if (!hologram.slm || hologram.encoder == test_pattern_encoder) return;
  constexpr double visible = 0.05;  // rad: a thousandth of the light
  const SlmEffects &then = hologram.slm->effects, &now = with.effects;
  std::vector<std::string> newer;
  const bool has_phases = hologram.modulation != Modulation::amplitude && with.modulation != Modulation::amplitude;
  if (!now.calibration.empty()) {
    if (largest_step(now.calibration, then.calibration) > visible) newer.push_back("calibration");
  } else if (has_phases && then.calibration.empty() && !now.crystal) {
    const auto range_at = [&](const Slm& slm) {
      return slm.phase_range * (slm.design_wavelength > 0 ? slm.design_wavelength / hologram.wavelength : 1);
    };
    if (std::abs(range_at(with) - range_at(*hologram.slm)) > visible) newer.push_back("phase range");
  }
  if (!now.aberration.empty() && rms_between(now.aberration, then.aberration) > visible) newer.push_back("aberration");
  if (!newer.empty())
    observer.warn(
        fmt::format("the hologram was made for another {} than the SLM \"{}\" has; encode it again for this panel",
                    fmt::join(newer, " and "), with.name));
}

void tell_effects(const Slm& slm, const Slm& with, const ShowParams& params, const Observer& observer) {
  const std::vector<std::string> has = effects_of(slm), on = effects_of(with);
  for (const std::string& name : params.effects)
    if (name != "all" && name != "none" && std::find(has.begin(), has.end(), name) == has.end())
      observer.warn(
          fmt::format("the SLM \"{}\" has no data for {}; add them to [slm] or to the panel's file", slm.name, name));
  std::vector<std::string> off;
  for (const std::string& name : has)
    if (std::find(on.begin(), on.end(), name) == on.end()) off.push_back(name);
  if (!on.empty()) observer.fact("effects", Fact(fmt::format("{}", fmt::join(on, ", "))));
  if (!off.empty()) observer.fact("effects_off", Fact(fmt::format("{}", fmt::join(off, ", "))));
}

// A hologram on a panel under one illumination state, ready to be shown.
struct Shown {
  PanelModel panel;
  Array2D<float> drive, moduli;  // levels
  bool is_complex;
  ImageSide image;
  std::optional<SpectralFilter> filter;
  Label label{};

  PanelModel::Pattern pattern() const { return {drive, is_complex ? &moduli : nullptr}; }

  // Sets what the camera needs to know.
  void complete(Field& field) const {
    field.image = image;
    field.filter = filter;
    field.label = label;
  }

  Field on_processor() const {
    Field field = panel.leave(drive, pattern().modulus);
    complete(field);
    return field;
  }
};

Shown ready_to_show(const Hologram& hologram, const Slm& slm, const ShowParams& params, const IlluminationState& state,
                    const Observer& observer) {
  check_slm(slm);
  check_hologram(hologram, slm);
  const Slm with = with_effects_or_own(slm, params.effects);
  check_modulation(hologram, slm, with, observer);
  check_light(params);
  if (hologram.levels > slm.levels)
    observer.warn(fmt::format("the hologram has {} levels and the SLM \"{}\" {}: it is shown as if it had {}",
                              hologram.levels, slm.name, slm.levels, hologram.levels));
  const double design = slm.design_wavelength > 0 ? slm.design_wavelength : hologram.wavelength;
  Shown shown{{with, params, hologram.modulation, hologram.levels, design, state},
              drive_of(hologram.level),
              drive_of(hologram.modulus_level),
              hologram.modulation == Modulation::complex,
              hologram.image,
              {},
              hologram.label};
  if (hologram.filter) shown.filter = under_tilt(*hologram.filter, params, state.wavelength);
  return shown;
}

void tell(const Hologram& hologram, const Slm& slm, const ShowParams& params, double power_in, double power_out,
          const Observer& observer) {
  observer.fact("power_in", Fact(power_in));
  observer.fact("power_out", Fact(power_out));
  observer.fact("efficiency", Fact(power_in > 0 ? power_out / power_in : 0.0));
  const Slm with = with_effects_or_own(slm, params.effects);
  tell_effects(slm, with, params, observer);
  warn_other_effects(hologram, with, observer);
  warn_newer_data(hologram, with, observer);
}

}  // namespace

ShownField show_state(const Hologram& hologram, const Slm& slm, const ShowParams& params,
                      const IlluminationState& state, const Observer& observer) {
  const Shown shown = ready_to_show(hologram, slm, params, state, observer);
  std::optional<Field> there = panel_field_by_device(shown.panel, shown.pattern(), params.device, observer);
  if (there) shown.complete(*there);
  ShownField result{there ? std::move(*there) : shown.on_processor(), shown.panel.power_in()};
  tell(hologram, slm, params, result.power_in, power(result.field), observer);
  return result;
}

ShownLight show_light(const Hologram& hologram, const Slm& slm, const ShowParams& params,
                      const IlluminationState& state, const Observer& observer) {
  const auto shown = std::make_shared<const Shown>(ready_to_show(hologram, slm, params, state, observer));
  const double power_in = shown->panel.power_in();
  std::optional<PanelField> there = panel_field_on_device(shown->panel, shown->pattern(), params.device, observer);
  DeviceField* const on_device = there ? std::get_if<DeviceField>(&there->field) : nullptr;
  if (!on_device) {
    Field field = there ? std::get<Field>(std::move(there->field)) : shown->on_processor();
    shown->complete(field);
    tell(hologram, slm, params, power_in, there ? there->power : power(field), observer);
    return {PlacedField(std::move(field)), power_in};
  }
  shown->complete(on_device->head);
  tell(hologram, slm, params, power_in, there->power, observer);
  ComputeAgain again;
  if (params.device.kind == DeviceKind::automatic) again = [shown](const Observer&) { return shown->on_processor(); };
  return {PlacedField(std::move(*on_device), std::move(again)), power_in};
}

Field show(const Hologram& hologram, const Slm& slm, const ShowParams& params, const IlluminationState& state,
           const Observer& observer) {
  return show_state(hologram, slm, params, state, observer).field;
}

Field show(const Hologram& hologram, const Slm& slm, const ShowParams& params, const Observer& observer) {
  check_slm(slm);
  const double wavelength = params.wavelength == 0 ? hologram.wavelength : params.wavelength;
  const double design = slm.design_wavelength > 0 ? slm.design_wavelength : hologram.wavelength;
  if (polarisation_components(with_effects_or_own(slm, params.effects), design / wavelength).size() > 1)
    observer.warn(fmt::format(
        "light of several polarisations leaves the SLM \"{}\", and a field holds only the one that the levels modulate "
        "most; views add all of them; set an analyser for the field of another one",
        slm.name));
  return show(hologram, slm, params, IlluminationState{wavelength, params.tilt_x, params.tilt_y}, observer);
}

}  // namespace holotrace
