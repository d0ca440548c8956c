#pragma once

#include <array>
#include <string>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/image.h"
#include "holotrace/data/job.h"
#include "holotrace/data/light_field.h"

namespace holotrace {

/// A path-traced picture of a run, and its stage in the report.
struct PlannedRender {
  std::string stage;
  RenderParams params;  ///< parameters for `render`
};

/// References of a run: one for all camera distances. With a lens, or an eye off the panel's centre, positions in the
/// picture depend on the distance; then there is one for each.
///
/// They show the light that makes waves. Where a ray from the panel meets nothing there is none, unless the background makes
/// waves, too (TraceParams::has_background).
std::vector<PlannedRender> plan_renders(const Job& job);

/// What each eye of a viewer would see of the scene itself, focused where the holographic pair is; empty without
/// job.render.eye_separation.
std::vector<PlannedRender> plan_stereo_renders(const Job& job);

/// Direction of the middle of the renders that a run compares views at a distance with, as tangents from the panel's centre: that of the
/// views, or what [render] says.
Vec2 middle_of_renders(const Job& job, double distance);

/// Parameters of a render that shows the light which makes waves: that of the job's path expressions, the background only if it makes
/// waves, too, and with one wavelength the refractive indices at it.
RenderParams light_of_waves(const Job& job, RenderParams params);

/// Paths of a quick reference for a full one: a quarter, an even number.
int quick_paths(int paths);

/// A run has none with `reference = none`. With `quick` they have a quarter of the paths (at least 2), in two halves.
/// @throws Error  as `render` does
Image make_render(const Job& job, const RenderParams& params, const Observer& observer = {});

/// Whether a job compares its views with quick renders: it asks for them, and they have fewer paths than full ones.
bool is_quick(const Job& job);

/// A render of few paths, as the mean of two with independent paths.
struct HalvedRender {
  Image mean, first;  ///< mean of both, and the first
  /// The mean, but its brightest pixels have all paths of the job, as in its full render: the maximum of the picture, to
  /// which PSNR and SSIM refer, depends on few pixels. Only the maximum should be taken of it: where noise is high, pixels are
  /// replaced, and where it is low, they are not.
  Image brightest;
};

/// Brightest pixels that get all paths, in each of two steps, over all pixels: one in so many.
inline constexpr int pixels_per_brightest = 50;

/// A fiftieth of the pixels, the brightest ones, get all paths. Then so does up to another fiftieth: those that are still
/// brighter, and the neighbours of the brightest, as views take values between pixels.
/// @param params  of an even number of paths
HalvedRender make_halved_render(const Job& job, const RenderParams& params, const Observer& observer = {});

/// What the views of holograms that aim at the scene's light are compared with, one for each of the camera's distances: renders
/// in two halves, whose paths are independent of each other and of those of the targets. They show the light that passes the
/// camera's pupil or, without one, the panel, on the panel's pixels in the plane in focus, and nothing is blurred. Two halves
/// give the error against a render without noise (report_metrics). Both have as many paths together as the job's
/// `reference` says; `brightest` is empty.
/// @return  none for `reference = none`
/// @throws Error  as `render` and `trace_focal_stack` do
std::vector<HalvedRender> trace_scene_references(const Job& job, const Observer& observer = {});

/// What a path-traced picture is for: to look at it, or as radiance to compute with.
enum class PictureUse { to_look_at, radiance };

/// A render, denoised as params.denoise says: pictures to look at with auto, all with all.
///
/// Facts: those of make_render; if it should be denoised `denoised`, the number of pictures that were; `denoiser`, the
/// library with its version, or `why_not_denoised`: the library is missing, or the scene has luminous points, which are
/// sharp and would be taken for noise. That is a warning, too, if params.denoise is all, or if a library was found that
/// cannot be used.
/// @throws Error  as render and denoise do, but none for want of a library
Image make_picture(const Job& job, const RenderParams& params, PictureUse use, const Observer& observer = {});

/// The Stokes parameters S0 to S3 of the light in each pixel (data/polarization.h), signed radiance in red, green and blue [W/m²/sr], for
/// horizontal x. The analyser of the scene counts as left out. As each is found along the same light paths, no pixel has more
/// polarised light than light. Facts: those of make_render for S0. Cost: four times make_render.
std::array<Image, 4> make_stokes(const Job& job, const RenderParams& params, const Observer& observer = {});

/// A focal stack, denoised in the same way, with its facts.
FocalStack make_focal_stack(const Job& job, const std::vector<double>& distances, const RenderParams& params,
                            PictureUse use, const Observer& observer = {});

/// Error of light paths, as a PSNR of the amplitude, above which targets of holograms are not denoised: noise of that size
/// changes a hologram's picture by less than 0.1 dB.
inline constexpr double clean_enough = 42;

/// Whether the targets of a job may be denoised: its scene has no luminous points, and the library is there.
bool can_denoise_targets(const Job& job);

/// Denoises the traced light that holograms aim at, as job.encode.denoise says: its planes, and the views from the cells of a
/// light field. With auto, the first picture of each kind (of grey ones the first three) shows how much noise there is: if
/// its light paths alone are clean_enough, all of that kind stay as they are.
///
/// The pictures are denoised fast, one by one; grey ones three at a time. Facts: as of make_picture.
void denoise_targets(const Job& job, std::vector<Image>& planes, std::vector<Image>& cells,
                     const Observer& observer = {});

}  // namespace holotrace
