#include "holotrace/estimate/encoder_quality.h"

#include <algorithm>
#include <cmath>

#include "holotrace/slm/show.h"
#include "holotrace/view/select_order.h"
#include "holotrace/wave/propagate.h"

namespace holotrace {

EncoderQuality encoder_quality(const TargetPlane& target, const Hologram& hologram, const Slm& slm,
                               const ShowParams& params) {
  Field light = show(hologram, slm, params);
  if (light.filter) light = select_order(light, *light.filter);
  light = propagate(light, target.z);
  double wanted = 0, cross = 0, square = 0, weight = 0, peak = 0;
  for (size_t i = 0; i < target.amplitude.size(); ++i) {
    const double w = target.weight.size() == 0 ? 1 : double(target.weight.values[i]);
    if (w <= 0) continue;
    const double a = target.amplitude.values[i], v = std::abs(std::complex<double>(light.samples.values[i]));
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
