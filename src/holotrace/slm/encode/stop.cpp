#include "holotrace/slm/encode/stop.h"

#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/encode/off_axis.h"

namespace holotrace {

std::optional<SpectralFilter> stop_of(const EncodeParams& params, const Grid& grid, double wavelength) {
  const EncodingTraits traits = traits_of(params.method);
  if (traits.writes_fringes) {
    EncodeParams reference = params;
    reference.with_bias = params.with_bias && traits.keeps_modulus;
    return off_axis_filter(reference_carrier(reference, grid, wavelength), grid, reference.with_bias);
  }
  const bool needs_stop = traits.stop < 1, has_stop = traits.aims_at_targets && stop_width(params) < 1;
  if (needs_stop || has_stop) return low_pass_stop(params, grid);
  return std::nullopt;
}

}  // namespace holotrace
