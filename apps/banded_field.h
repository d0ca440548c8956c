#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "holotrace/base/archive.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/members.h"
#include "holotrace/data/params/device.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/rates.h"
#include "holotrace/data/sources.h"
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

/// A field that `holotrace field` makes band by band (wave/bands.h, io/field/field_bands.h).
struct BandedField {
  std::string output;         ///< path of the .h5 file; one per name of the sets: NAME, NAME_2, …
  std::vector<Sources> sets;  ///< sets of waves in the requested frame, one per wavelength and name
  Grid panel;
  SynthesizeParams params;
  double memory = 0;  ///< memory that each process may use [bytes]
  int threads = 0;    ///< threads of each process; 0: its share of the cores
  bool is_quiet = false;
};

/// Makes the files, or resumes what an earlier run left unfinished. With several ranks, each takes the next free band.
/// Rank 0, which calls this, writes all bands. The bytes are the same for any number of ranks.
/// @throws Error  as plan_bands, synthesize_band and FieldBands do, on any rank; finished bands are kept
void make_field_in_bands(BandedField field, Ranks& ranks, const Observer& observer);

/// The part of every other rank in a job that rank 0 has sent: makes the bands that rank 0 asks for until it reports the end.
void serve_bands(const Ranks& ranks, const Ranks::Message& job);

}  // namespace holotrace
