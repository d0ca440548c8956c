#pragma once

#include <cstdint>

#include "holotrace/data/job.h"

namespace holotrace {

/// The parameters by which the field of waves of a job is encoded: iterations use the camera's distances unless the job names others.
EncodeParams encoding_of(const Job& job);

/// A fingerprint of all that the results of a run depend on: times of a film with the same one have the same results.
uint64_t cause_of_results(Job job);

/// A fingerprint of all that the holograms of waves of a run depend on: only what the camera does may differ.
uint64_t cause_of_waves(const Job& job);

}  // namespace holotrace
