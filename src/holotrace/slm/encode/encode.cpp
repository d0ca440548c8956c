#include "holotrace/slm/encode/encode.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/check_ranges.h"
#include "holotrace/slm/encode/binary.h"
#include "holotrace/slm/encode/double_phase.h"
#include "holotrace/slm/encode/error_diffusion.h"
#include "holotrace/slm/encode/iterate/gerchberg_saxton.h"
#include "holotrace/slm/encode/iterate/gradient_descent.h"
#include "holotrace/slm/encode/iterate/iteration_kernels.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "holotrace/slm/encode/kinoform.h"
#include "holotrace/slm/encode/off_axis.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/stop.h"
#include "holotrace/slm/encode/target.h"
#include "holotrace/slm/panel/checks.h"

namespace holotrace {
namespace {

const char* name_of(Encoding method) {
  switch (method) {
    case Encoding::phase:
      return "phase";
    case Encoding::amplitude:
      return "amplitude";
    case Encoding::off_axis:
      return "off-axis";
    case Encoding::complex:
      return "complex";
    case Encoding::double_phase:
      return "double-phase";
    case Encoding::error_diffusion:
      return "error-diffusion";
    case Encoding::gerchberg_saxton:
      return "gerchberg-saxton";
    case Encoding::weighted_gerchberg_saxton:
      return "weighted-gerchberg-saxton";
    case Encoding::sgd:
      return "sgd";
    case Encoding::binary:
      return "binary";
  }
  fail("expected an encoding that this version knows, got number {}", int(method));
}

void check_samples(const Field& field) {
  require(field.samples.nx == field.grid.nx && field.samples.ny == field.grid.ny,
          "expected {} × {} samples, as the field's grid says, got {} × {}", field.grid.nx, field.grid.ny,
          field.samples.nx, field.samples.ny);
  std::atomic<bool> all_finite{true};
  parallel_for(0, field.grid.ny, [&](int64_t j) {
    const std::complex<float>* u = field.samples.row(int(j));
    // A number that is not finite has all bits of its exponent set. This loop is done in vector lanes.
    constexpr uint32_t exponent = 0x7f800000;
    const float* parts = reinterpret_cast<const float*>(u);
    bool is_finite = true;
    for (int i = 0; i < 2 * field.grid.nx; ++i) is_finite &= (std::bit_cast<uint32_t>(parts[i]) & exponent) != exponent;
    if (!is_finite) all_finite = false;
  });
  if (all_finite) return;
  for (int j = 0; j < field.grid.ny; ++j)
    for (int i = 0; i < field.grid.nx; ++i) {
      const std::complex<float> u = field.samples(j, i);
      require(std::isfinite(u.real()) && std::isfinite(u.imag()),
              "expected finite samples in the field, got {}{:+}i at row {}, column {}", u.real(), u.imag(), j, i);
    }
}

// The modulation of a hologram's pixels.
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

void check_panel(const Slm& slm, const EncodeParams& params, const Observer& observer) {
  const Modulation modulation = modulation_of(params, slm);
  const char* name = name_of(params.method);
  require(
      modulation != Modulation::phase || slm.modulation != Modulation::amplitude,
      "expected an encoding for an amplitude panel, which \"{}\" is, got \"{}\"; use \"amplitude\", \"off-axis\" or "
      "\"sgd\"",
      slm.name, name);
  require(modulation != Modulation::complex || slm.modulation == Modulation::complex,
          "expected an encoding for a panel that modulates only phase or only amplitude, as \"{}\" is, got "
          "\"{}\"; use \"double-phase\" or \"off-axis\", or a panel whose modulation is complex",
          slm.name, name);
  if (modulation == Modulation::amplitude && slm.modulation == Modulation::phase)
    observer.warn(
        fmt::format("the SLM \"{}\" modulates phase and the encoding \"{}\" amplitude: it is shown as if "
                    "behind a crossed polariser that turns phase into amplitude",
                    slm.name, name));
}

bool can_allow_for(const std::string& effect, const EncodeParams& params, const Slm& slm) {
  if (params.method == Encoding::sgd) return effect != "flicker";
  return effect == "calibration" && modulation_of(params, slm) != Modulation::amplitude;
}

// The named effects of the panel that the levels compensate.
std::vector<std::string> allowed_effects(const Slm& slm, const EncodeParams& params) {
  std::vector<std::string> allowed = effects_of(with_effects(slm, params.effects));
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
          name_of(params.method), name));
    else if (std::find(has.begin(), has.end(), name) == has.end())
      observer.warn(
          fmt::format("the SLM \"{}\" has no data for {} to compensate; add them to the panel's file", slm.name, name));
  }
}

