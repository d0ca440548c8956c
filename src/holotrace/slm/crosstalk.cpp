#include "holotrace/slm/crosstalk.h"

#include <cmath>

namespace holotrace {

CrosstalkTaps crosstalk_taps(double sigma, double lit, int cells) {
  CrosstalkTaps taps;
  taps.cells = cells;
  taps.reach = int(std::ceil(6 * sigma + lit / 2 - 0.5 + 1e-9));
  const double scale = 1 / (std::sqrt(2.0) * sigma);
  for (int c = 0; c < cells; ++c) {
    const double q = lit * ((c + 0.5) / cells - 0.5);
    std::vector<double> k;
    double sum = 0;
    for (int d = -taps.reach; d <= taps.reach; ++d) {
      k.push_back(0.5 * (std::erf((q - d + 0.5) * scale) - std::erf((q - d - 0.5) * scale)));
      sum += k.back();
    }
    for (const double value : k) taps.values.push_back(float(value / sum));
  }
  return taps;
}

int crosstalk_cells(const Slm& slm, const ShowParams& params) {
  if (!(slm.effects.crosstalk > 0)) return 1;
  if (params.fine_samples > 0) return params.fine_samples;
  return slm.effects.crosstalk < 0.2 ? 8 : 4;
}

}  // namespace holotrace
