#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Whole rows [first_row, end_row) of the field of one set of waves.
struct Band {
  int set = 0, first_row = 0, end_row = 0;
  int rows() const { return end_row - first_row; }
  bool operator==(const Band&) const = default;
};

/// The pixels of a band as a grid of its own, at the same places as on the panel.
Grid band_of(const Grid& panel, int first_row, int end_row);

/// Cuts the fields of sets of waves into bands: 64 or more per panel, if it has enough rows. A band's height is a
/// multiple of 128 rows, the tallest tile of the tile-separable sum; it is smaller only where a row of panel tiles
/// (TileAmplitudes) or the panel ends. The bands depend on these arguments only, not on the number of threads or of
/// processes.
///
/// @param memory  memory that a process may use [bytes], see band_memory
/// @throws Error  if the memory cannot hold the waves and 128 rows; the message gives the memory needed
std::vector<Band> plan_bands(const std::vector<Sources>& sets, const Grid& panel, const SynthesizeParams& params,
                             double memory);

/// Most memory that a process needs for one band of `rows` rows [bytes]: 50 MB for the program with its libraries;
/// 340 bytes per wave (stored, read from a file, selected for a band, prepared for the sum), on devices more
/// (host_bytes_per_wave), and 16 per panel tile; 8 bytes per sample of the band, 24 for `auto`, which may fall back to `exact`; for `exact` 512 bytes per
/// column; for `auto` and `planes` 27 MB for each of 16 threads. With more threads, add as much for each.
double band_memory(const std::vector<Sources>& sets, const Grid& panel, const SynthesizeParams& params, int rows);

/// @throws Error  unless the method can sum waves band by band: auto, tiled, planes or exact
void check_band_method(const SynthesizeParams& params);

/// Number of waves that light no pixel of the panel.
int64_t missed_waves(const Sources& sources, const Grid& panel);

/// Share of each band in the whole work, for progress reports: its waves·pixels (pixels in the boxes of the waves),
/// plus 300 per pixel written (8 bytes at about 1 GB/s, against 40e9 waves·pixels/s). The shares add up to 1.
std::vector<double> band_shares(const std::vector<Sources>& sets, const Grid& panel, const std::vector<Band>& bands);

/// The field of a set of waves on one band of the panel: synthesize on the band's rows. Each band meets the tolerance,
/// so the panel meets it too. Waves that do not light the band are left out; a band without light is 0.
///
/// @return        complex amplitude, shape (band.rows(), nx) [√(W/m²)]; equal to the panel's rows to rounding (exact)
///                or within the tolerance; the same bytes on any number of threads
/// @throws Error  as synthesize does
Field synthesize_band(const Sources& sources, const Grid& panel, const Band& band, const SynthesizeParams& params,
                      const Observer& observer = {});

}  // namespace holotrace
