#include "holotrace/slm/panel/illumination.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/compare.h"
#include "holotrace/view/source_image.h"
#include "support/panels.h"

// Light of an extended source: the effect of its disc on a view.

namespace holotrace {
namespace {

using namespace literals;

// A Gaussian beam of waist w on the panel has w(z) = w·√(1 + (z/z_R)²), z_R = πw²/λ, and the irradiance exp(−2r²/w²);
// every direction of a source of angle α moves it by z times that direction. The mean over the disc is summed here over
// 200 × 200 directions. Tilted light moves by z·tan α, 1 + α²/3 of z·α at α = 0.015: 1e-4 of the radius.
TEST(Source, ABeamBecomesItsConvolutionWithTheDisc) {
  const Slm slm = make_panel(256, 256);
  const double w = 40_um, z = 50_mm, angle = 0.03, rayleigh = pi * w * w / test_wavelength;
  Field field(slm.grid, test_wavelength);
  field.image = ImageSide::real_image;
  for (int j = 0; j < 256; ++j)
    for (int i = 0; i < 256; ++i) {
      const double r = std::hypot(field.grid.x(i), field.grid.y(j));
      field.samples(j, i) = float(std::exp(-r * r / (w * w)));
    }
  const Image view = look(field, slm, z, {}, {}, {}, {.angle = angle});
  const double spread = w * std::sqrt(1 + std::pow(z / rayleigh, 2)), radius = z * angle / 2;
  const double peak = std::pow(w / spread, 2);
  double most = 0;
  std::vector<double> off;
  for (int i = 128; i < 256; i += 8) {
    double sum = 0, count = 0;
    for (int b = 0; b < 200; ++b)
      for (int a = 0; a < 200; ++a) {
        const double x = radius * ((a + 0.5) / 100 - 1), y = radius * ((b + 0.5) / 100 - 1);
        if (std::hypot(x, y) > radius) continue;
        const double from = std::pow(field.grid.x(i) - x, 2) + std::pow(field.grid.y(128) - y, 2);
        sum += peak * std::exp(-2 * from / (spread * spread));
        count += 1;
      }
    most = std::max(most, sum / count);
    off.push_back(view(128, i) - sum / count);
  }
  for (const double difference : off) EXPECT_NEAR(difference, 0, 0.003 * most);  // integration: 0.26 %
}

// Speckle of a square panel S has the coherence μ = sinc(Sx/λz)·sinc(Sy/λz). A disc of radius R and the same disc
// shifted by d overlap by K(d) = 2/π·(acos(d/2R) − d/2R·√(1 − (d/2R)²))/πR². Averaged over the disc, the contrast is
// C² = ∫ K·|μ|². Twelve fields of some 20 independent discs each: 1/√(2·240) = 5 %, three times that.
TEST(Source, AWideSourceSmoothsSpeckleToItsClosedForm) {
  const int side = 160;
  const Slm slm = make_panel(side, side);
  const double z = 60_mm, grain = test_wavelength * z / (side * test_pitch), radius = 3.5 * grain;  // grains of 25 µm
  const double step = grain / 16;
  double expected = 0;
  for (double y = -2 * radius; y <= 2 * radius; y += step)
    for (double x = -2 * radius; x <= 2 * radius; x += step) {
      const double t = std::hypot(x, y) / (2 * radius);
      if (t >= 1) continue;
      const double overlap = 2 / pi * (std::acos(t) - t * std::sqrt(1 - t * t)) / (pi * radius * radius);
      expected += overlap * std::pow(sinc(x / grain) * sinc(y / grain), 2) * step * step;
    }
  CameraParams camera;
  camera.width = camera.height = 0.8_mm;
  double variance = 0, point_variance = 0;
  const int fields = 12;
  for (int n = 0; n < fields; ++n) {
    Field field(slm.grid, test_wavelength);
    CounterRandom random(11, uint32_t(n), 0);
    for (auto& u : field.samples.values) u = std::complex<float>(std::polar(1.0, 2 * pi * random.uniform()));
    variance += std::pow(speckle_contrast(look(field, slm, z, {}, camera, {}, {.angle = 2 * radius / z})), 2) / fields;
    point_variance += std::pow(speckle_contrast(look(field, slm, z, {}, camera)), 2) / fields;
  }
  EXPECT_NEAR(std::sqrt(variance / expected), 1, 0.15);
  EXPECT_GT(std::sqrt(point_variance), 0.8);  // a point source keeps nearly all of it, in pixels of a third of a grain
}

TEST(Source, PartsTileTheDisc) {
  const Slm slm = make_panel(4, 4);
  const double angle = 0.01;
  const std::vector<IlluminationState> all =
      illumination_states(slm, {.tilt_x = 0.02, .source_angle = angle, .illumination_states = 7}, test_wavelength);
  double sum = 0;
  for (const IlluminationState& state : all) {
    ASSERT_EQ(state.source.count(), 7u);
    EXPECT_NEAR(state.source.place()[0], state.tilt_x - 0.02, 1e-15);
    const int reach = int(std::ceil(0.1 * state.source.reach() / 4_um));
    for (const float weight : source_image(state.source, 0.1, 4_um, reach).values) sum += double(weight) / 7;
  }
  EXPECT_NEAR(sum, 1, 1e-3);  // 1 mm in samples of 4 µm: 16 · 125² directions in the disc, less those of its rim
  for (int j = -12; j <= 12; ++j)
    for (int i = -12; i <= 12; ++i) {
      const double x = i * angle / 20.1, y = j * angle / 20.1;
      int holding = 0;
      for (const IlluminationState& state : all) {
        const auto [x0, y0] = state.source.place();
        if (!state.source.holds(x - x0, y - y0)) continue;
        ++holding;
        EXPECT_LE(std::hypot(x - x0, y - y0), state.source.reach());
      }
      EXPECT_EQ(holding, std::hypot(x, y) <= angle / 2 ? 1 : 0) << i << " " << j;
    }
}

// All parts together give a view the light of a point source, however small or large the picture of the source is. The
// parts share the directions, so the sum is 1 except for rounding of its floats: 6e-8 of each weight. Required: 1e-3.
TEST(Source, PartsOfPicturesOfAllSizesSumToTheWhole) {
  const Slm slm = make_panel(4, 4);
  const double angle = 0.01;
  for (const int count : {1, 7, 64}) {
    const std::vector<IlluminationState> all =
        illumination_states(slm, {.source_angle = angle, .illumination_states = count}, test_wavelength);
    for (const double radius : {0.001, -0.01, 0.03, -0.2, 0.7, -3.3, 20.0, -100.0}) {  // below 0: behind the panel
      const double z = radius * 4_um / (angle / 2);
      double sum = 0;
      for (const IlluminationState& state : all) {
        const int reach = int(std::ceil(std::abs(z) * state.source.reach() / 4_um));
        for (const float weight : source_image(state.source, z, 4_um, reach).values) sum += double(weight) / count;
      }
      EXPECT_NEAR(sum, 1, 1e-3) << count << " parts, " << radius << " samples";
    }
  }
}

// A direction at (x, y) inside the first sample, spread linearly, gives the next sample along each axis the weights |x|
// and |y|. Over a disc of radius R the mean of |x| is 4R/3π. 64 directions across the disc have an error below 1 %.
TEST(Source, APictureWithinASampleIsSpreadAsItsDisc) {
  for (const double radius : {0.004, 0.1, 0.8}) {
    const SourcePart disc{0.01};
    const Array2D<float> kernel = source_image(disc, radius * 4_um / 0.005, 4_um, 1);
    double spread = 0;
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) spread += double(kernel(j + 1, i + 1)) * (i * i + j * j);
    EXPECT_NEAR(spread / (8 * radius / (3 * pi)), 1, 0.01) << radius;
  }
}

// Inside a large disc all samples have the weight 1/πR² to the rounding of floats. Counting 4 directions per sample and
// axis gives the area to 1e-3 at R = 150.3: that of the rim, 4·2π·R directions, is exact to 1/8R.
TEST(Source, ALargePictureIsEven) {
  const double radius = 150.3;
  const Array2D<float> kernel = source_image({0.01}, radius * 4_um / 0.005, 4_um, 151);
  for (int j = -151; j <= 151; ++j)
    for (int i = -151; i <= 151; ++i)
      if (std::hypot(i, j) < radius - 2) {
        ASSERT_NEAR(double(kernel(j + 151, i + 151)) * pi * radius * radius, 1, 1e-3) << i << " " << j;
      }
}

// A part to the right of its point blurs to the right in front of the panel, and to the left behind it, where light is
// traced back. A part above its point blurs upward.
TEST(Source, APartMovesLightToItsSide) {
  const auto points = std::make_shared<const SourcePart::Points>(SourcePart::Points{{0.002, 0.002}, {-0.003, -0.003}});
  const SourcePart part{0.01, points, 0};
  for (const double z : {0.05, -0.05}) {
    const int reach = int(std::ceil(std::abs(z) * part.reach() / 4_um));
    const Array2D<float> kernel = source_image(part, z, 4_um, reach);
    double x = 0, y = 0, all = 0, of_part_x = 0, of_part_y = 0, count = 0;
    for (int j = -reach; j <= reach; ++j)
      for (int i = -reach; i <= reach; ++i) {
        const double weight = kernel(j + reach, i + reach);
        all += weight, x += weight * i * 4_um, y -= weight * j * 4_um;
        const double ax = i * 1e-4, ay = j * 1e-4;  // the directions themselves, up to the part's edge
        if (std::hypot(0.002 + ax, 0.002 + ay) > 0.005 || std::hypot(ax, ay) > std::hypot(ax + 0.005, ay + 0.005))
          continue;
        count += 1, of_part_x += ax, of_part_y += ay;
      }
    EXPECT_NEAR(x / all, z * of_part_x / count, 2_um);  // half a sample
    EXPECT_NEAR(y / all, z * of_part_y / count, 2_um);
    EXPECT_GT(std::abs(x / all), 10_um);
    EXPECT_GT(std::abs(y / all), 10_um);
  }
}

TEST(Source, AConvolutionIsTheSumOverItsKernel) {
  Array2D<float> values(19, 23), kernel(3, 5);
  for (size_t i = 0; i < values.size(); ++i) values.values[i] = float(1 + (i * 7919) % 13);
  for (size_t i = 0; i < kernel.size(); ++i) kernel.values[i] = float(i + 1);
  const Array2D<float> out = convolved(values, kernel);
  for (int j = 1; j < 18; ++j)
    for (int i = 2; i < 21; ++i) {
      double sum = 0;
      for (int b = -1; b <= 1; ++b)
        for (int a = -2; a <= 2; ++a) sum += double(kernel(b + 1, a + 2)) * double(values(j - b, i - a));
      ASSERT_NEAR(out(j, i), sum, 1e-5 * 1560);  // floats, of the greatest sum
    }
  EXPECT_EQ(error_of([&] { convolved(kernel, values); }),
            "expected a kernel of odd sides within 5 × 3 samples, got 23 × 19");
}

}  // namespace
}  // namespace holotrace
