#pragma once

#include <string>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/sources.h"
#include "ranks.h"

namespace holotrace {

/// What `holotrace field` makes band by band (wave/bands.h, io/field/field_bands.h).
struct BandedField {
  std::string output;         ///< .h5; one per name of the sets: NAME, NAME_2, …
  std::vector<Sources> sets;  ///< in the frame asked for, one per wavelength and name
  Grid panel;
  SynthesizeParams params;
  double memory = 0;  ///< that each process may use [bytes]
  int threads = 0;    ///< of each process; 0: its share of the cores
  bool is_quiet = false;
};

/// Makes the files, or finishes what an earlier run left unfinished. With several ranks each takes the next band that
/// no other has, and rank 0, which calls this, writes them all: the bytes are the same for any number of ranks.
/// @throws Error  as plan_bands, synthesize_band and FieldBands do, on whichever rank; finished bands stay
void make_field_in_bands(BandedField field, Ranks& ranks, const Observer& observer);

/// What every other rank does: makes the bands that rank 0 asks for until it says that all is done.
void serve_bands(Ranks& ranks);

/// Lets the other ranks go, or ends them where they are in the midst of a work that has failed here.
void dismiss_ranks(Ranks& ranks, int exit_code);

}  // namespace holotrace
