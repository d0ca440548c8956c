#include "holotrace/base/arm_processor.h"

#include <fmt/format.h>

namespace holotrace {
namespace {

struct ArmPart {
  uint32_t implementer, part;
  const char* name;
};

// As lscpu of util-linux names them.
constexpr ArmPart arm_parts[] = {
    {0x41, 0xd03, "ARM Cortex-A53"},  {0x41, 0xd05, "ARM Cortex-A55"},         {0x41, 0xd07, "ARM Cortex-A57"},
    {0x41, 0xd08, "ARM Cortex-A72"},  {0x41, 0xd09, "ARM Cortex-A73"},         {0x41, 0xd0a, "ARM Cortex-A75"},
    {0x41, 0xd0b, "ARM Cortex-A76"},  {0x41, 0xd0c, "ARM Neoverse-N1"},        {0x41, 0xd0d, "ARM Cortex-A77"},
    {0x41, 0xd40, "ARM Neoverse-V1"}, {0x41, 0xd41, "ARM Cortex-A78"},         {0x41, 0xd42, "ARM Cortex-A78AE"},
    {0x41, 0xd44, "ARM Cortex-X1"},   {0x41, 0xd47, "ARM Cortex-A710"},        {0x41, 0xd48, "ARM Cortex-X2"},
    {0x41, 0xd49, "ARM Neoverse-N2"}, {0x41, 0xd4d, "ARM Cortex-A715"},        {0x41, 0xd4e, "ARM Cortex-X3"},
    {0x41, 0xd4f, "ARM Neoverse-V2"}, {0x41, 0xd84, "ARM Neoverse-V3"},        {0x41, 0xd8e, "ARM Neoverse-N3"},
    {0x46, 0x001, "Fujitsu A64FX"},   {0x48, 0xd01, "HiSilicon TaiShan-v110"}, {0xc0, 0xac3, "Ampere-1"},
    {0xc0, 0xac4, "Ampere-1a"},
};

}  // namespace

std::string arm_processor_name(uint64_t midr) {
  const uint32_t implementer = midr >> 24 & 0xff, part = midr >> 4 & 0xfff;
  for (const ArmPart& known : arm_parts)
    if (known.implementer == implementer && known.part == part) return known.name;
  return fmt::format("ARM processor {:#04x}, part {:#05x}", implementer, part);
}

}  // namespace holotrace
