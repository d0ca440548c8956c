#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "holotrace/base/archive.h"
#include "holotrace/data/members.h"
#include "holotrace/data/params/device.h"
#include "holotrace/data/rates.h"
#include "holotrace/wave/bands.h"
#include "ranks.h"

namespace holotrace {

/// The measured rates by which the plans of a field are chosen. The last bits of the field depend on the plans, so a
/// resumed run, and every rank, uses the rates of the run that began.
struct PlanRates {
  SummationRates processor;
  DeviceRates device;  ///< of the device that sums the field; 0 without one
};

/// The rates of this machine and of the chosen device, which is opened. Equal devices have those of the first one.
/// @throws Error  as open_device does
PlanRates plan_rates(const DeviceChoice& device);

/// Makes this program choose its plans by these rates.
void go_by(const PlanRates& rates);

/// Their names in a journal, and values.
std::map<std::string, double> named_rates(const PlanRates& rates);

/// The rates with those names. @param otherwise  rates for names that are missing, as in the journal of an older version
PlanRates rates_of(const std::map<std::string, double>& named, PlanRates otherwise);

// Messages that ranks exchange about a field made in bands: rank 0 sends a job, its sets and single bands. The other ranks ask
// for a band, send its rows in pieces, and report that it is finished.

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
