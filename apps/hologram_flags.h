#pragma once

#include <set>
#include <string>

#include "flags.h"
#include "holotrace/data/params/hologram.h"
#include "holotrace/io/field/hologram_file.h"

namespace holotrace {

/// Adds the flags that say what a hologram without metadata is, except the fields in `without`.
inline void add_hologram_flags(CLI::App& command, Flags& flags, const std::set<std::string>& without = {}) {
  flags.add(command, HologramParams(), without, "Holograms of other programs");
}

/// Gives the values of those flags to the functions that read holograms. `flags` must outlive what is returned.
inline CompleteHologram apply_to_hologram(const Flags& flags) {
  return [&flags](HologramParams& params) { flags.apply(params); };
}

}  // namespace holotrace