void check_params(const Slm& slm, const EncodeParams& params) {
  check_slm(slm);
  check_ranges(params);
  with_effects(slm, params.effects);  // rejects unknown names before anything is reported
  require(params.levels <= slm.levels,
          "expected 2 to {} levels, as many as the SLM \"{}\" has, or 0 for all of them, got {}", slm.levels, slm.name,
          params.levels);
}

void check_field(const Field& field, const Slm& slm, const Observer& observer) {
  check_wavelength(field.wavelength);
  require_grid_of(slm, field.grid, "field");
  check_samples(field);
  if (field.z != 0)
    observer.warn(fmt::format("the field is at z = {} and is shown at the panel, z = 0; propagate it there first",
                              format_length(field.z)));
  if (field.grid.centre_x != 0 || field.grid.centre_y != 0)
    observer.warn(fmt::format("the field is centred on ({}, {}) and is shown on the axis",
                              format_length(field.grid.centre_x), format_length(field.grid.centre_y)));
  const auto is_dark = [](const std::complex<float>& u) { return u == std::complex<float>(); };
  if (std::all_of(field.samples.values.begin(), field.samples.values.end(), is_dark))
    observer.warn("the field is dark everywhere, so the hologram is empty; is a source inside the panel's view?");
}

// The field that shows the real image.
Field conjugate(const Field& field) {
  Field conjugates = field;
  parallel_for(0, field.grid.ny, [&](int64_t j) {
    std::complex<float>* u = conjugates.samples.row(int(j));
    for (int i = 0; i < field.grid.nx; ++i) u[i] = std::conj(u[i]);
  });
  return conjugates;
}

Hologram blank_hologram(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  Hologram hologram;
  hologram.slm = slm;
  hologram.grid = slm.grid;
  hologram.level = Array2D<uint16_t>(slm.grid.ny, slm.grid.nx);
  hologram.levels = params.levels == 0 ? slm.levels : params.levels;
  hologram.wavelength = field.wavelength;
  hologram.image = params.image;
  hologram.name = field.name;
  hologram.frame = field.frame;
  hologram.cone_wavelength = field.cone_wavelength;
  hologram.encoder = name_of(params.method);
  hologram.modulation = modulation_of(params, slm);
  hologram.effects = allowed_effects(slm, params);
  if (aims_at_targets(params.method)) {
    hologram.filter = stop_of(params, slm.grid, field.wavelength);
    hologram.loses_by_cone = hologram.loses_by_pixels = false;
  }
  observer.fact("encoder", hologram.encoder);
  observer.fact("levels", hologram.levels);
  return hologram;
}

// The encoders that use the field on the panel alone.
void encode_directly(const Field& shown, const EncodeParams& params, const PhaseLevels& levels,
                     const Observer& observer, Hologram& hologram) {
  switch (params.method) {
    case Encoding::phase:
      return encode_phase(shown, levels, hologram);
    case Encoding::amplitude:
      return encode_amplitude(shown, observer, hologram);
    case Encoding::off_axis:
      return encode_off_axis(shown, params, observer, hologram);
    case Encoding::complex:
      return encode_complex(shown, levels, observer, hologram);
    case Encoding::double_phase:
      return encode_double_phase(shown, levels, params, observer, hologram);
    case Encoding::error_diffusion:
      return encode_error_diffusion(shown, levels, params, observer, hologram);
    case Encoding::binary:
      return encode_binary(shown, levels, params, observer, hologram);
    default:
      fail("expected an encoding without iterations, got \"{}\"", name_of(params.method));
  }
}

