// The Stokes parameters of a picture, of a lamp behind a sheet, as `holotrace render --stokes` makes them.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "holotrace/base/units.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/run/renders.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

std::array<double, 4> stokes_behind(const std::string& sheet) {
  const std::string path = test::make_file("wall.toml", R"(wavelength = "532 nm"
polarization = true
[slm]
columns = 64
rows = 64
[materials.lamp]
emission = 1
[materials.sheet]
)" + sheet + R"([[object]]
type = "quad"
width = "4 mm"
height = "4 mm"
position = "0 0 -60 mm"
material = "lamp"
[[object]]
type = "quad"
width = "20 mm"
height = "20 mm"
position = "0 0 -50 mm"
material = "sheet"
)");
  const Job job = load_job(path);
  RenderParams params = job.render;
  params.columns = params.rows = 8;
  params.field_of_view = pi / 180;
  params.paths = 1;
  std::array<double, 4> means{};
  const std::array<Image, 4> pictures = make_stokes(job, params);
  for (size_t k = 0; k < 4; ++k)
    for (const float value : pictures[k].values) means[k] += value / double(pictures[k].values.size());
  return means;
}

// A polariser at the angle θ from x passes half of the lamp's light, with S1 = S0·cos 2θ and S2 = S0·sin 2θ. Rays are within 0.5° of
// the axis, which turns the sheet's axis by the square of it: 1e-4.
TEST(StokesPictures, OfAPolariserAreThoseOfItsAxis) {
  const auto [s0, s1, s2, s3] = stokes_behind("type = \"polariser\"\naxis = \"30 deg\"\n");
  EXPECT_NEAR(s0, 0.5, 1e-4);
  EXPECT_NEAR(s1 / s0, 0.5, 2e-4);
  EXPECT_NEAR(s2 / s0, std::sqrt(0.75), 2e-4);
  EXPECT_NEAR(s3 / s0, 0, 2e-4);
}

TEST(StokesPictures, OfUnpolarisedLightAreZeroBehindAPlate) {
  const auto [s0, s1, s2, s3] = stokes_behind("type = \"retarder\"\naxis = \"30 deg\"\ndelay = \"90 deg\"\n");
  EXPECT_NEAR(s0, 1, 1e-4);
  for (const double s : {s1, s2, s3}) EXPECT_NEAR(s, 0, 1e-6);
}

}  // namespace
}  // namespace holotrace
