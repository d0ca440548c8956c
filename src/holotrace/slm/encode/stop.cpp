#include "holotrace/slm/encode/stop.h"

#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/encode/off_axis.h"

namespace holotrace {

std::optional<SpectralFilter> stop_of(const EncodeParams& params, const Grid& grid, double wavelength) {
  switch (params.method) {
    case Encoding::off_axis:
      return off_axis_filter(reference_carrier(params, grid, wavelength), grid, params.with_bias);
    case Encoding::binary: {
      EncodeParams without_bias = params;
      without_bias.with_bias = false;
      return off_axis_filter(reference_carrier(without_bias, grid, wavelength), grid, false);
    }
    case Encoding::double_phase:
    case Encoding::error_diffusion:
      return low_pass_stop(params, grid);
    default:
      if (aims_at_targets(params.method) && stop_width(params) < 1) return low_pass_stop(params, grid);
      return std::nullopt;
  }
}

}  // namespace holotrace
