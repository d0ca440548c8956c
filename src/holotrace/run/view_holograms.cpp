#include "holotrace/run/view_holograms.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/run/illumination_plan.h"
#include "holotrace/run/viewing.h"

namespace holotrace {
namespace {

IlluminationPlan plan_of(const Hologram& hologram, const Viewing& v, double wavelength) {
  return plan_illumination(v.slm, v.show, wavelength, hologram.image, v.from, hologram.filter);
}

// Memory for the light that leaves the panel, its propagation, and the sums of all views, for `sets` colours and names.
void check_memory(const Hologram& hologram, const Viewing& viewing, double wavelength, size_t sets) {
  const IlluminationPlan plan = plan_of(hologram, viewing, wavelength);
  const ViewingNeed need = viewing_need(viewing, {wavelength}, hologram.image, hologram.filter, widest_part(plan));
  const size_t count = viewing.from.size();
  const double views = viewing_bytes(need.columns * need.rows, count, double(sets), int64_t(plan.states.size()));
  require_memory(need.shown + need.passing + views, fmt::format("{} view(s) of {} × {} pixels", count,
                                                                std::llround(need.columns), std::llround(need.rows)));
}

}  // namespace

SeriesViews view_holograms(const HologramSeries& holograms, const ViewingParams& params, Report& report,
                           const StageObserver& watch) {
  require(holograms.count > 0, "expected one hologram or more to view, got none");
  const std::vector<Viewpoint>& from = params.from;
  std::vector<CombinedViews> sums(from.size());
  std::optional<RepeatedStages> repeat;
  std::set<std::pair<double, std::string>> kinds;  // views that are summed separately
  for (size_t i = 0; i < holograms.count; ++i) {
    PanelHologram one = holograms.at(i);
    const Hologram& hologram = one.hologram;
    const Viewing viewing{std::move(one.slm), params.show, params.propagation, from};
    const std::vector<double> wavelengths = wavelengths_shown(hologram, params.show);
    for (const double wavelength : wavelengths)
      if (kinds.emplace(wavelength, hologram.label.name).second)
        check_memory(hologram, viewing, wavelength, kinds.size());
    if (!repeat) {
      const int64_t colours = int64_t(holograms.count * wavelengths.size());
      const int64_t states = int64_t(plan_of(hologram, viewing, wavelengths.front()).states.size());
      repeat.emplace(colours, states, colours * viewing_calls(states, from), report, watch);
    }
    view_hologram(hologram, viewing, *repeat, sums);
  }
  SeriesViews seen{expose_series(from, sums, ViewKind::distance, params.camera),
                   expose_series(from, sums, ViewKind::sweep, params.camera),
                   expose_series(from, sums, ViewKind::eye, params.camera)};
  report_sweep(from, seen.sweep, *repeat);
  return seen;
}

}  // namespace holotrace
