#pragma once

#include <memory>
#include <string>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/sources.h"
#include "holotrace/wave/shared/placed_field.h"
#include "holotrace/wave/summation.h"

namespace holotrace {

/// Field on the panel of a set of sources, by the method that the parameters name:
///
/// - `exact`: wave by wave in double precision (sum_exact.h); the reference;
/// - `tiled`: tile by tile, as matrix products (summation.h);
/// - `planes`: by a non-uniform FFT in every tile (summation.h);
/// - `layers`: by slices of depth (layers/sum_layers.h);
/// - `auto`: `tiled` or `planes`, whichever the cost model predicts to be faster within the tolerance; `exact` if
///   neither meets it. Never `layers`, which cannot limit waves to their boxes.
///
/// On an OpenCL device (SynthesizeParams::device), `auto`, `tiled` and `planes` sum within the same tolerance
/// (tiles/device_tiles.h, planes/device_planes.h); the other methods are for the processor. All devices at once share the rows
/// of the panel; the bytes are those of one of them. The bytes differ from the processor's and between devices. The
/// device `auto` is the one that is expected to be fastest by measured rates (shared/stage_on_device.h), transfers counted, or
/// the processor if that is. If the device fails, the processor takes over, with a warning.
///
/// Every method sums waves with an amplitude in each tile of the panel (TileAmplitudes) tile by tile. The cost is then
/// that of the waves·pixels that they light.
///
/// Waves that converge to points in front of the panel are summed apart, as those of their mirror image behind it. So are
/// astigmatic ones: in tiles, whatever the method, or wave by wave. They need no device. The method `layers` has slices on both sides,
/// and takes astigmatic waves for spherical ones of their mean curvature, with a warning. The field has the label of the waves.
///
/// @param sources  waves from z < 0 or to z > 0 [m]
/// @param grid     panel pixels: nx, ny, pitch [m]
/// @return         complex amplitude, shape (ny, nx) [√(W/m²)]
/// @throws Error   for a device that is not there, or fails; for no sources, a source on the panel, or a tolerance outside (0, 1)
///
/// Facts: `waves`, `waves_pixels`, `method`, for `auto` also `why`; then those of the method. Warning: waves whose box
/// misses the panel.
Field synthesize(const Sources& sources, const Grid& grid, const SynthesizeParams& params,
                 const Observer& observer = {});

/// The same for a field that another stage takes, with the name, frame and cone of the sources. It stays on the device that
/// sums it, if that has memory for it. Transfers: the waves, and 4 bytes per row for its energy. If the device `auto` fails
/// later, the processor sums the waves again. With waves from in front of the panel, or astigmatic ones, the field is on the
/// processor.
/// @param sources  kept for that, without a copy, as long as the field is only on the device
/// @param returns  whether the caller needs the field on the processor, too: its return then counts for `auto`
PlacedField synthesize_placed(std::shared_ptr<const Sources> sources, const Grid& grid, const SynthesizeParams& params,
                              const Observer& observer = {}, bool returns = false);

/// Forecast of `synthesize` on the processor, by the methods auto, tiled or planes, without the sum: the seconds of all waves.
SumForecast forecast_synthesis(const Sources& sources, const Grid& grid, const SynthesizeParams& params);

/// The name of a method in flags and scene files.
std::string method_name(SynthesisMethod method);

/// The device that `auto` stands for with these sources; another choice stays as it is.
DeviceChoice chosen_device(const Sources& sources, const Grid& grid, const SynthesizeParams& params);

/// The work of a summation: pixels in the boxes of the sources, added up over all sources [waves·pixels].
int64_t waves_pixels(const Sources& sources, const Grid& grid);

}  // namespace holotrace
