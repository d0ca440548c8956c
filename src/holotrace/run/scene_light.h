#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/job.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/sources.h"
#include "holotrace/wave/synthesize.h"

namespace holotrace {

/// A scene's light on its way to the panel, in one of three forms: sets of waves; with the strategy gather the fields;
/// or, with the synthesis method triangles, the emitting surfaces.
struct SceneLight {
  std::vector<Sources> sources;              ///< one per set
  std::vector<std::vector<Field>> gathered;  ///< [set][frame]
  std::vector<Triangles> triangles{};        ///< one per set
  bool may_be_dark = false;  ///< whether all sets may be dark, as at times of a film; else that is an error

  size_t sets() const { return sources.size() + gathered.size() + triangles.size(); }
  double wavelength(size_t set) const;  ///< [m]
  bool is_dark(size_t set) const;       ///< whether it has no wave and no emitting triangle
  bool has_random_phase() const;
};

/// Traces the job's scene by its strategy, or shades its triangles if the synthesis method is `triangles`.
SceneLight trace_light(const Job& job, const Observer& observer = {});

/// Places of the scene that the middle of the panel sees, also in mirrors and through glass, with a rough brightness: the
/// sources of a coarse raster and one path each, over the window of the nearest view. For programs that look up the depth
/// of what a view shows, where a job makes no sources.
Sources points_of_scene(const Job& job);

/// Fields of one frame, one for each path group or light and wavelength, in the order of the sets. A set without waves
/// is dark.
/// @throws Error  as synthesize does; if no set has a wave; and for a frame that was not gathered
std::vector<Field> fields_of_frame(const SceneLight& light, uint32_t frame, const Grid& panel,
                                   const SynthesizeParams& params, const Observer& observer = {});

/// The same for fields that another stage takes: those that a device sums stay there (synthesize_placed). Until they are on
/// the processor, they refer to the waves of `light`, which must live as long.
/// @param returns  whether they are results, too: they are then on the processor as well
std::vector<PlacedField> placed_fields_of_frame(const SceneLight& light, uint32_t frame, const Grid& panel,
                                                const SynthesizeParams& params, const Observer& observer = {},
                                                bool returns = false);

/// Fields grouped by name, each group in the order given: [name][wavelength].
template <class Real>
std::vector<std::vector<BasicField<Real>>> group_by_name(std::vector<BasicField<Real>> fields);

/// A number that identifies fields made in bands (wave/bands.h). It depends on the program's
/// version, the panel, the method and its tolerance, the first rows of the bands, and everything that the field of each
/// set depends on. An unfinished file is resumed only by a job with the same number.
///
/// Different jobs have different numbers except by chance (base/archive.h).
uint64_t field_fingerprint(const Grid& panel, const SynthesizeParams& params, const std::vector<const Sources*>& sets,
                           const std::vector<int>& first_rows);

}  // namespace holotrace
