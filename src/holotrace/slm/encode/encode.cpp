#include "holotrace/slm/encode/encode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/slm/encode/encode_on_device.h"
#include "holotrace/slm/encode/error_diffusion.h"
#include "holotrace/slm/encode/frame_start.h"
#include "holotrace/slm/encode/iterate/gerchberg_saxton.h"
#include "holotrace/slm/encode/iterate/gradient_descent.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "holotrace/slm/encode/kinoform.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/target.h"
#include "holotrace/slm/panel/checks.h"
#include "holotrace/slm/panel/static_errors.h"
#include "holotrace/wave/shared/stage_on_device.h"

namespace holotrace {
namespace {

// Factors that a field takes before it is encoded, so that the panel shows it in the light on each pixel, √m, and for
// methods that write fringes with its static phase errors: 1/√m, or exp(−iψ)/√m. Empty: all are 1. A pixel with less than
// a tenth of the brightest pixel's light counts as if it had a tenth: few dark pixels must not darken all others.
Array2D<std::complex<float>> factors_for_panel(const Slm& known, const EncodeParams& params, double wavelength) {
  const EncodingTraits traits = traits_of(params.method);
  Slm counted = known;
  if (!traits.writes_fringes) {
    counted.effects.aberration.clear();
    counted.effects.phase_map = nullptr;
  }
  if (!traits.keeps_modulus) counted.effects.light_map = nullptr;
  const double stretch = known.design_wavelength > 0 ? known.design_wavelength / wavelength : 1;
  Array2D<std::complex<float>> factors = static_phasors(counted, stretch);
  float brightest = 0;
  for (const std::complex<float>& factor : factors.values) brightest = std::max(brightest, std::norm(factor));
  for (std::complex<float>& factor : factors.values)
    factor = std::norm(factor) == 0
                 ? std::complex<float>(1)
                 : std::conj(factor) / std::abs(factor) / std::sqrt(std::max(std::norm(factor), 0.1F * brightest));
  return factors;
}

// A hologram of a field that was checked, the levels of its panel, and the factors that its field takes.
struct Begun {
  Hologram hologram;
  PhaseLevels levels;
  Array2D<std::complex<float>> factors;

