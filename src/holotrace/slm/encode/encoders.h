#pragma once

#include "holotrace/base/error.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/binary.h"
#include "holotrace/slm/encode/double_phase.h"
#include "holotrace/slm/encode/kinoform.h"
#include "holotrace/slm/encode/off_axis.h"

namespace holotrace {

/// Levels by one of the encoders that find each pixel by itself, on the processor or on a device.
template <class AnyField>
void encode_anywhere(const ShownPixels<AnyField>& shown, const EncodeParams& params, const PhaseLevels& levels,
                     const Observer& observer, Hologram& hologram) {
  switch (params.method) {
    case Encoding::phase:
      return encode_phase(shown, levels, hologram);
    case Encoding::amplitude:
      return encode_amplitude(shown, observer, hologram);
    case Encoding::complex:
      return encode_complex(shown, levels, observer, hologram);
    case Encoding::off_axis:
      return encode_off_axis(shown, params, observer, hologram);
    case Encoding::double_phase:
      return encode_double_phase(shown, levels, params, observer, hologram);
    case Encoding::binary:
      return encode_binary(shown, levels, params, observer, hologram);
    default:
      fail("expected an encoding without iterations, got \"{}\"", name_of(params.method, encoding_names));
  }
}

}  // namespace holotrace
