#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/run/viewpoints.h"

namespace holotrace {

/// What `run` refuses before its first stage.
/// @throws Error  for no wavelength, one that is not above 0 or given twice, fewer than 1 frame, a camera without
///                distances or with a sweep or noise that cannot be, and a job that does not fit in the machine's
///                memory
void check_job(const Job& job);

/// @throws Error  where a run with that many sets does not fit in the machine's memory
void check_memory(const Job& job, size_t sets);

/// IlluminationStates of the light on each hologram of a wavelength, as view_hologram will plan them: with the stop that the encoder
/// names (slm/encode/stop.h).
int64_t states_at(const Job& job, double wavelength, const std::vector<Viewpoint>& from);

/// The most of all wavelengths.
int64_t most_states(const Job& job, const std::vector<Viewpoint>& from);

}  // namespace holotrace
