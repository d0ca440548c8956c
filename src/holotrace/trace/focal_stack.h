#pragma once

#include <optional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/exposure.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/light_field.h"
#include "holotrace/data/params/render.h"

namespace holotrace {

/// The light field to trace: the number of cells of the lens, and the plane of the pixels.
struct LightFieldParams {
  int columns = 8, rows = 8;  ///< cells along each side of the lens
  double distance = 0.3;      ///< distance of the plane of the pixels from the panel [m]
  Grid plane{};               ///< pixels of that plane; without pixels: the panel's own grid
  Grid lens{};                ///< window of the lens; without pixels: the panel
  double lens_z = 0;          ///< z of the lens [m], 0 or more
};

/// The pictures to find in one tracing.
struct ScenePlanes {
  std::vector<double> distances{};                ///< planes of the focal stack, from the panel [m]; may be empty
  std::optional<LightFieldParams> light_field{};  ///< none: no light field
};

/// The pictures of one tracing. Without a light field, `light_field` has no cells.
struct SceneViews {
  FocalStack stack;
  LightField light_field;
};

/// Focal stack and light field of a scene, with the panel as the lens, from one tracing: each light path is added to
/// every plane and to every cell's picture that its ray crosses. Light is added without interference.
///
/// **Definition.** A ray leaves the panel at a = (x, y) and, followed backwards, crosses the plane z = −d at
/// p(d) = a + s·d. It counts if both slopes of s are at most T = acceptance_tangent: |a − p(d)| ≤ d·T in x and in y, as
/// for Lens::panel of `render`. A pixel of a plane is the mean radiance over all such rays through the pixel,
/// uniform in (a, p). The picture of a cell is the same for the rays that leave that cell.
///
/// **Sampling.** Because da dp = d²·da ds, all pictures are means under the same measure da ds. Plane j alone asks for
/// the density ρⱼ = N/(pitchⱼ²·Aⱼ/dⱼ²) on the set Sⱼ of rays that cross its window; N = `paths` per pixel and
/// Aⱼ = min(w, 2·T·dⱼ)·min(h, 2·T·dⱼ) is the largest part of the panel (w × h) that a point of the plane sees. Rays
/// are traced with the density
///
///     ρ(ray) = max over j with ray ∈ Sⱼ of ρⱼ
///
/// so each pixel of every plane has N paths or more in the mean (fewer where the panel's edge cuts its part of the
/// panel). Planes are sampled in turn, with N stratified candidates per pixel. A candidate of plane j is kept with
/// probability 1 − (the largest ρᵢ of the planes i before j that the ray crosses)/ρⱼ. Weights are 1/ρ, and a pixel is
/// ΣwL/Σw: evenly lit parts have no noise from the number of paths. The light field's plane comes first, so that the
/// paths of each of its pixels are spread evenly over the cells; the others follow from far to near.
///
/// **Pixels without a path.** In a plane: the mean of the nearest pixels with paths (the smallest square around it that
/// has any). In a cell's picture: the mean of the same pixel of the nearest cells (the smallest square of cells around
/// it that has any). 0 if there are none. With fewer paths than cells, light from neighbouring cells blurs the parallax:
/// use one path per cell or more.
///
/// **Luminous points.** A point at depth D is seen from the part of the panel (or of the cell) within T·D of it. Its
/// light is spread evenly over the image of that part in the plane, |d − D|/D times as large, at least one pixel wide
/// and high. The mesh in front of it is looked for from the centre of the panel, or of the cell. In focus a point is
/// as bright as in `render`.
///
/// **Shutter.** Pictures of an exposure are means over its time, as those of `render`.
///
/// @param exposure    moments of a scene behind the panel (z < 0 [m]), in front of it (z > 0), or on both sides
/// @param panel       the lens, and the pixels of every plane of the stack
/// @param wavelength  used for the acceptance [m]; colours do not depend on it
/// @param planes      at least one plane, of the stack or of the light field
/// @param params      paths, max_depth, clamp, path_expressions, background, accelerator and seed are used
/// @param observer    receives the facts of `report`
/// @return            three channels [W/m²/sr]
/// @throws Error      as `render` does; for distances that are not above 0 or not finite, for no plane at all, for
///                    fewer cells than 1 × 1 or more than the panel has pixels, and if the memory does not suffice
///
/// Cost: about 1 + 2·ln(farthest/nearest) renders of as many paths per pixel.
SceneViews trace_scene_views(const SceneExposure& exposure, const Grid& panel, double wavelength,
                             const ScenePlanes& planes, const RenderParams& params, const Observer& observer = {});

/// A light field alone, of the panel or of a lens in front of it: light for eyes there. In the definition above the lens then
/// takes the place of the panel. Rays that pass beside the panel, or at larger angles than it accepts, count as well;
/// picture_through (view/pupil_picture.h) leaves them out.
/// @param params  paths: per pixel of its plane, shared among all cells
LightField trace_light_field(const SceneExposure& exposure, const Grid& panel, double wavelength,
                             const LightFieldParams& field, const RenderParams& params, const Observer& observer = {});

/// The focal stack alone.
FocalStack trace_focal_stack(const SceneExposure& exposure, const Grid& panel, double wavelength,
                             const std::vector<double>& distances, const RenderParams& params,
                             const Observer& observer = {});

}  // namespace holotrace
