#include <cmath>

#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/diffraction_orders.h"
#include "support/targets.h"

namespace holotrace {
namespace {

TEST(ErrorDiffusion, NoiseIsPushedAwayFromTheAxis) {
  // A field of modulus 1/2 plus one bright wave: the kinoform's error is spread over all frequencies, that of error
  // diffusion is a high pass. Slow waves are correct to a tenth of the strongest, and nearer than with the kinoform.
  const Slm slm = make_panel(128, 128);
  const std::vector<PlaneWave> waves{{0, 0, 1.0}, {5, 0, 0.6}, {0, -7, {0, 0.5}}, {4, 4, 0.3}};
  const Field field = sum_of(waves, slm.grid);
  const auto worst = [&](Encoding method) {
    const Hologram h = encode(field, slm, {.method = method});
    Field shown = show(h, slm, {.irradiance = h.illumination});
    if (h.filter) shown = apply_order_stop(shown, *h.filter, 0);
    double most = 0;
    for (const PlaneWave& w : waves)
      most = std::max(most, std::abs(wave_in(shown, w.a, w.b) - sinc(w.a / 128.0) * sinc(w.b / 128.0) * w.amplitude));
    return most;
  };
  EXPECT_LT(worst(Encoding::error_diffusion), 0.1);
  EXPECT_LT(worst(Encoding::error_diffusion), worst(Encoding::phase));
}

// Floyd and Steinberg (1976), rows in alternating directions, written a second time: of a pixel's error 7/16 goes to
// the next pixel, 3/16, 5/16 and 1/16 to the three below it, 1/16 to the one ahead. Errors off the panel are lost.
Array2D<int> floyd_steinberg(const Array2D<std::complex<double>>& wanted, int levels) {
  const int nx = wanted.nx, ny = wanted.ny;
  Array2D<std::complex<double>> left = wanted;
  Array2D<int> chosen(ny, nx);
  const auto give = [&](int j, int i, std::complex<double> error) {
    if (j < ny && i >= 0 && i < nx) left(j, i) += error;
  };
  for (int j = 0; j < ny; ++j)
    for (int n = 0; n < nx; ++n) {
      const int ahead = j % 2 == 0 ? 1 : -1, i = ahead > 0 ? n : nx - 1 - n;
      const double turns = std::arg(left(j, i)) / (2 * pi);
      const int level = (int(std::round(turns * levels)) + levels) % levels;
      chosen(j, i) = level;
      const std::complex<double> error = left(j, i) - std::polar(1.0, 2 * pi * level / levels);
      give(j, i + ahead, 7.0 * error / 16.0);
      give(j + 1, i - ahead, 3.0 * error / 16.0);
      give(j + 1, i, 5.0 * error / 16.0);
      give(j + 1, i + ahead, error / 16.0);
    }
  return chosen;
}

TEST(ErrorDiffusion, SpreadsErrorsByTheWeightsOfFloydAndSteinberg) {
  // Few levels, so that rounding of floats decides none; waves inside the stop, so that nothing is cut off.
  const Slm slm = make_panel(40, 24, 16);
  const Field field = sum_of({{1, 0, 0.5}, {-3, 2, {0, 0.4}}, {2, -4, 0.3}}, slm.grid);
  Heard heard;
  const Hologram h = encode(field, slm, {.method = Encoding::error_diffusion}, heard.observer());
  ASSERT_NEAR(heard.number("band_power"), 1, 1e-6);
  const double top = heard.number("modulus_max");
  Array2D<std::complex<double>> wanted(24, 40);
  for (size_t i = 0; i < wanted.size(); ++i) {
    const std::complex<double> u(field.samples.values[i]);
    wanted.values[i] = u / std::max(top, std::abs(u));
  }
  const Array2D<int> expected = floyd_steinberg(wanted, 16);
  for (size_t i = 0; i < expected.size(); ++i)
    ASSERT_EQ(int(h.level.values[i]), expected.values[i]) << "pixel " << i % 40 << ", " << i / 40;
}

}  // namespace
}  // namespace holotrace
