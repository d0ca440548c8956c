#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/run/viewpoints.h"

namespace holotrace {

/// Checks a job before the first stage of `run`.
/// @throws Error  for no wavelength, one that is not above 0 or given twice, fewer than 1 frame, a camera without
///                distances or with an impossible sweep or noise, and a job that does not fit in the machine's
///                memory
void check_job(const Job& job);

/// @throws Error  if a run with that many sets does not fit in the machine's memory
void check_memory(const Job& job, size_t sets);

/// Number of illumination states per hologram of a wavelength [m], as view_hologram will plan them, with the stop that
/// the encoder names (slm/encode/stop.h).
int64_t states_at(const Job& job, double wavelength, const std::vector<Viewpoint>& from);

/// The largest number of states among all wavelengths.
int64_t most_states(const Job& job, const std::vector<Viewpoint>& from);

}  // namespace holotrace
