#include "holotrace/slm/encode/blank_hologram.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/slm/encode/kinoform.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/encode/off_axis.h"
#include "holotrace/slm/panel/checks.h"

namespace holotrace {
namespace {

void check_panel(const Slm& slm, const EncodeParams& params, const Observer& observer) {
  const Modulation modulation = modulation_of(params, slm);
  const char* name = name_of(params.method, encoding_names);
  require(
      modulation != Modulation::phase || slm.modulation != Modulation::amplitude,
      "expected an encoding for an amplitude panel, which \"{}\" is, got \"{}\"; use \"amplitude\", \"off-axis\" or "
      "\"sgd\"",
      slm.name, name);
  require(modulation != Modulation::complex || slm.modulation == Modulation::complex,
          "expected an encoding for a panel that modulates only phase or only amplitude, as \"{}\" is, got "
          "\"{}\"; use \"double-phase\" or \"off-axis\", or a panel whose modulation is complex",
          slm.name, name);
  if (modulation == Modulation::amplitude && slm.modulation == Modulation::phase &&
      !known_panel(slm, params).effects.crystal)
    observer.warn(
        fmt::format("the SLM \"{}\" modulates phase and the encoding \"{}\" amplitude: it is shown as if "
                    "behind a crossed polariser that turns phase into amplitude",
                    slm.name, name));
}

bool can_allow_for(const std::string& effect, const EncodeParams& params, const Slm& slm) {
  if (params.method == Encoding::sgd) return effect != "flicker";
  if (effect == "crystal") return true;
  if (effect == "calibration") return modulation_of(params, slm) != Modulation::amplitude;
  if (effect == "aberration" || effect == "phase-map") return traits_of(params.method).keeps_phase;
  return effect == "light-map" && traits_of(params.method).keeps_modulus;
}

// The effects of the panel that the levels compensate.
std::vector<std::string> allowed_effects(const Slm& slm, const EncodeParams& params) {
  std::vector<std::string> allowed = effects_of(known_panel(slm, params));
  std::erase_if(allowed, [&](const std::string& effect) { return !can_allow_for(effect, params, slm); });
  return allowed;
}

// Reports which of the named effects the levels do not compensate.
void tell_effects(const Slm& slm, const EncodeParams& params, const Observer& observer) {
  const std::vector<std::string> has = effects_of(slm);
  for (const std::string& name : params.effects) {
    if (name == "all" || name == "none") continue;
    if (!can_allow_for(name, params, slm))
      observer.warn(fmt::format(
          "the encoding \"{}\" cannot compensate {}, which is ignored; sgd compensates all effects but flicker",
          name_of(params.method, encoding_names), name));
    else if (std::find(has.begin(), has.end(), name) == has.end())
      observer.warn(
          fmt::format("the SLM \"{}\" has no data for {} to compensate; add them to the panel's file", slm.name, name));
  }
}

}  // namespace

Modulation modulation_of(const EncodeParams& params, const Slm& slm) {
  switch (params.method) {
    case Encoding::amplitude:
    case Encoding::off_axis:
      return Modulation::amplitude;
    case Encoding::complex:
      return Modulation::complex;
    case Encoding::binary:
      if (params.binary_levels == BinaryLevels::phase) return Modulation::phase;
      if (params.binary_levels == BinaryLevels::amplitude) return Modulation::amplitude;
      return slm.modulation == Modulation::amplitude ? Modulation::amplitude : Modulation::phase;
    case Encoding::sgd:
      return slm.modulation;
    default:
      return Modulation::phase;
  }
}

Slm known_panel(const Slm& slm, const EncodeParams& params) {
  if (!params.effects.empty()) return with_effects(slm, params.effects);
  std::vector<std::string> names = slm.own_effects;
  std::erase_if(names, [&](const std::string& name) {
    if (params.method == Encoding::sgd) return name == "flicker";
    return name != "calibration" && name != "crystal" && name != "aberration" && name != "phase-map" &&
           name != "light-map";
  });
  return with_effects(slm, names);
}

void check_encode_params(const Slm& slm, const EncodeParams& params) {
  check_slm(slm);
  check_ranges(params);
  with_effects(slm, params.effects);  // rejects unknown names before anything is reported
  require(params.levels <= slm.levels,
          "expected 2 to {} levels, as many as the SLM \"{}\" has, or 0 for all of them, got {}", slm.levels, slm.name,
          params.levels);
  if (params.method != Encoding::sgd) require_one_device(params.device, " for this method");
  require(params.device.kind != DeviceKind::opencl || params.method != Encoding::error_diffusion,
          "expected an encoding whose pixels can be found at once on an OpenCL device, got \"{}\", which passes errors "
          "from pixel to pixel; use another one, such as \"double-phase\", or the device cpu",
          name_of(params.method, encoding_names));
}

void check_encoding(const Slm& slm, const EncodeParams& params, const Observer& observer) {
  check_encode_params(slm, params);
  check_panel(slm, params, observer);
  tell_effects(slm, params, observer);
}

void check_head_to_show(const Field& field, const Slm& slm, const Observer& observer) {
  check_wavelength(field.wavelength, slm.grid);
  require_grid_of(slm, field.grid, "field");
  if (field.z != 0)
    observer.warn(fmt::format(
        "the field is in the plane z = {}, but is encoded as if it were on the panel, z = 0; propagate it to the "
        "panel first",
        format_length(field.z)));
  if (field.grid.centre_x != 0 || field.grid.centre_y != 0)
    observer.warn(fmt::format(
        "the field is centred on ({}, {}), but is encoded as if it were centred on the panel; propagate it first, to "
        "a window with centre_x and centre_y of 0 m",
        format_length(field.grid.centre_x), format_length(field.grid.centre_y)));
}

void warn_of_dark_field(double wavelength, const Observer& observer) {
  observer.warn(fmt::format(
      "the field is dark everywhere, so the hologram is empty; check that the scene is in the panel's view and has light of {}",
      format_length(wavelength)));
}

ModulusMoments check_samples_to_show(const Field& field, const Observer& observer) {
  require(field.samples.nx == field.grid.nx && field.samples.ny == field.grid.ny,
          "expected {} × {} samples, as the field's grid says, got {} × {}", field.grid.nx, field.grid.ny,
          field.samples.nx, field.samples.ny);
  // Squares of floats neither overflow nor vanish in doubles: the sum is finite if all samples are, and 0 if all are 0.
  const ModulusMoments moments = modulus_moments(field);
  if (moments.sum == 0) warn_of_dark_field(field.wavelength, observer);
  if (std::isfinite(moments.sum)) return moments;
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) {
      const std::complex<float> u = field.samples(j, i);
      require(std::isfinite(u.real()) && std::isfinite(u.imag()),
              "expected finite samples in the field, got {}{:+}i at row {}, column {}", u.real(), u.imag(), j, i);
    }
  return moments;
}

