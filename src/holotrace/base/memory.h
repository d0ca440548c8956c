#pragma once

#include <string_view>

namespace holotrace {

/// Bytes of physical memory that this machine has.
double physical_memory();

/// Checks memory before a large allocation; the system would otherwise kill the program without a message.
/// @throws Error if this machine has less than `bytes` of memory; the message names what needs them (`what`)
void require_memory(double bytes, std::string_view what);

}  // namespace holotrace
