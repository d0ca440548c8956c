#pragma once

#include <string_view>

namespace holotrace {

/// Bytes of physical memory that this machine has.
double physical_memory();

/// @throws Error if `bytes` are more than this machine has, saying what needs them: a check to make
///         before a large allocation, where the system would stop the program without a word.
void require_memory(double bytes, std::string_view what);

}  // namespace holotrace
