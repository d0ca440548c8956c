#pragma once

#include <cstdint>

#include "holotrace/data/job.h"

namespace holotrace {

/// The parameters by which the field of waves of a job is encoded: iterations use the camera's distances unless the job names others.
EncodeParams encoding_of(const Job& job);

/// A fingerprint of all that the results of a run depend on: times of a film with the same one have the same results.
uint64_t cause_of_results(Job job);

/// A fingerprint of all that the holograms of waves of a run depend on: only what the camera does may differ. Waves show job.scene
/// alone: its moments do not matter to them.
uint64_t cause_of_waves(const Job& job);

/// A fingerprint of all that the light for the eyes of a job depends on, but for their places. 0 stands for none.
uint64_t cause_of_eye_light(Job job);

/// @throws Error  for a time of a film whose wavelengths differ from those of the first time; and, if its iterations go on from the time
///                before, for another number of frames, or holograms that do not aim at the light of the scene. Rolling frames need
///                such iterations.
void check_time_of_film(const Job& job, const Job& first, bool from_last);

}  // namespace holotrace
