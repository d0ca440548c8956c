#include "holotrace/run/illumination_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "holotrace/base/units.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/slm/panel/illumination.h"
#include "holotrace/view/camera.h"

namespace holotrace {
namespace {

constexpr int most_planned = 256, of_flicker = 16, least_of_spectrum = 8;
constexpr int most_given = 65536;  // upper limit of ShowParams::illumination_states

int counted(double number) { return int(std::ceil(std::clamp(number, 1.0, 1e6))); }

// Number of parts of the source such that a pupil or a pass band limits the light of each part evenly.
int parts_of_source(const Slm& slm, const ShowParams& params, double wavelength, const std::vector<Viewpoint>& from,
                    const std::optional<SpectralFilter>& filter) {
  double band = params.subpixels / slm.grid.pitch;  // [1/m]
  if (filter) band = std::min({band, 2 * filter->half_u, 2 * filter->half_v});
  double moved = params.source_angle / (wavelength * band);  // shift of the light in widths of the pupil or band
  for (const Viewpoint& view : from)
    if (view.camera.pupil > 0 && is_asked_for(view.kind))
      moved = std::max(moved, params.source_angle * view.camera.eye.z / view.camera.pupil);
  return counted(pi / 4 * 64 * moved * moved);
}

int steps_of_spectrum(const Slm& slm, const ShowParams& params, double wavelength, ImageSide image,
                      const std::vector<Viewpoint>& from) {
  const double side = std::max(slm.grid.width(), slm.grid.height()), pitch = slm.grid.pitch;
  double steps = least_of_spectrum;
  for (const Viewpoint& view : from) {
    const double z = view.distance;
    if (z == 0 || !is_asked_for(view.kind)) continue;
    const CameraParams& camera = view.camera;
    const double pixel = camera.pixel > 0     ? camera.pixel / magnification(camera, z, image)
                         : camera.binning > 0 ? camera.binning * pitch / params.subpixels
                                              : pitch;
    double resolved = std::max(pixel, wavelength * z / side);
    if (camera.pupil > 0) {
      const double travelled = image == ImageSide::real_image ? z - camera.eye.z : z + camera.eye.z;
      resolved = std::max(resolved, wavelength * std::abs(travelled) / camera.pupil);
    }
    const double steepest = std::min(params.subpixels / (2 * pitch), side / (wavelength * z));
    steps = std::max(steps, 2 * steepest * z * params.bandwidth / resolved);
  }
  return counted(steps);
}

}  // namespace

IlluminationPlan plan_illumination(const Slm& slm, const ShowParams& params, double wavelength, ImageSide image,
                                   const std::vector<Viewpoint>& from, const std::optional<SpectralFilter>& filter) {
  check_ranges(params);
  const Slm with = with_effects_or_own(slm, params.effects);
  const bool has_flicker = with.effects.flicker > 0;
  IlluminationPlan plan;
  const auto need = [&](int count, const std::string& why) {
    if (!plan.why.empty()) plan.why += "; ";
    plan.why += why;
    plan.needed = std::max(plan.needed, count);
  };
  int parts = 1;
  if (params.source_angle > 0) {
    parts = parts_of_source(slm, params, wavelength, from, filter);
    if (parts == 1)
      need(1, fmt::format("one convolution with the picture of the source of {}", format_angle(params.source_angle)));
    else
      need(parts,
           fmt::format("{} parts of the source of {}, each of which moves light by an eighth of the pupil or stop",
                       parts, format_angle(params.source_angle)));
  }
  if (params.bandwidth > 0) {
    const int steps = steps_of_spectrum(slm, params, wavelength, image, from);
    need(steps, fmt::format(
                    "{} wavelengths of the spectrum of {}, each of which moves light by half of what the view resolves",
                    steps, format_length(params.bandwidth)));
  }
  if (has_flicker) need(of_flicker, fmt::format("{} instants of the flicker", of_flicker));

  const bool is_given = params.illumination_states > 0;
  ShowParams taken = params;
  taken.illumination_states = is_given ? params.illumination_states : std::min(plan.needed, most_planned);
  // With one part each state has the whole source, unless the user set the states and only the source is averaged.
  const bool is_shared = parts > 1 || (is_given && params.bandwidth == 0 && !has_flicker);
  if (!is_shared) taken.source_angle = 0;
  plan.states = illumination_states(with, taken, wavelength);
  const int first = plan.states.front().polarisation;
  plan.instants = int(std::count_if(plan.states.begin(), plan.states.end(),
                                    [&](const IlluminationState& state) { return state.polarisation == first; }));
  if (const int polarisations = int(plan.states.size()) / plan.instants; polarisations > 1)
    need(1, fmt::format("{} polarisations that do not interfere, each of which takes these states", polarisations));
  if (!is_shared)
    for (IlluminationState& state : plan.states) state.source.angle = params.source_angle;
  const auto samples_along = [&](int pixels) {  // viewing_need refuses too many
    return int(std::min<int64_t>(int64_t(pixels) * params.subpixels, std::numeric_limits<int>::max()));
  };
  const Grid samples{samples_along(slm.grid.nx), samples_along(slm.grid.ny), slm.grid.pitch / params.subpixels};
  for (const IlluminationState& state : plan.states) check_illumination(samples, params, state);
  return plan;
}

SourcePart widest_part(const IlluminationPlan& plan) {
  const SourcePart& first = plan.states.front().source;
  const SourcePart& last = plan.states.back().source;
  return first.reach() > last.reach() ? first : last;
}

std::string doubt_of(const IlluminationPlan& plan, const ShowParams& params) {
  const int taken = plan.instants;
  if (taken >= plan.needed) return {};
  const std::string limit = params.illumination_states == 0
                                ? fmt::format("the limit is {}", taken)
                                : fmt::format("{} {} given", taken, taken == 1 ? "is" : "are");
  std::string advice = params.source_angle > 0 && params.bandwidth > 0 ? "use a smaller source and a narrower spectrum"
                       : params.source_angle > 0                       ? "use a smaller source"
                                                                       : "use a narrower spectrum";
  if (params.illumination_states > 0 && plan.needed <= most_planned)
    advice = fmt::format("set illumination_states to {}, or to 0 for as many as the view needs", plan.needed);
  else if (plan.needed <= most_given)
    advice += fmt::format(", or set illumination_states to {}", plan.needed);
  return fmt::format("this light needs {} illumination states, {}: the view will look grainy; {}", plan.needed, limit,
                     advice);
}

}  // namespace holotrace
