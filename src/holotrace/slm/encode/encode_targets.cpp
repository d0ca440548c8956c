#include <algorithm>
#include <cmath>

#include "holotrace/base/cycles.h"
#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/iterate/gerchberg_saxton.h"
#include "holotrace/slm/encode/iterate/gradient_descent.h"
#include "holotrace/slm/encode/iterate/iteration_kernels.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "holotrace/slm/encode/kinoform.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/target.h"
#include "holotrace/slm/panel/checks.h"

namespace holotrace {
namespace {

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

// The start of a frame for eyes: a wave that converges to one of them, the frame's in turn. Noise makes frames differ, and
// spreads some of the light over the eyebox and beyond (docs/explanation/encoders.md compares its amounts).
Array2D<std::complex<float>> converging_pattern(const std::vector<Vec3>& eyes, const Field& field,
                                                const EncodeParams& params, Modulation modulation) {
  constexpr double noise = 0.35;  // cycles, either way
  const Vec3 eye = eyes[field.frame % eyes.size()];
  const double modulus = modulation == Modulation::complex ? 0.5 : 1;
  Array2D<std::complex<float>> pattern(field.grid.ny, field.grid.nx);
  parallel_for(0, pattern.ny, [&](int64_t j) {
    for (int i = 0; i < pattern.nx; ++i) {
      const Vec3 way = eye - Vec3{field.grid.x(i), field.grid.y(double(j)), 0};
      CounterRandom random(uint64_t(params.seed), field.frame, uint64_t(j * pattern.nx + i));
      pattern(int(j), i) = std::complex<float>(
          modulus * cis_cycles((eye.z - length(way)) / field.wavelength + noise * (2 * random.uniform() - 1)));
    }
  });
  return pattern;
}

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
void check_iterations(const TargetSet& targets, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  check_encode_params(slm, params);
  require(aims_at_targets(params.method),
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

// The start of frames that aim at planes: the field that shows the middle one. One frame has the phase 0 in that plane, which
// has the least speckle; several have random phases there, which differ, and keep the light within the planes.
Field start_at_planes(const std::vector<TargetPlane>& targets, double wavelength, const Slm& slm,
                      const EncodeParams& params, int frame, int frames) {
  std::vector<const TargetPlane*> of_colour;
  for (const TargetPlane& target : targets)
    if (target.wavelength == wavelength) of_colour.push_back(&target);
  require(!of_colour.empty(), "expected target planes at {}, got none", format_length(wavelength));
  EncodeParams direct = params;
  direct.method = Encoding::phase;
  direct.iterations = 1;
  direct.start = frames == 1 ? StartPhase::field : StartPhase::random;
  direct.seed = params.seed + frame;
  return field_of_target(*of_colour[of_colour.size() / 2], slm, direct);
}

}  // namespace

Hologram encode_targets(const std::vector<TargetPlane>& targets, const Field& start, const Slm& slm,
                        const EncodeParams& params, const Observer& observer, const Checkpoint& checkpoint) {
  require(!checkpoint || params.method == Encoding::sgd, "expected the method sgd for a checkpoint, got \"{}\"",
          name_of(params.method, encoding_names));
  check_iterations({targets}, slm, params, observer);
  check_field_to_show(start, slm, observer);
  std::vector<Hologram> frames{blank_hologram(start, slm, params, observer)};
  if (is_dark({targets}, start.wavelength, observer)) {
    frames.front().illumination = 0;
    return frames.front();
  }
  const Slm known = with_effects(slm, params.effects);
  const PhaseLevels levels(known, frames.front().levels, start.wavelength);
  const bool is_amplitude = frames.front().modulation == Modulation::amplitude;
  if (!is_amplitude) tell_phase_range(known, levels.range(), start.wavelength, observer);
  const Array2D<std::complex<float>> pattern = start_pattern(start, params, frames.front().modulation);
  if (params.method == Encoding::sgd) {
    write_start(pattern, levels, frames.front());
    descend({targets}, known, params, observer, frames, checkpoint);
  } else {
    const auto [found, device] = project_in_turn(targets, pattern, slm, params, observer);
    write_phase_levels(found, false, levels, frames.front().level);
    judge(targets, known, params, observer, frames, device);
  }
  observer.fact("illumination", Fact(frames.front().illumination));
  observer.progress(1);
  return frames.front();
}

std::vector<Hologram> encode_frames(const TargetSet& targets, double wavelength, int frames, const Slm& slm,
                                    const EncodeParams& params, const Observer& observer, const Checkpoint& checkpoint,
                                    ProcessLinks* links) {
  check_iterations(targets, slm, params, observer);
  require(params.method == Encoding::sgd, "expected the method sgd for frames that are found together, got \"{}\"",
          name_of(params.method, encoding_names));
  require(frames >= 1, "expected at least one frame, got {}", frames);
  std::vector<Hologram> holograms;
  const Slm known = with_effects(slm, params.effects);
  const bool has_dark_targets = is_dark(targets, wavelength, observer);
  for (int frame = 0; frame < frames; ++frame) {
    Field start(slm.grid, wavelength);
    if (params.start == StartPhase::field && targets.eyes.empty() && !has_dark_targets)
      start = start_at_planes(targets.planes, wavelength, slm, params, frame, frames);
    start.frame = uint32_t(frame);
    holograms.push_back(blank_hologram(start, slm, params, frame == 0 ? observer : Observer{}));
    const PhaseLevels levels(known, holograms.back().levels, wavelength);
    if (frame == 0 && holograms.back().modulation != Modulation::amplitude)
      tell_phase_range(known, levels.range(), wavelength, observer);
    const bool converges = params.start == StartPhase::field && !targets.eyes.empty();
    write_start(converges ? converging_pattern(targets.eyes, start, params, holograms.back().modulation)
                          : start_pattern(start, params, holograms.back().modulation),
                levels, holograms.back());
  }
  if (has_dark_targets) {
    for (Hologram& hologram : holograms) hologram.illumination = 0;
    return holograms;
  }
  descend(targets, known, params, observer, holograms, checkpoint, links);
  observer.fact("illumination", Fact(holograms.front().illumination));
  observer.progress(1);
  return holograms;
}

}  // namespace holotrace
