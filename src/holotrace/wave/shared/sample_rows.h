#pragma once

#include <cstddef>

#include "holotrace/opencl/device.h"

namespace holotrace {

/// Work items of a group along a row of samples.
inline constexpr size_t samples_of_group = 64;

/// One work item for each sample of so many rows: get_global_id(0) is its column, or beyond the last one, and
/// get_global_id(1) its row. Their place in memory is that of sample_place_kernel.h, also for more than 2³¹ samples.
inline WorkSize items_of_rows(int columns, int rows) {
  return {(size_t(columns) + samples_of_group - 1) / samples_of_group, size_t(rows), samples_of_group, 1};
}

/// One group of work items for each row, which adds it up.
inline WorkSize groups_of_rows(int rows) { return {1, size_t(rows), samples_of_group, 1}; }

}  // namespace holotrace
