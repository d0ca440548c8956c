#include "holotrace/slm/encode.h"
#include "holotrace/slm/show.h"
#include "holotrace/view/select_order.h"
#include "support/targets.h"

namespace holotrace {
namespace {

TEST(DoublePhase, PlaneWavesWithinTheStopComeOutAsTheyWentIn) {
  // A sum of slow waves whose modulus stays below its maximum: exp(iφ±) holds them exactly, and the noise stands at the
  // corner, beyond the stop. Left: the pixels' roll-off (sinc of at most 3/64), 65536 levels, the noise's own band.
  const Slm slm = make_panel(64, 64, 65536);
  const std::vector<PlaneWave> waves{{0, 0, 1.0}, {3, 0, 0.3}, {-2, 3, {0, 0.3}}};
  const Field field = sum_of(waves, slm.grid);
  Heard heard;
  const Hologram h = encode(field, slm, {.method = Encoding::double_phase}, heard.observer());
  ASSERT_TRUE(h.filter);
  EXPECT_DOUBLE_EQ(h.filter->half_u, 0.2 / test_pitch);  // 0.4 of 1/2p
  EXPECT_LT(heard.number("clipped_part"), 1e-3);
  const Field shown = select_order(show(h, slm, {.irradiance = h.illumination}), *h.filter);
  for (const PlaneWave& w : waves) {
    const double roll_off = sinc(w.a / 64.0) * sinc(w.b / 64.0);
    EXPECT_LT(std::abs(wave_in(shown, w.a, w.b) - roll_off * w.amplitude), 0.01) << w.a << ", " << w.b;
  }
}

TEST(DoublePhase, NeighboursDifferByTheModulus) {
  // Of a constant field a tenth below the maximum of a spot: cos of half the difference of neighbours is |U|/A.
  const Slm slm = make_panel(32, 32, 65536);
  const Hologram h = encode(sum_of({{0, 0, 1}}, slm.grid), slm, {.method = Encoding::double_phase});
  for (int i = 0; i + 1 < 32; ++i) EXPECT_EQ(h.level(5, i), h.level(5, i + 1));  // |U| = A: one phase
}

TEST(DoublePhase, SaysWhatIsWrong) {
  const Slm slm = make_panel(8, 8);
  const Field field = random_field(slm.grid, 1);
  for (const Encoding method : {Encoding::double_phase, Encoding::error_diffusion})
    EXPECT_EQ(error_of([&] { encode(field, slm, {.method = method, .stop = 0}); }),
              "expected a number above 0, up to 1 for \"stop\", got 0");
  EXPECT_EQ(error_of([&] { encode(field, slm, {.method = Encoding::double_phase, .stop = 1.1}); }),
            "expected a number above 0, up to 1 for \"stop\", got 1.1");
  EXPECT_EQ(error_of([&] { encode(field, slm, {.method = Encoding::complex}); }),
            "expected an encoding for a panel of phase or amplitude alone, as \"test\" is, got \"complex\"; use "
            "\"double-phase\" or \"off-axis\", or a panel whose modulation is complex");
}

}  // namespace
}  // namespace holotrace
