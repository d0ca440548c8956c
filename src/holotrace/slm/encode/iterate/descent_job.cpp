#include "holotrace/slm/encode/iterate/descent_job.h"

#include <fmt/format.h>

#include <string>

#include "holotrace/base/fingerprint.h"
#include "holotrace/base/units.h"
#include "holotrace/data/members.h"
#include "holotrace/data/params/encode.h"

namespace holotrace {
IterationState descent_job(const TargetSet& targets, const Slm& slm, const EncodeParams& params,
                           const std::vector<Hologram>& frames) {
  constexpr int schedule = 2;  // changes with what updates do
  Slm panel = slm;             // without its names
  panel.name = panel.preset = panel.source = "";
  panel.own_effects.clear();
  BasicWriter<FnvHash> hash;
  hash(std::string(HOLOTRACE_VERSION), schedule, panel, iterations_of(params), stop_width(params),
       params.step > 0 ? params.step : sgd_step, params.least_gain, params.planes_per_update, params.subpixels,
       params.seed, targets.planes, targets.views);
  if (targets.draw_views)
    for (const double wavelength : wavelengths_of(targets)) hash(targets.draw_views(0, wavelength));
  for (const Hologram& frame : frames)
    hash(frame.levels, frame.modulation, frame.wavelength, frame.level, frame.modulus_level);
  return {.job = hash.sink.value(),
          .description = fmt::format(
              "{} frame(s) of {} × {} pixels and {} levels at {}, {} target plane(s), {} iterations", frames.size(),
              slm.grid.nx, slm.grid.ny, frames.front().levels, format_length(frames.front().wavelength),
              targets.planes.size() + targets.views.size(), iterations_of(params))};
}

}  // namespace holotrace
