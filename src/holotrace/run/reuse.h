#pragma once

#include <cstdint>

#include "holotrace/data/job.h"

namespace holotrace {

/// The parameters by which the field of waves of a job is encoded: iterations use the camera's distances unless the job names others.
EncodeParams encoding_of(const Job& job);

/// @throws Error  if the holograms of a job are not found by iterations that go on from those of the last time of a film
void check_from_last(const Job& job);

/// A fingerprint of all that the results of a run depend on: times of a film with the same one have the same results.
uint64_t cause_of_results(Job job);

/// A fingerprint of all that the holograms of waves of a run depend on: only what the camera does may differ. Waves show job.scene
/// alone: its moments do not matter to them.
uint64_t cause_of_waves(const Job& job);

}  // namespace holotrace
