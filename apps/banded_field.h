#pragma once

#include <string>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/sources.h"
#include "ranks.h"

namespace holotrace {

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
