#pragma once

#include <cstdint>
#include <string>

namespace holotrace {

/// The name of a 64-bit ARM processor by its register MIDR_EL1 (Arm Architecture Reference Manual: implementer in bits
/// 24–31, part in bits 4–15), such as "ARM Neoverse-N1"; of others "ARM processor 0x99, part 0x123".
std::string arm_processor_name(uint64_t midr);

}  // namespace holotrace
