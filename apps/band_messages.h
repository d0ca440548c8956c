#pragma once

#include <cstdint>
#include <string>

#include "holotrace/base/archive.h"
#include "holotrace/data/members.h"
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

}  // namespace holotrace
