#pragma once

#include "holotrace/data/hologram.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"

namespace holotrace {

/// A synthetic picture with the statistics of natural ones that matter to encoders: a spectrum that falls as 1/f
/// (Field, J. Opt. Soc. Am. A 4, 2379, 1987) for land and sky, shaded balls, and bars with hard edges at several
/// widths; parts of it are near black, others white.
///
/// @return linear light in [0, 1], one channel; the same picture for the same size
Image natural_picture(int columns, int rows);

/// Quality of the image of a target, as a bench would measure it: through the virtual SLM, the stop that the
/// hologram needs, and free space. The light is integrated over the target's pixels, or sampled at their centres
/// only: in a field full of phase vortices, the light between the centres differs from the light at them.
struct EncoderQuality {
  double psnr = 0;        ///< PSNR of the modulus where the weight is not 0, at the best scale; peak: the target's [dB]
  double efficiency = 0;  ///< light there over the light on the panel
};
EncoderQuality encoder_quality(const TargetPlane& target, const Hologram& hologram, const Slm& slm,
                               const ShowParams& params = {}, PixelSampling sampling = PixelSampling::integrate);

/// Relative L2 noise of a picture a, from another one, b, of the same light with independent noise of the same size:
///
///     √( Σ(a − b)²/2 / Σ((a + b)/2)² )        the variance of a difference is twice that of each
///
/// @throws Error  for pictures of different sizes, and for dark ones
double picture_noise(const Image& a, const Image& b);

}  // namespace holotrace