// The start of iterations: the phase of the field, or a random one. On a complex panel the modulus is that of the field,
// as a fraction of the largest, or half with a random phase.
Array2D<std::complex<float>> start_pattern(const Field& field, const EncodeParams& params, Modulation modulation) {
  Array2D<std::complex<float>> pattern =
      params.image == ImageSide::real_image ? conjugate(field).samples : field.samples;
  const bool is_complex = modulation == Modulation::complex;
  const float largest = is_complex ? float(modulus_moments(field).largest) : 0;
  const float modulus = is_complex ? 0.5F : 1;
  parallel_for(0, pattern.ny, [&](int64_t j) {
    std::complex<float>* u = pattern.row(int(j));
    if (params.start == StartPhase::random)
      for (int i = 0; i < pattern.nx; ++i)
        u[i] =
            modulus * std::complex<float>(cis_cycles(
                          CounterRandom(uint64_t(params.seed), field.frame, uint64_t(j * pattern.nx + i)).uniform()));
    else if (largest > 0)
      for (int i = 0; i < pattern.nx; ++i) u[i] /= largest;
    else
      make_unit_modulus(u, size_t(pattern.nx));
  });
  return pattern;
}

}  // namespace

double short_range_efficiency(double range) {
  const double amplitude = range < 1 ? range + std::sin(pi * range) / pi : 1;
  return amplitude * amplitude;
}

Hologram encode(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  check_params(slm, params);
  require_grid_of(slm, field.grid, "field");
  if (aims_at_targets(params.method)) {
    Hologram found = encode_targets(targets_of(field, params), field, slm, params, observer);
    found.loses_by_cone = true;  // the targets are the field's own light
    return found;
  }
  check_panel(slm, params, observer);
  tell_effects(slm, params, observer);
  check_field(field, slm, observer);
  Hologram hologram = blank_hologram(field, slm, params, observer);
  const Slm known = with_effects(slm, params.effects);
  const PhaseLevels levels(known, hologram.levels, field.wavelength);
  if (hologram.modulation != Modulation::amplitude) tell_phase_range(known, levels.range(), field.wavelength, observer);
  if (params.image == ImageSide::real_image)
    encode_directly(conjugate(field), params, levels, observer, hologram);
  else
    encode_directly(field, params, levels, observer, hologram);
  observer.fact("illumination", Fact(hologram.illumination));
  observer.progress(1);
  return hologram;
}

namespace {

// Writes the start of gradient descent: the pattern's phase, on a complex panel also its modulus, at most 1; or, on
// a panel of amplitudes, its real part between 0 and 1.
void write_start(const Array2D<std::complex<float>>& pattern, const PhaseLevels& levels, Hologram& hologram) {
  if (hologram.modulation == Modulation::complex) {
    hologram.modulus_level = Array2D<uint16_t>(pattern.ny, pattern.nx);
    for (size_t i = 0; i < pattern.size(); ++i)
      hologram.modulus_level.values[i] =
          uint16_t(std::lround((hologram.levels - 1) * std::min(1.0F, std::abs(pattern.values[i]))));
  }
  if (hologram.modulation != Modulation::amplitude) return write_phase_levels(pattern, false, levels, hologram.level);
  for (size_t i = 0; i < pattern.size(); ++i)
    hologram.level.values[i] =
        uint16_t(std::lround((hologram.levels - 1) * std::clamp((1 + pattern.values[i].real()) / 2, 0.0F, 1.0F)));
}

// Checks what all iterations need, and reports what the levels compensate.
void check_iterations(const std::vector<TargetPlane>& targets, const Slm& slm, const EncodeParams& params,
                      const Observer& observer) {
  check_params(slm, params);
  require(aims_at_targets(params.method),
          "expected a method that takes targets, gerchberg-saxton, weighted-gerchberg-saxton or sgd, got \"{}\"",
          name_of(params.method));
  require(params.method != Encoding::sgd || modulation_of(params, slm) != Modulation::complex ||
              (params.levels == 0 ? slm.levels : params.levels) > 2,
          "expected more than 2 levels for sgd on a complex panel, got 2; use more levels, or the method binary");
  check_panel(slm, params, observer);
  tell_effects(slm, params, observer);
  check_targets(targets, slm.grid);
}

// Whether there is no light to aim at; warns of it.
bool is_dark(const std::vector<TargetPlane>& targets, double wavelength, const Observer& observer) {
  if (std::any_of(targets.begin(), targets.end(), [](const TargetPlane& t) { return target_power(t) > 0; }))
    return false;
  observer.warn(fmt::format("the target at {} is dark in the part that counts, so the hologram is empty",
                            format_length(wavelength)));
  return true;
}

}  // namespace

