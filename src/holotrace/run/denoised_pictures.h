#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/focal_stack.h"
#include "holotrace/data/image.h"
#include "holotrace/data/job.h"

namespace holotrace {

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

/// A focal stack, denoised in the same way, with its facts.
FocalStack make_focal_stack(const Job& job, const std::vector<double>& distances, const RenderParams& params,
                            PictureUse use, const Observer& observer = {});

/// Error of light paths, as a PSNR of the amplitude, above which targets of holograms are not denoised: noise of that size
/// changes a hologram's picture by less than 0.1 dB.
inline constexpr double clean_enough = 42;

/// Denoises the traced light that holograms aim at, as job.encode.denoise says: its planes, and the views from the cells of a
/// light field. With auto, the first picture of each kind (of grey planes the first three) shows how much noise there is: if
/// its light paths alone are clean_enough, all of that kind stay as they are.
///
/// The pictures are denoised fast, one by one; grey planes three at a time. Facts: as of make_picture.
void denoise_targets(const Job& job, std::vector<Image>& planes, std::vector<Image>& cells,
                     const Observer& observer = {});

}  // namespace holotrace
