#include "holotrace/slm/encode/iterate/descent_job.h"

#include <fmt/format.h>

#include <string>

#include "holotrace/base/fingerprint.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/iterate/iterations.h"

namespace holotrace {
namespace {

void add(Fingerprint& f, const Grid& grid) {
  f.add(grid.nx);
  f.add(grid.ny);
  f.add(grid.pitch);
  f.add(grid.centre_x);
  f.add(grid.centre_y);
}

template <class Value>
void add(Fingerprint& f, const Array2D<Value>& values) {
  f.add(values.nx);
  f.add(values.ny);
  f.add(values.values.data(), values.values.size() * sizeof(Value));
}

void add(Fingerprint& f, const Pupil& pupil) {
  for (const double value : {pupil.centre.x, pupil.centre.y, pupil.centre.z, pupil.diameter}) f.add(value);
}

void add(Fingerprint& f, const TargetPlane& target) {
  f.add(target.z);
  f.add(target.wavelength);
  add(f, target.amplitude);
  add(f, target.weight);
}

void add(Fingerprint& f, const ViewTargets& views) {
  f.add(views.z);
  f.add(views.wavelength);
  add(f, views.window);
  add(f, views.picture);
  for (const Pupil& pupil : views.pupils) add(f, pupil);
  for (const Array2D<float>& amplitude : views.amplitudes) add(f, amplitude);
}

void add(Fingerprint& f, const SlmEffects& effects) {
  for (const CalibrationPoint& point : effects.calibration) {
    f.add(point.phase);
    f.add(point.amplitude);
  }
  for (const double value : {effects.crosstalk, effects.gap_amplitude, effects.gap_phase, effects.flicker})
    f.add(value);
  for (const ZernikeTerm& term : effects.aberration) {
    f.add(term.n);
    f.add(term.m);
    f.add(term.rms);
  }
  for (const auto& map : {effects.phase_map, effects.light_map})  // the names of the effects tell which map it is
    if (map) add(f, *map);
  f.add(effects.dead_fraction);
  f.add(effects.dead_seed);
  for (const DeadPixel& pixel : effects.dead_pixels)
    for (const int value : {pixel.column, pixel.row, pixel.level}) f.add(value);
}

void add(Fingerprint& f, const Slm& slm) {
  add(f, slm.grid);
  f.add(int(slm.modulation));
  f.add(slm.levels);
  for (const double value : {slm.lit_x(), slm.lit_y(), slm.design_wavelength, slm.phase_range}) f.add(value);
  for (const std::string& name : effects_of(slm)) f.add_text(name);
  add(f, slm.effects);
}

}  // namespace

IterationState descent_job(const TargetSet& targets, const Slm& slm, const EncodeParams& params,
                           const std::vector<Hologram>& frames) {
  Fingerprint f;
  constexpr int schedule = 2;  // changes with what updates do
  f.add_text(HOLOTRACE_VERSION);
  f.add(schedule);
  add(f, slm);
  f.add(iterations_of(params));
  f.add(stop_width(params));
  f.add(params.step > 0 ? params.step : sgd_step);
  f.add(params.least_gain);
  f.add(params.planes_per_update);
  f.add(params.subpixels);
  f.add(params.seed);
  for (const TargetPlane& target : targets.planes) add(f, target);
  for (const ViewTargets& views : targets.views) add(f, views);
  if (targets.draw_views)
    for (const double wavelength : wavelengths_of(targets)) add(f, targets.draw_views(0, wavelength));
  for (const Hologram& frame : frames) {
    f.add(frame.levels);
    f.add(int(frame.modulation));
    f.add(frame.wavelength);
    add(f, frame.level);
    add(f, frame.modulus_level);
  }
  return {.job = f.value(),
          .description = fmt::format(
              "{} frame(s) of {} × {} pixels and {} levels at {}, {} target plane(s), {} iterations", frames.size(),
              slm.grid.nx, slm.grid.ny, frames.front().levels, format_length(frames.front().wavelength),
              targets.planes.size() + targets.views.size(), iterations_of(params))};
}

}  // namespace holotrace
