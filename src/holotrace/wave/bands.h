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

/// The pixels of a band, as a panel of their own that lies where they lie.
Grid band_of(const Grid& panel, int first_row, int end_row);

/// Cuts the fields of sets of waves into bands: 64 or more per panel where its rows allow, of a height that is a
/// multiple of 128 rows, the tallest tile of the tile-separable sum, except where a row of panel tiles
/// (TileAmplitudes) or the panel ends. They depend on nothing but these arguments: not on threads or on how many
/// processes share them.
///
/// @param memory  that a process may use [bytes], see band_memory
/// @throws Error  where the memory does not hold the waves and 128 rows, telling how much does
std::vector<Band> plan_bands(const std::vector<Sources>& sets, const Grid& panel, const SynthesizeParams& params,
                             double memory);

/// Most memory that a process needs for one band of that many rows [bytes]: 170 MB for the program with its libraries;
/// 340 bytes per wave, kept, read from a file, chosen for a band and made ready for the sum, and 16 bytes per wave and
/// panel tile; 8 bytes per sample of the band, 24 by `auto`, which may turn to `exact`; for `exact` 512 bytes per
/// column; for `auto` and `planes` 15 MB for each of 16 threads: where there are more, add theirs.
double band_memory(const std::vector<Sources>& sets, const Grid& panel, const SynthesizeParams& params, int rows);

/// @throws Error unless the method sums waves band by band: auto, tiled, planes or exact.
void check_band_method(const SynthesizeParams& params);

/// How many waves light no pixel of the panel.
int64_t missed_waves(const Sources& sources, const Grid& panel);

/// What each band takes of the whole work, for progress: the waves·pixels that boxes hold in it, and 300 for each
/// pixel that is written (8 bytes at about 1 GB/s while waves·pixels are summed at 40e9/s). Adds up to 1.
std::vector<double> band_shares(const std::vector<Sources>& sets, const Grid& panel, const std::vector<Band>& bands);

/// The field of a set of waves on a band of the panel, by synthesize on its rows. The error is within the tolerance in
/// each band, and so on the panel. Waves without light there are left out; a band without light is 0.
///
/// @return        complex amplitude, shape (band.rows(), nx) [√(W/m²)]: the panel's rows to rounding (exact) or within
///                the tolerance, the same bytes for the same band on any number of threads
/// @throws Error  as synthesize does
Field synthesize_band(const Sources& sources, const Grid& panel, const Band& band, const SynthesizeParams& params,
                      const Observer& observer = {});

}  // namespace holotrace
