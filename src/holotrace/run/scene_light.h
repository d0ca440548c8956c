#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/job.h"
#include "holotrace/data/sources.h"
#include "holotrace/data/triangles.h"

namespace holotrace {

/// A scene's light on its way to the panel: sets of waves, with the strategy gather the fields themselves, or with the
/// method of synthesis triangles the surfaces that shine. One of the three is there.
struct SceneLight {
  std::vector<Sources> sources;              ///< one per set
  std::vector<std::vector<Field>> gathered;  ///< [set][frame]
  std::vector<Triangles> triangles{};        ///< one per set

  size_t sets() const { return sources.size() + gathered.size() + triangles.size(); }
  double wavelength(size_t set) const;  ///< [m]
  bool is_dark(size_t set) const;       ///< has no wave and no triangle that shines
  bool has_random_phase() const;
};

/// Traces the job's scene by its strategy, or shades its triangles where the method of synthesis is theirs.
SceneLight trace_light(const Job& job, const Observer& observer = {});

/// Fields of one frame, each a layer or light at a wavelength, in the order of the sets; a set without waves is dark.
/// @throws Error  as synthesize does; if no set has a wave, and for a frame that was not gathered
std::vector<Field> fields_of_frame(const SceneLight& light, uint32_t frame, const Grid& panel,
                                   const SynthesizeParams& params, const Observer& observer = {});

/// Fields in stacks of one name, each in the order given: [name][wavelength].
template <class Real>
std::vector<std::vector<BasicField<Real>>> group_by_name(std::vector<BasicField<Real>> fields);

}  // namespace holotrace
