#include "holotrace/trace/trace_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/geometry/light_surfaces.h"

namespace holotrace {

namespace {

/// Says how far the rays went, and what would make them meet a mesh.
std::string unseen_sentence(const Grid& panel, double wavelength, const TraceParams& params, int64_t rays) {
  const bool is_raster = params.strategy != Strategy::gather && params.pattern == Pattern::grid;
  if (is_raster && params.field_of_view > 0)
    return fmt::format(
        "none of {} rays from the panel met a mesh: the raster sees {} to each side of the axis; move the "
        "scene onto the axis or widen field_of_view",
        rays, format_angle(params.field_of_view));
  return fmt::format(
      "none of {} rays from the panel met a mesh: a panel of pitch {} sees only {} to each side of the axis at {}; {}",
      rays, format_length(panel.pitch), format_angle(std::asin(acceptance_sine(wavelength, panel.pitch))),
      format_length(wavelength),
      is_raster ? "move the scene onto the axis or set field_of_view"
                : "move the scene onto the axis or take a panel of finer pitch");
}

/// The medium that fills all space behind the panel, through which light from infinitely far away does not come.
const Medium* medium_without_end(const Scene& scene) {
  const auto found = std::find_if(scene.media.begin(), scene.media.end(),
                                  [](const Medium& medium) { return medium.is_open && !medium.box; });
  return found != scene.media.end() ? &*found : nullptr;
}

bool has_light_from_afar(const Scene& scene) {
  return scene.environment || max_component(scene.background) > 0 ||
         std::any_of(scene.lights.begin(), scene.lights.end(),
                     [](const Light& light) { return std::holds_alternative<DirectionalLight>(light); });
}

}  // namespace

std::string dark_sentence(const Scene& scene) {
  if (const Medium* medium = medium_without_end(scene); medium && has_light_from_afar(scene))
    return fmt::format(
        "every first hit is dark: the medium \"{}\" has no end behind the panel, so light from infinitely far away "
        "reaches nothing there, unless it comes from the viewer's side; give the medium a box",
        medium->name);
  if (scene.lights.empty()) return "every first hit is dark; add lights, emission or a background to the scene";
  return "every first hit is dark: the scene's lights do not reach the surfaces that the panel sees; move them, or add "
         "others, emission or a background";
}

namespace {

/// Warns if points are far brighter than surfaces, or the reverse. An 8-bit picture in linear light has 256
/// levels: what is a thousand times dimmer than its white is black.
void warn_of_brightness(double points, double surfaces, const Observer& observer) {
  constexpr double most = 1000;
  if (!(points > 0 && surfaces > 0)) return;
  if (points > most * surfaces)
    observer.warn(fmt::format(
        "the luminous points are {:.2g} times as bright as the surfaces (mean radiance {:.2g} and {:.2g} "
        "W/m²/sr), so the surfaces appear black; multiply the points' amplitude by about {:.2g} (its square "
        "is their radiance)",
        points / surfaces, points, surfaces, std::sqrt(surfaces / points)));
  if (surfaces > most * points)
    observer.warn(
        fmt::format("the surfaces are {:.2g} times as bright as the luminous points (mean radiance {:.2g} and {:.2g} "
                    "W/m²/sr), so the points cannot be seen; multiply their amplitude by about {:.2g} (its square is "
                    "their radiance)",
                    surfaces / points, surfaces, points, std::sqrt(surfaces / points)));
}

}  // namespace

void warn_of_findings(const TraceFindings& findings, const Scene& scene, const Grid& panel, double cone,
                      const TraceParams& params, const Observer& observer) {
  if (has_surfaces(scene)) {
    if (findings.first_hits == 0)
      observer.warn(unseen_sentence(panel, cone, params, findings.rays));
    else if (findings.is_dark)
      observer.warn(dark_sentence(scene));
  }
  warn_of_brightness(findings.points.mean(), findings.surfaces.mean(), observer);
  if (params.phase == SourcePhase::laser && !findings.has_laser)
    observer.warn("no light of the scene is a laser: under the phase laser its waves have random phases");
}

}  // namespace holotrace
