#pragma once

#include <cstdint>
#include <string>

#include "holotrace/base/pack.h"
#include "holotrace/data/sources.h"
#include "holotrace/wave/bands.h"
#include "plan_rates.h"
#include "rank_tags.h"

// Messages that ranks exchange about a field made in bands: rank 0 sends a job, its sets and single bands. The other ranks ask
// for a band, send its rows in pieces, and report that it is finished.

namespace holotrace {

/// Header of a message of rows: the rows of band `band`, from row `first_row` of the panel on.
struct RowsHead {
  uint64_t band = 0;
  int32_t first_row = 0, rows = 0;
};

struct JobHead {
  Grid panel;
  SynthesisMethod method{};
  double tolerance = 0;
  DeviceChoice device{};
  int32_t threads = 0, sets = 0;
  PlanRates rates;  ///< plans are chosen by these rates: the same on every rank
};

struct BandOrder {
  uint64_t index = 0;
  Band band;
};

inline std::string pack_set(const Sources& set) {
  std::string bytes;
  pack(bytes, set.wavelength);
  pack(bytes, set.cone_wavelength);
  pack(bytes, set.tiles.columns);
  pack(bytes, set.tiles.rows);
  pack(bytes, set.waves);
  pack(bytes, set.second_foci);
  pack(bytes, set.tiles.values);
  return bytes;
}

inline Sources unpack_set(const std::string& bytes) {
  Sources set;
  Unpacker unpacker(bytes);
  unpacker.get(set.wavelength);
  unpacker.get(set.cone_wavelength);
  unpacker.get(set.tiles.columns);
  unpacker.get(set.tiles.rows);
  unpacker.get(set.waves);
  unpacker.get(set.second_foci);
  unpacker.get(set.tiles.values);
  return set;
}

}  // namespace holotrace
