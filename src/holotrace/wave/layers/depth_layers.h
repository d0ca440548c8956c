#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/depth_image.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/wave/layers/sum_layers.h"

namespace holotrace {

/// A wavelength, and the wavelength of the acceptance cone that its light keeps to, the same for all colours of a view.
struct LightInCone {
  LightInCone(double wavelength, double cone_wavelength = 0)
      : wavelength(wavelength), cone_wavelength(cone_wavelength) {}

  double wavelength;       ///< [m]
  double cone_wavelength;  ///< [m], at most the wavelength; 0: the light's own
  double acceptance_wavelength() const { return cone_wavelength > 0 ? cone_wavelength : wavelength; }
};

/// Range of depths that look equally sharp through the whole panel: λ/NA² at a depth d on either side of it, within which a wave front is off
/// by at most a quarter of a wavelength (Rayleigh). NA is the sine of the angle from the axis to the panel's farther edge,
/// or of its cone where that is less.
double depth_of_focus(double depth, const Grid& panel, const LightInCone& light);

/// A picture with depth as slices of depth on the panel's raster, made one at a time.
///
/// A slice holds the samples whose pixel has its depth. Their amplitude is √L, L the picture's light at the wavelength (radiance_at of its
/// channels), bilinear between pixels and averaged over pixels finer than samples; depths are those of the nearest pixel, so that edges
/// stay sharp. Orthographic: the picture is params.width wide at every depth. Perspective: a pixel lies on the ray from the panel's centre
/// through it, params.field_of_view to the middle of either side of the picture, which lies behind the panel. Pixels are square. Random
/// phases are 2π·u(seed, frame, sample), one for each sample and slice.
///
/// Such light fills the band of the samples evenly. If it keeps to a narrower cone, asin(λc/2p) instead of asin(λ/2p),
/// the cone gets all of its power: amplitudes are √L·λ/λc. All colours of a cone then have the irradiance L on
/// their slice and send it evenly into the same angles. Light of constant phase goes straight on: amplitudes are √L.
///
/// Slices: synthesis.slices of them, or as few as the depth of focus allows (depth_of_focus), or the tolerance where that allows fewer: it
/// keeps the phase of an even wave at the panel within 0.8 times the tolerance (slice.h). With silhouettes a slice hides everything behind
/// its samples, including dark ones.
///
/// @param image  must outlive the stack
/// Facts: `slice_thickness_m`, `largest_depth_error`.
/// @throws Error  as check_depth_image does; for a phase that is neither random nor constant, a width or angle below 0,
///                a picture whose slices hold no sample, and perspective light in front of the panel
SliceStack slice_depth_image(const DepthImage& image, const Grid& panel, const LightInCone& light,
                             const DepthImageParams& params, const SynthesizeParams& synthesis, uint32_t frame = 0,
                             const Observer& observer = {});

/// The field on the panel of a picture with depth: sum_layers of its slices.
Field sum_depth_image(const DepthImage& image, const Grid& panel, const LightInCone& light,
                      const DepthImageParams& params, const SynthesizeParams& synthesis, uint32_t frame = 0,
                      const Observer& observer = {});

}  // namespace holotrace
