#include <cmath>
#include <limits>

#include "holotrace/estimate/cost.h"
#include "support/panels.h"

namespace holotrace {
namespace {

TEST(Cost, PathLengthIsTheGeometricSeries) {
  for (double rho : {0.0, 0.25, 0.5, 0.8}) {
    double sum = 0;
    for (int bounce = 0; bounce <= 5; ++bounce) sum += std::pow(rho, bounce);
    EXPECT_NEAR(mean_path_length(rho, 5), sum, 1e-12);  // Eq. 19, k + 1 terms
    EXPECT_DOUBLE_EQ(mean_path_length(rho), 1 / (1 - rho));
    EXPECT_NEAR(mean_path_length(rho, 500), mean_path_length(rho), 1e-12);  // 0.8⁵⁰⁰ = 1e-48
  }
}

TEST(Cost, IsEquation23AndTheSynthesisBesideIt) {
  // N = 1000·64 paths of mean length 1/(1 − 0.75) = 4: 64000·(1 + 4)·1 µs = 0.32 s; 10⁶ waves on 1000 pixels at
  // 10¹⁰/s: 0.1 s. Twice for 2 frames.
  const Cost cost = estimate_cost({.pixels = 1000,
                                   .samples_per_pixel = 64,
                                   .frames = 2,
                                   .reflectance = 0.75,
                                   .trace_seconds = 1e-6,
                                   .waves = 1e6,
                                   .wave_rate = 1e10});
  EXPECT_DOUBLE_EQ(cost.paths, 64000);
  EXPECT_DOUBLE_EQ(cost.mean_path_length, 4);
  EXPECT_DOUBLE_EQ(cost.rays, 256000);
  EXPECT_DOUBLE_EQ(cost.trace_seconds, 0.64);
  EXPECT_DOUBLE_EQ(cost.synthesis_seconds, 0.2);
  EXPECT_DOUBLE_EQ(cost.seconds, 0.84);
}

TEST(Cost, SaysWhatIsWrong) {
  EXPECT_EQ(error_of([] { mean_path_length(1); }),
            "expected a probability in [0, 1) that a path goes on, got 1; at 1 no path would end");
  EXPECT_EQ(error_of([] { estimate_cost({.pixels = -1}); }), "expected counts and times of 0 or more, got -1");
  EXPECT_EQ(error_of([] { estimate_cost({.wave_rate = 0}); }), "expected a rate above 0 waves·pixels/s, got 0");
  EXPECT_EQ(error_of([] { estimate_cost({.waves = std::numeric_limits<double>::infinity()}); }),
            "expected counts and times of 0 or more, got inf");
}

}  // namespace
}  // namespace holotrace
