#include "holotrace/slm/encode/encode.h"

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/binary.h"
#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/slm/encode/double_phase.h"
#include "holotrace/slm/encode/error_diffusion.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/slm/encode/kinoform.h"
#include "holotrace/slm/encode/off_axis.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/target.h"
#include "holotrace/slm/panel/checks.h"

namespace holotrace {
namespace {

// The encoders that use the field on the panel alone.
void encode_directly(const Field& shown, const EncodeParams& params, const PhaseLevels& levels,
                     const Observer& observer, Hologram& hologram) {
  switch (params.method) {
    case Encoding::phase:
      return encode_phase(shown, levels, hologram);
    case Encoding::amplitude:
      return encode_amplitude(shown, observer, hologram);
    case Encoding::off_axis:
      return encode_off_axis(shown, params, observer, hologram);
    case Encoding::complex:
      return encode_complex(shown, levels, observer, hologram);
    case Encoding::double_phase:
      return encode_double_phase(shown, levels, params, observer, hologram);
    case Encoding::error_diffusion:
      return encode_error_diffusion(shown, levels, params, observer, hologram);
    case Encoding::binary:
      return encode_binary(shown, levels, params, observer, hologram);
    default:
      fail("expected an encoding without iterations, got \"{}\"", name_of(params.method, encoding_names));
  }
}

}  // namespace

double short_range_efficiency(double range) {
  const double amplitude = range < 1 ? range + std::sin(pi * range) / pi : 1;
  return amplitude * amplitude;
}

Hologram encode(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer) {
  check_encode_params(slm, params);
  require_grid_of(slm, field.grid, "field");
  if (aims_at_targets(params.method)) {
    Hologram found = encode_targets(targets_of(field, params), field, slm, params, observer);
    found.loses_by_cone = true;  // the targets are the field's own light
    return found;
  }
  check_encoding(slm, params, observer);
  check_field_to_show(field, slm, observer);
  Hologram hologram = blank_hologram(field, slm, params, observer);
  const Slm known = with_effects(slm, params.effects);
  const PhaseLevels levels(known, hologram.levels, field.wavelength);
  if (hologram.modulation != Modulation::amplitude) tell_phase_range(known, levels.range(), field.wavelength, observer);
  if (params.image == ImageSide::real_image)
    encode_directly(conjugate(field), params, levels, observer, hologram);
  else
    encode_directly(field, params, levels, observer, hologram);
  observer.fact("illumination", Fact(hologram.illumination));
  observer.progress(1);
  return hologram;
}

}  // namespace holotrace
