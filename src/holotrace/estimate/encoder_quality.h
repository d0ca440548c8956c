#pragma once

#include "holotrace/data/hologram.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"

namespace holotrace {

/// Quality of the image of a target, as a bench would measure it: through the virtual SLM, the stop that the
/// hologram needs, and free space. The light is integrated over the target's pixels, or sampled at their centres
/// only: in a field full of phase vortices, the light between the centres differs from the light at them.
struct EncoderQuality {
  double psnr = 0;        ///< PSNR of the modulus where the weight is not 0, at the best scale; peak: the target's [dB]
  double efficiency = 0;  ///< light there over the light on the panel
};
EncoderQuality encoder_quality(const TargetPlane& target, const Hologram& hologram, const Slm& slm,
                               const ShowParams& params = {}, PixelSampling sampling = PixelSampling::integrate);

}  // namespace holotrace
