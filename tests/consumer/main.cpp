// Focuses the wave of a point on a panel back to the point: a dozen lines with the installed library.

#include <cstdio>

#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/synthesize.h"

using namespace holotrace;
using namespace holotrace::literals;

int main() {
  const Grid panel{129, 97, 8.0_um};  // odd: its central pixel is on the axis
  const Sources sources{532_nm, {{{0, 0, -20_mm}, 1, 0}}};
  const Field field = synthesize(sources, panel, {});
  const Field focus = propagate(field, -20_mm);

  int best = 0;
  for (int i = 0; i < int(focus.samples.size()); ++i)
    if (std::norm(focus.samples.values[size_t(i)]) > std::norm(focus.samples.values[size_t(best)])) best = i;
  std::printf("brightest at row %d, column %d\n", best / panel.nx, best % panel.nx);
  return best == 48 * panel.nx + 64 ? 0 : 1;  // (97−1)/2 and (129−1)/2
}
