#include "holotrace/slm/encode.h"
#include "holotrace/slm/show.h"
#include "holotrace/view/select_order.h"
#include "support/targets.h"

namespace holotrace {
namespace {

TEST(ErrorDiffusion, NoiseIsPushedAwayFromTheAxis) {
  // A field of modulus 1/2 beside one bright wave: the kinoform's error is spread over all frequencies, that of error
  // diffusion is a high pass. Slow waves come out to a tenth of the strongest, and nearer than the kinoform's.
  const Slm slm = make_panel(128, 128);
  const std::vector<PlaneWave> waves{{0, 0, 1.0}, {5, 0, 0.6}, {0, -7, {0, 0.5}}, {4, 4, 0.3}};
  const Field field = sum_of(waves, slm.grid);
  const auto worst = [&](Encoding method) {
    const Hologram h = encode(field, slm, {.method = method});
    Field shown = show(h, slm, {.irradiance = h.illumination});
    if (h.filter) shown = select_order(shown, *h.filter);
    double most = 0;
    for (const PlaneWave& w : waves)
      most = std::max(most, std::abs(wave_in(shown, w.a, w.b) - sinc(w.a / 128.0) * sinc(w.b / 128.0) * w.amplitude));
    return most;
  };
  EXPECT_LT(worst(Encoding::error_diffusion), 0.1);
  EXPECT_LT(worst(Encoding::error_diffusion), worst(Encoding::phase));
}

}  // namespace
}  // namespace holotrace
