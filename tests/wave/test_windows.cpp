// Output windows of any pitch, size and centre, against direct Rayleigh–Sommerfeld sums at their points.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/direct_sum.h"
#include "holotrace/wave/propagate.h"
#include "holotrace/wave/propagation_kernel.h"
#include "holotrace/wave/propagator_cache.h"
#include "support/fields.h"

namespace holotrace {
namespace {

using namespace literals;
using testing::make_band_limited_noise;
using testing::make_field;
using testing::relative_error;

FieldDouble make_white_noise(const Grid& grid, uint32_t seed) {
  FieldDouble field(grid, 532_nm);
  CounterRandom random(seed, 0, 0);
  for (auto& u : field.samples.values) u = {random.uniform() - 0.5, random.uniform() - 0.5};
  return field;
}

// Relative error over 60 pixels drawn from the output.
template <class Real>
double error_against_direct_sum(const FieldDouble& input, double z, const PropagateParams& params) {
  const BasicField<Real> output = propagate(convert<Real>(input), z, params);
  EXPECT_EQ(output.grid, propagation_output(input.grid, params));
  CounterRandom random(5, 0, 0);
  std::vector<Vec3> points;
  std::vector<std::complex<double>> found;
  for (int n = 0; n < 60; ++n) {
    const int i = int(random.uniform() * output.grid.nx), j = int(random.uniform() * output.grid.ny);
    points.push_back({output.grid.x(i), output.grid.y(j), z});
    found.push_back(std::complex<double>(output.samples(j, i)));
  }
  const auto expected = sum_rayleigh_sommerfeld(input, points);
  double error = 0, energy = 0;
  for (size_t n = 0; n < points.size(); ++n) {
    error += std::norm(found[n] - expected[n]);
    energy += std::norm(expected[n]);
  }
  return std::sqrt(error / energy);
}

struct Window {
  const char* name;
  int columns, rows;
  double pitch, centre_x, centre_y;
};

const Window windows[] = {
    {"OddSizes", 75, 58, 0, 0, 0},
    {"Shifted", 64, 47, 0, 120_um, -64_um},
    {"ShiftedByPartsOfAPixel", 80, 61, 0, 3.7_um, -51.3_um},
    {"FarOff", 40, 40, 0, 300_um, 0.25_mm},
    {"Coarser", 31, 40, 16_um, 0, 0},
    {"Finer", 130, 90, 4_um, 20_um, 10_um},
    {"OneAndAHalf", 44, 51, 12_um, -33_um, 7_um},
    {"OfAnyPitch", 101, 64, 5.3217_um, 40_um, -90.5_um},
    {"FineAndSmall", 64, 64, 0.61_um, -100_um, 55_um},
    {"OnePixel", 1, 1, 3_um, 20_um, 30_um},
};

class WindowsOfPropagation : public ::testing::TestWithParam<Window> {
 protected:
  PropagateParams params(PropagationMethod method) const {
    const Window& w = GetParam();
    return {method, w.columns, w.rows, w.pitch, w.centre_x, w.centre_y};
  }
};

// Any samples, at any place: z* is at most 19 mm here. At one pitch the same sum, by FFT; at others the kernel's
// smooth edge leaves 1e-11 of a sum of samples that all have the same weight; float: 1e-6.
TEST_P(WindowsOfPropagation, HoldTheDirectSumsOfAnySamples) {
  const FieldDouble field = make_white_noise({66, 49, 8_um, 24.3_um, -16_um}, 7);
  for (const double z : {0.03_m, -0.05_m, 0.4_m}) {
    const PropagateParams p = params(PropagationMethod::automatic);
    EXPECT_LT(error_against_direct_sum<double>(field, z, p), GetParam().pitch == 0 ? 1e-12 : 1e-9) << z;
    EXPECT_LT(error_against_direct_sum<float>(field, z, p), 2e-6) << z;
  }
}

// Nearer than z* by the angular spectrum, of a field limited in space and frequency to 1e-11. The light is larger than
// the windows, whose edges cut it.
TEST_P(WindowsOfPropagation, HoldTheDirectSumsOfLimitedFieldsNearby) {
  FieldDouble field = make_band_limited_noise({181, 200, 8_um}, 532_nm, 7e3);
  field.grid.centre_x = 13_um;
  for (const double z : {0.02_m, -0.03_m}) {
    const PropagateParams p = params(PropagationMethod::angular_spectrum);
    EXPECT_LT(error_against_direct_sum<double>(field, z, p), 1e-9) << z;
    EXPECT_LT(error_against_direct_sum<float>(field, z, p), 2e-6) << z;
  }
}

INSTANTIATE_TEST_SUITE_P(Windows, WindowsOfPropagation, ::testing::ValuesIn(windows),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace holotrace
