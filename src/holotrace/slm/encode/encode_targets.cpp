#include <algorithm>
#include <optional>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/frame_start.h"
#include "holotrace/slm/encode/iterate/gerchberg_saxton.h"
#include "holotrace/slm/encode/iterate/gradient_descent.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "holotrace/slm/encode/kinoform.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/target.h"
#include "holotrace/slm/panel/checks.h"

namespace holotrace {
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
  const Slm known = known_panel(slm, params);
  const PhaseLevels levels(known, frames.front().levels, start.wavelength);
  const bool is_amplitude = frames.front().modulation == Modulation::amplitude;
  if (!is_amplitude) tell_phase_range(known, levels.range(), start.wavelength, observer);
  const Array2D<std::complex<float>> pattern = start_pattern(start, params, frames.front().modulation);
  if (params.method == Encoding::sgd) {
    write_start(pattern, levels, frames.front());
    descend({targets}, known, params, observer, frames, checkpoint);
  } else {
    const auto [found, device] = project_in_turn(targets, pattern, known, params, observer);
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
  const Slm known = known_panel(slm, params);
  const bool has_dark_targets = is_dark(targets, wavelength, observer);
  std::optional<FrameStart> kind;  // none for dark targets
  if (!has_dark_targets) kind = start_of_frames(targets, wavelength, frames, slm, params);
  for (int frame = 0; frame < frames; ++frame) {
    Field blank(slm.grid, wavelength);
    blank.label.frame = uint32_t(frame);
    holograms.push_back(blank_hologram(blank, slm, params, frame == 0 ? observer : Observer{}));
    const PhaseLevels levels(known, holograms.back().levels, wavelength);
    if (frame == 0 && holograms.back().modulation != Modulation::amplitude)
      tell_phase_range(known, levels.range(), wavelength, observer);
    if (kind)
      write_frame_start(*kind, targets, {frame, frames}, slm, params, levels, holograms.back());
    else
      write_start(start_pattern(blank, params, holograms.back().modulation), levels, holograms.back());
  }
  if (!kind) {
    for (Hologram& hologram : holograms) hologram.illumination = 0;
    return holograms;
  }
  EncodeParams stepped = params;
  if (params.step == 0) stepped.step = step_from(*kind, targets, slm.grid, iterations_of(params));
  descend(targets, known, stepped, observer, holograms, checkpoint, links);
  observer.fact("illumination", Fact(holograms.front().illumination));
  observer.progress(1);
  return holograms;
}

}  // namespace holotrace
