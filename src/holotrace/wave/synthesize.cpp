#include "holotrace/wave/synthesize.h"

#include "holotrace/base/error.h"
#include "holotrace/wave/spherical_wave_kernel.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/sum_tiled.h"
#include "holotrace/wave/tile_error.h"

namespace holotrace {
namespace {

void report_boxes(const Sources& sources, const Grid& grid, const Observer& observer) {
  const double tangent = acceptance_tangent(sources.wavelength, grid.pitch);
  int64_t pixels = 0, missed = 0;
  for (const Source& source : sources.waves) {
    const PixelBox box = lit_box(source, grid, tangent);
    pixels += box.pixels();
    missed += box.is_empty();
  }
  observer.fact("waves", int64_t(sources.waves.size()));
  observer.fact("waves_pixels", pixels);
  if (missed > 0)
    observer.warn(fmt::format(
        "{} of {} waves reach no pixel at an angle that the panel can hold (half angle {}); move them nearer to the "
        "axis "
        "or farther from the panel",
        missed, sources.waves.size(), format_angle(std::asin(acceptance_sine(sources.wavelength, grid.pitch)))));
}

}  // namespace

int64_t waves_pixels(const Sources& sources, const Grid& grid) {
  int64_t sum = 0;
  const double tangent = acceptance_tangent(sources.wavelength, grid.pitch);
  for (const Source& source : sources.waves) sum += lit_box(source, grid, tangent).pixels();
  return sum;
}

Field synthesize(const Sources& sources, const Grid& grid, const SynthesizeParams& params, const Observer& observer) {
  check_grid(grid);
  check_sources(sources);
  require(!sources.waves.empty(), "expected at least one source, got none; is the scene lit and in view?");
  require(params.tolerance > 0 && params.tolerance < 1, "expected a tolerance in (0, 1), got {}", params.tolerance);
  report_boxes(sources, grid, observer);

  SynthesisMethod method = params.method;
  if (method == SynthesisMethod::automatic) {
    const TileChoice choice = choose_tile(prepare_waves(sources, grid), grid, sources.wavelength, params.tolerance);
    method = choice.meets_tolerance ? SynthesisMethod::tiled : SynthesisMethod::exact;
    observer.fact("why", fmt::format("tiles of {}x{} are expected to be off by {:.1e}, the tolerance is {:.1e}",
                                     choice.tile.columns, choice.tile.rows, choice.error, params.tolerance));
  }
  if (method == SynthesisMethod::exact) {
    observer.fact("method", std::string("exact"));
    return convert<float>(sum_exact(sources, grid, observer));
  }
  observer.fact("method", "tiled on " + sum_tiled_instruction_set());
  return sum_tiled(sources, grid, params.tolerance, observer);
}

}  // namespace holotrace
