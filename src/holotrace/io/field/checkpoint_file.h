#pragma once

#include <optional>
#include <string>

#include "holotrace/data/checkpoint.h"

namespace holotrace {

/// Writes a state of iterations, completely or not at all: HDF5 with the datasets "numbers" (float64) and "arrays"
/// (float32; array, row, column), and the attributes "job", "description" and "updates".
/// @throws Error  if a file cannot be written, or for arrays of different sizes
void save_checkpoint(const std::string& path, const IterationState& state);

/// The state in a file; none if there is no such file.
/// @param job  fingerprint and description of the job that wants it
/// @throws Error  for the state of another job, naming both, and for a file that is not a checkpoint
std::optional<IterationState> load_checkpoint(const std::string& path, const IterationState& job);

}  // namespace holotrace
