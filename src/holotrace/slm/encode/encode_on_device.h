#pragma once

#include <optional>

#include "holotrace/base/error.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/binary.h"
#include "holotrace/slm/encode/double_phase.h"
#include "holotrace/slm/encode/kinoform.h"
#include "holotrace/slm/encode/off_axis.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/wave/shared/placed_field.h"

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

// Encoders that find each pixel by itself, on OpenCL devices. `blank` is a hologram whose grid, levels, wavelength and modulation are
// set.

/// What an encoder does on a device that has so many bytes of memory left for the field and its encoder.
struct EncodeForecast {
  int parts = 1;      ///< in which it must go there (DeviceSamples)
  DeviceUse use;      ///< of the encoder, and in one part of the field
  bool fits = false;  ///< otherwise `use` is that of the smallest parts
};

/// The encoder is run on a device that only counts, in 1, 2, 4, … parts until they fit.
/// @param head    of the field
/// @throws Error  for a reference that is too steep for the pitch (off_axis.h)
EncodeForecast forecast_encoding(const Device& device, const Field& head, const Hologram& blank,
                                 const PhaseLevels& levels, const EncodeParams& params, double memory);

/// The levels, found on that device; nothing if a sample is not finite, which the processor names.
/// @throws Error  if not even the smallest parts fit, and as Device does
std::optional<Hologram> encode_on(Device& device, const PlacedField& field, const Hologram& blank,
                                  const PhaseLevels& levels, const EncodeParams& params, const Observer& observer);

/// The device that is expected to encode the field sooner than the processor; none if the processor is. The field's way there
/// counts, and that of the levels back, or of all parts there and back.
Device* fastest_to_encode(const PlacedField& field, const Hologram& blank, const PhaseLevels& levels,
                          const EncodeParams& params);

}  // namespace holotrace