void check_field_to_show(const Field& field, const Slm& slm, const Observer& observer) {
  check_head_to_show(field, slm, observer);
  check_samples_to_show(field, observer);
}

Hologram blank_hologram(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  Hologram hologram;
  hologram.slm = slm;
  hologram.grid = slm.grid;
  hologram.level = Array2D<uint16_t>(slm.grid.ny, slm.grid.nx);
  hologram.levels = params.levels == 0 ? slm.levels : params.levels;
  hologram.wavelength = field.wavelength;
  hologram.image = params.image;
  hologram.label = field.label;
  hologram.encoder = name_of(params.method, encoding_names);
  hologram.modulation = modulation_of(params, slm);
  hologram.effects = allowed_effects(slm, params);
  if (traits_of(params.method).aims_at_targets) {
    hologram.filter = stop_of(params, slm.grid, field.wavelength);
    hologram.losses = {false, false};
  }
  observer.fact("encoder", hologram.encoder);
  observer.fact("levels", hologram.levels);
  return hologram;
}

Field conjugate(const Field& field) {
  Field conjugates = field;
  parallel_for(0, field.grid.ny, [&](int64_t j) {
    std::complex<float>* u = conjugates.samples.row(int(j));
    for (int i = 0; i < field.grid.nx; ++i) u[i] = std::conj(u[i]);
  });
  return conjugates;
}

std::optional<SpectralFilter> stop_of(const EncodeParams& params, const Grid& grid, double wavelength) {
  const EncodingTraits traits = traits_of(params.method);
  if (traits.writes_fringes) {
    EncodeParams reference = params;
    reference.with_bias = params.with_bias && traits.keeps_modulus;
    return off_axis_filter(reference_carrier(reference, grid, wavelength), grid, reference.with_bias);
  }
  const bool needs_stop = traits.stop < 1, has_stop = traits.aims_at_targets && stop_width(params) < 1;
  if (needs_stop || has_stop) return low_pass_stop(params, grid);
  return std::nullopt;
}

}  // namespace holotrace
