#include "holotrace/estimate/encoder_quality.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/slm/panel/illumination_states.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/expose.h"
#include "holotrace/view/order_stop.h"
#include "holotrace/view/sensor.h"
#include "holotrace/wave/propagate/propagate.h"

namespace holotrace {

EncoderQuality encoder_quality(const TargetPlane& target, const Hologram& hologram, const Slm& slm,
                               const ShowParams& params, PixelSampling sampling) {
  require(params.subpixels == 1, "expected 1 sample per pixel, as the target has, got {}", params.subpixels);
  const bool is_integrated = sampling == PixelSampling::integrate;
  const int samples = is_integrated ? 2 : 1, rim = is_integrated ? integration_rim : 0;
  // The irradiance of all illumination states; a panel with flicker has several.
  std::vector<double> irradiance(target.amplitude.size());
  for (const IlluminationState& state :
       illumination_states(with_effects_or_own(slm, params.effects), params, hologram.wavelength)) {
    Field light = show(hologram, slm, params, state);
    const PropagateParams window = window_of(light.grid, samples, rim);
    if (light.filter) light = apply_order_stop(light, *light.filter, order_stop_margin(*light.filter, light.grid));
    light = propagate(light, target.z, window);
    const Image seen = mean_over_pixels(irradiance_of(light), samples, rim, is_integrated);
    for (size_t i = 0; i < irradiance.size(); ++i) irradiance[i] += state.weight * double(seen.values[i]);
  }
  double wanted = 0, cross = 0, square = 0, weight = 0, peak = 0;
  for (size_t i = 0; i < target.amplitude.size(); ++i) {
    const double w = target.weight.size() == 0 ? 1 : double(target.weight.values[i]);
    if (w <= 0) continue;
    const double a = target.amplitude.values[i], v = std::sqrt(irradiance[i]);
    wanted += w * a * a;
    cross += w * a * v;
    square += w * v * v;
    weight += w;
    peak = std::max(peak, a);
  }
  const double error = std::max(square > 0 ? wanted - cross * cross / square : wanted, 1e-15 * wanted);
  return {10 * std::log10(peak * peak * weight / error), square / double(slm.grid.pixels())};
}

}  // namespace holotrace
