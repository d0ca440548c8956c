#pragma once

#include "holotrace/data/hologram.h"
#include "holotrace/data/params/camera.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"

namespace holotrace {

/// How well a hologram shows a target, seen as a bench would see it: through the virtual SLM, the stop that the
/// hologram asks for, and free space. The light is integrated over the target's pixels, or taken at their middles
/// alone: between the middles of a field full of phase vortices there is other light than at them.
struct EncoderQuality {
  double psnr = 0;        ///< of the modulus where the weight is not 0, best scale taken out; peak: the target's [dB]
  double efficiency = 0;  ///< light there over the light on the panel
};
EncoderQuality encoder_quality(const TargetPlane& target, const Hologram& hologram, const Slm& slm,
                               const ShowParams& params = {}, PixelSampling sampling = PixelSampling::integrate);

}  // namespace holotrace