Hologram encode_targets(const std::vector<TargetPlane>& targets, const Field& start, const Slm& slm,
                        const EncodeParams& params, const Observer& observer, const Checkpoint& checkpoint) {
  require(!checkpoint || params.method == Encoding::sgd, "expected the method sgd for a checkpoint, got \"{}\"",
          name_of(params.method));
  check_iterations(targets, slm, params, observer);
  check_field(start, slm, observer);
  std::vector<Hologram> frames{blank_hologram(start, slm, params, observer)};
  if (is_dark(targets, start.wavelength, observer)) {
    frames.front().illumination = 0;
    return frames.front();
  }
  const Slm known = with_effects(slm, params.effects);
  const PhaseLevels levels(known, frames.front().levels, start.wavelength);
  const bool is_amplitude = frames.front().modulation == Modulation::amplitude;
  if (!is_amplitude) tell_phase_range(known, levels.range(), start.wavelength, observer);
  Array2D<std::complex<float>> pattern = start_pattern(start, params, frames.front().modulation);
  if (params.method == Encoding::sgd) {
    write_start(pattern, levels, frames.front());
    descend({targets}, known, params, observer, frames, checkpoint);
  } else {
    write_phase_levels(project_in_turn(targets, std::move(pattern), slm, params, observer), false, levels,
                       frames.front().level);
    judge(targets, known, params, observer, frames);
  }
  observer.fact("illumination", Fact(frames.front().illumination));
  observer.progress(1);
  return frames.front();
}

namespace {

// The light of the middle target plane with the phase 0, on the panel. One frame from such a start has little speckle.
Field flat_start(const std::vector<TargetPlane>& targets, const Slm& slm, const EncodeParams& params) {
  EncodeParams direct = params;
  direct.method = Encoding::phase;
  direct.iterations = 1;
  direct.start = StartPhase::field;
  return field_of_target(targets[targets.size() / 2], slm, direct);
}

}  // namespace

std::vector<Hologram> encode_frames(const TargetSet& targets, double wavelength, int frames, const Slm& slm,
                                    const EncodeParams& params, const Observer& observer,
                                    const Checkpoint& checkpoint) {
  check_iterations(targets.planes, slm, params, observer);
  require(params.method == Encoding::sgd, "expected the method sgd for frames that are found together, got \"{}\"",
          name_of(params.method));
  require(frames >= 1, "expected at least one frame, got {}", frames);
  EncodeParams start_params = params;
  if (frames > 1) start_params.start = StartPhase::random;  // equal starts would give equal frames
  std::vector<Hologram> holograms;
  const Slm known = with_effects(slm, params.effects);
  Field start(slm.grid, wavelength);
  if (start_params.start == StartPhase::field) start = flat_start(targets.planes, slm, params);
  for (int frame = 0; frame < frames; ++frame) {
    start.frame = uint32_t(frame);
    holograms.push_back(blank_hologram(start, slm, params, frame == 0 ? observer : Observer{}));
    const PhaseLevels levels(known, holograms.back().levels, wavelength);
    if (frame == 0 && holograms.back().modulation != Modulation::amplitude)
      tell_phase_range(known, levels.range(), wavelength, observer);
    write_start(start_pattern(start, start_params, holograms.back().modulation), levels, holograms.back());
  }
  if (is_dark(targets.planes, wavelength, observer)) {
    for (Hologram& hologram : holograms) hologram.illumination = 0;
    return holograms;
  }
  descend(targets, known, params, observer, holograms, checkpoint);
  observer.fact("illumination", Fact(holograms.front().illumination));
  observer.progress(1);
  return holograms;
}

}  // namespace holotrace