  bool needs_processor(const EncodeParams& params) const {
    const EncodingTraits traits = traits_of(params.method);
    const bool writes_phases = traits.keeps_phase && !traits.writes_fringes;  // of every value
    return (levels.has_table() && writes_phases) || factors.size() > 0;
  }
};

// The field that is shown, U or its conjugate, times those factors.
Field shown_field(const Field& field, const Array2D<std::complex<float>>& factors, bool is_conjugate) {
  Field shown = is_conjugate ? conjugate(field) : field;
  for (size_t i = 0; i < factors.size(); ++i) shown.samples.values[i] *= factors.values[i];
  return shown;
}

Begun begin_hologram(const Field& head, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  Hologram hologram = blank_hologram(head, slm, params, observer);
  const Slm known = known_panel(slm, params);
  PhaseLevels levels(known, hologram.levels, head.wavelength);
  if (hologram.modulation != Modulation::amplitude) tell_phase_range(known, levels, head.wavelength, observer);
  return {std::move(hologram), std::move(levels), factors_for_panel(known, params, head.wavelength)};
}

// Levels that show even steps of amplitude on a panel whose crystal shows other ones.
void fit_amplitudes(const Slm& known, const Observer& observer, Hologram& hologram) {
  if (!known.effects.crystal || hologram.modulation != Modulation::amplitude) return;
  const double stretch = known.design_wavelength > 0 ? known.design_wavelength / hologram.wavelength : 1;
  const AmplitudeTable table = amplitude_table(known, hologram.levels, stretch);
  tell_amplitude_range(known, table.amplitudes, observer);
  for (uint16_t& level : hologram.level.values) level = uint16_t(table.level_of_step[level]);
}

}  // namespace

double short_range_efficiency(double range) {
  const double amplitude = range < 1 ? range + std::sin(pi * range) / pi : 1;
  return amplitude * amplitude;
}

Hologram encode(const PlacedField& field, const Slm& slm, const EncodeParams& given, const Observer& observer) {
  const Field& head = field.head();
  EncodeParams params = given;
  params.method = method_or(given.method, Encoding::phase);
  check_encode_params(slm, params);
  require_grid_of(slm, head.grid, "field");
  if (traits_of(params.method).aims_at_targets) {
    const auto here = field.on_processor(observer);
    Hologram found = encode_targets(targets_of(*here, params), *here, slm, params, observer);
    found.losses.by_cone = true;  // the targets are the field's own light
    return found;
  }
  check_encoding(slm, params, observer);
  const auto finished = [&](Hologram hologram) {
    fit_amplitudes(known_panel(slm, params), observer, hologram);
    observer.fact("illumination", Fact(hologram.illumination));
    observer.progress(1);
    return hologram;
  };
  check_head_to_show(head, slm, observer);
  Begun begun = begin_hologram(head, slm, params, observer);
  const bool needs_processor = begun.needs_processor(params);
  if (needs_processor && params.device.kind == DeviceKind::opencl)
    observer.warn(fmt::format(
        "the hologram is encoded on the processor, not on the OpenCL device, because the SLM \"{}\" has a "
        "calibration, a crystal, a wavefront error or a light map; use the device cpu, or [encode] effects = none",
        slm.name));
  if (traits_of(params.method).is_pointwise && !needs_processor) {
    Observer of_faults;  // the device is told if it has encoded
    of_faults.on_warning = observer.on_warning;
    auto there = on_chosen_device(
        params.device, of_faults, [&] { return fastest_to_encode(field, begun.hologram, begun.levels, params); },
        [&](Device& device) { return encode_on(device, field, begun.hologram, begun.levels, params, observer); });
    if (there && *there) return finished(std::move(**there));
  }
  auto here = field.on_processor(observer);
  ModulusMoments moments = check_samples_to_show(*here, observer);
  bool is_conjugate = params.image == ImageSide::real_image;
  if (begun.factors.size() > 0 || (is_conjugate && params.method == Encoding::error_diffusion)) {
    here = std::make_shared<const Field>(shown_field(*here, begun.factors, is_conjugate));
    is_conjugate = false;
    moments = modulus_moments(*here);
  }
  if (params.method == Encoding::error_diffusion)
    encode_error_diffusion(*here, begun.levels, params, observer, begun.hologram);
  else
    encode_anywhere(ShownPixels<Field>{*here, moments, is_conjugate}, params, begun.levels, observer, begun.hologram);
  return finished(std::move(begun.hologram));
}

Hologram encode(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  return encode(PlacedField::of(field), slm, params, observer);
}

namespace {

// Checks what all iterations need, and reports what the levels compensate.
void check_iterations(const TargetSet& targets, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  check_encode_params(slm, params);
  require(traits_of(params.method).aims_at_targets,
          "expected a method that takes targets, gerchberg-saxton, weighted-gerchberg-saxton or sgd, got \"{}\"",
          name_of(params.method, encoding_names));
  require(params.method != Encoding::sgd || modulation_of(params, slm) != Modulation::complex ||
              (params.levels == 0 ? slm.levels : params.levels) > 2,
          "expected more than 2 levels for sgd on a complex panel, got 2; use more levels, or the method binary");
  check_encoding(slm, params, observer);
  if (targets.views.empty()) check_targets(targets.planes, slm.grid);
}

// Whether there is no light to aim at; warns of it.
bool is_dark(const TargetSet& targets, double wavelength, const Observer& observer) {
  const auto is_lit = [](const auto& target) { return target_power(target) > 0; };
  if (std::any_of(targets.planes.begin(), targets.planes.end(), is_lit) ||
      std::any_of(targets.views.begin(), targets.views.end(), is_lit))
    return false;
  observer.warn(fmt::format("the target at {} is dark in the part that counts, so the hologram is empty",
                            format_length(wavelength)));
  return true;
}

void check_last(const Hologram& last, const Hologram& next) {
  require(last.level.nx == next.level.nx && last.level.ny == next.level.ny,
          "expected a last hologram of {} × {} pixels, as the panel has, got {} × {}", next.level.nx, next.level.ny,
          last.level.nx, last.level.ny);
  require(last.modulation == next.modulation && last.levels == next.levels,
          "expected a last hologram of {} levels of {}, got {} levels of {}; give one that was made for this panel",
          next.levels, name_of(next.modulation, modulation_names), last.levels,
          name_of(last.modulation, modulation_names));
  require(
      std::abs(last.wavelength / next.wavelength - 1) < 1e-9,
      "expected a last hologram at {}, got one at {}; give the holograms of each wavelength in the order of the new ones",
      format_length(next.wavelength), format_length(last.wavelength));
}

// A display goes on showing the last picture's frames but the first: they move up by one place.
void keep_shown_frames(const std::vector<Hologram>& last, std::vector<Hologram>& frames) {
  for (size_t m = 0; m + 1 < std::min(frames.size(), last.size()); ++m) {
    check_last(last[m + 1], frames[m]);
    frames[m].level = last[m + 1].level;
    frames[m].modulus_level = last[m + 1].modulus_level;
    frames[m].illumination = last[m + 1].illumination;
  }
}

// Levels of the last picture in place of a start. Rolling frames move up by one place, and the first becomes the last.
DescentStart go_on_from(const std::vector<Hologram>& last, const EncodeParams& params, std::vector<Hologram>& frames) {
  require(params.method == Encoding::sgd, "expected the method sgd for a start from the last holograms, got \"{}\"",
          name_of(params.method, encoding_names));
  require(last.size() == frames.size(), "expected {} frame(s) of the last picture, as many as the new one has, got {}",
          frames.size(), last.size());
  for (size_t m = 0; m < frames.size(); ++m) {
    const Hologram& from = last[params.is_rolling ? (m + 1) % last.size() : m];
    check_last(from, frames[m]);
    frames[m].level = from.level;
    frames[m].modulus_level = from.modulus_level;
  }
  return {.is_near = true, .fixed = params.is_rolling ? frames.size() - 1 : 0};
}

// Goes on from the last holograms. After a cut it leaves the frames as they were, unless the parameters say how many iterations it
// should do, or the frames that were shown stay. It is so short that it needs no checkpoint.
// @return  whether the frames were found
bool find_next(const TargetSet& targets, const Slm& known, const EncodeParams& params, const Observer& observer,
               std::vector<Hologram>& frames, const std::vector<Hologram>& last, ProcessLinks* links) {
  std::vector<Hologram> next = frames;
  const DescentStart near = go_on_from(last, params, next);
  const bool must_go_on = params.next_iterations > 0 || params.is_rolling;
  const bool is_found =
      descend(targets, known, params, observer, next, {}, links, near, must_go_on ? 1e300 : sgd_far_loss);
  observer.fact("start", std::string(is_found ? "last" : "fresh"));
  if (is_found) frames = std::move(next);
  return is_found;
}

}  // namespace

Hologram encode_targets(const std::vector<TargetPlane>& targets, const Field& start, const Slm& slm,
                        const EncodeParams& params, const Observer& observer, const Checkpoint& checkpoint,
                        const std::vector<Hologram>& last) {
  require(!checkpoint || params.method == Encoding::sgd, "expected the method sgd for a checkpoint, got \"{}\"",
          name_of(params.method, encoding_names));
  check_iterations({targets}, slm, params, observer);
  check_field_to_show(start, slm, observer);
  std::vector<Hologram> frames{blank_hologram(start, slm, params, observer)};
  if (is_dark({targets}, start.wavelength, observer)) {
    frames.front().illumination = 0;
    return frames.front();
  }
  const Slm known = known_panel(slm, params);
  const PhaseLevels levels(known, frames.front().levels, start.wavelength);
  const bool is_amplitude = frames.front().modulation == Modulation::amplitude;
  if (!is_amplitude) tell_phase_range(known, levels, start.wavelength, observer);
  const auto pattern = [&] { return start_pattern(start, params, frames.front().modulation); };
  if (params.method == Encoding::sgd || !last.empty()) {
    if (last.empty() || !find_next({targets}, known, params, observer, frames, last, nullptr)) {
      write_start(pattern(), levels, frames.front());
      descend({targets}, known, params, observer, frames, checkpoint);
    }
  } else {
    const auto [found, device] = project_in_turn(targets, pattern(), known, params, observer);
    write_phase_levels(found, false, levels, frames.front().level);
    judge(targets, known, params, observer, frames, device);
  }
  observer.fact("illumination", Fact(frames.front().illumination));
  observer.progress(1);
  return frames.front();
}

std::vector<Hologram> encode_frames(const TargetSet& targets, double wavelength, int frames, const Slm& slm,
                                    const EncodeParams& params, const Observer& observer, const Checkpoint& checkpoint,
                                    ProcessLinks* links, const std::vector<Hologram>& last) {
  check_iterations(targets, slm, params, observer);
  require(params.method == Encoding::sgd, "expected the method sgd for frames that are found together, got \"{}\"",
          name_of(params.method, encoding_names));
  require(frames >= 1, "expected at least one frame, got {}", frames);
  std::vector<Hologram> holograms;
  const Slm known = known_panel(slm, params);
  const bool has_dark_targets = is_dark(targets, wavelength, observer);
  for (int frame = 0; frame < frames; ++frame) {
    Field blank(slm.grid, wavelength);
    blank.label.frame = uint32_t(frame);
    holograms.push_back(blank_hologram(blank, slm, params, frame == 0 ? observer : Observer{}));
  }
  const PhaseLevels levels(known, holograms.front().levels, wavelength);
  if (holograms.front().modulation != Modulation::amplitude) tell_phase_range(known, levels, wavelength, observer);
  if (has_dark_targets) {
    for (Hologram& hologram : holograms) {
      Field blank(slm.grid, wavelength);
      blank.label = hologram.label;
      write_start(start_pattern(blank, params, hologram.modulation), levels, hologram);
      hologram.illumination = 0;
    }
    if (!last.empty() && params.is_rolling) keep_shown_frames(last, holograms);
    return holograms;
  }
  if (last.empty() || !find_next(targets, known, params, observer, holograms, last, links)) {
    const FrameStart kind = start_of_frames(targets, wavelength, frames, slm, params);
    for (int frame = 0; frame < frames; ++frame)
      write_frame_start(kind, targets, {frame, frames}, slm, params, levels, holograms[size_t(frame)]);
    EncodeParams stepped = params;
    if (params.step == 0) stepped.step = step_from(kind, targets, slm.grid, iterations_of(params), frames);
    descend(targets, known, stepped, observer, holograms, checkpoint, links);
  }
  observer.fact("illumination", Fact(holograms.front().illumination));
  observer.progress(1);
  return holograms;
}

}  // namespace holotrace
