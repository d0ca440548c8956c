#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>

#include "holotrace/base/random.h"
#include "holotrace/view/compare.h"
#include "holotrace/view/register/register.h"
#include "support/panels.h"

namespace holotrace {
namespace {

// A picture known at every place, so that a rotated and scaled copy has no resampling error: the exponential of a
// sum of waves with periods from 6 to 120 pixels, in all directions.
class Picture {
 public:
  explicit Picture(uint64_t seed, double shortest = 6) {
    CounterRandom random(seed, 0, 0);
    for (Wave& w : waves_) {
      const double period = shortest * std::pow(20, random.uniform()), angle = 2 * pi * random.uniform();
      w = {2 * pi / period * std::cos(angle), 2 * pi / period * std::sin(angle), 2 * pi * random.uniform()};
    }
  }
  double operator()(double x, double y) const {
    double sum = 0;
    for (const Wave& w : waves_) sum += std::cos(w.x * x + w.y * y + w.phase);
    return 0.3 * std::exp(0.7 * sum * std::sqrt(2.0 / std::size(waves_)));  // all waves together have rms 1
  }

 private:
  struct Wave {
    double x, y, phase;
  } waves_[40];
};

double gaussian(CounterRandom& random) {
  const double u = 1 - random.uniform();
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * pi * random.uniform());
}

// Speckle of mean 1 and contrast 1/√frames with grains of some 2 pixels: the intensity of complex Gaussian noise
// smoothed by (1, 2, 1), of variance 2·(6/16)² per frame.
Image speckle(int ny, int nx, int frames, uint64_t seed) {
  Image out(ny, nx, 1);
  for (int frame = 0; frame < frames; ++frame) {
    CounterRandom random(seed, uint32_t(frame), 0);
    std::vector<std::complex<double>> u(size_t(ny + 2) * size_t(nx + 2));
    for (auto& v : u) v = {gaussian(random), gaussian(random)};
    const auto at = [&](int j, int i) { return u[size_t(j) * size_t(nx + 2) + size_t(i)]; };
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        std::complex<double> sum = 0;
        for (int y = 0; y < 3; ++y)
          for (int x = 0; x < 3; ++x) sum += (y == 1 ? 0.5 : 0.25) * (x == 1 ? 0.5 : 0.25) * at(j + y, i + x);
        out(j, i) += float(std::norm(sum) / (2 * 0.375 * 0.375) / frames);
      }
  }
  return out;
}

struct Shown {
  int nx, ny;
  int speckle_frames = 0;  // 0: none
  double noise = 0;        // per pixel, as a fraction of the gain
};

// The photograph of a picture under a registration, at each pixel q; p = R(−rotation)·(q − shift)/scale.
Image show(const Picture& picture, const Registration& r, const Shown& shown, uint64_t seed) {
  Image image(shown.ny, shown.nx, 1);
  const Image grain = shown.speckle_frames > 0 ? speckle(shown.ny, shown.nx, shown.speckle_frames, seed) : Image();
  CounterRandom random(seed, 1000, 0);
  const double c = std::cos(r.rotation) / r.scale, s = std::sin(r.rotation) / r.scale;
  for (int j = 0; j < shown.ny; ++j)
    for (int i = 0; i < shown.nx; ++i) {
      const double x = i - (shown.nx - 1) / 2.0 - r.shift_x, y = (shown.ny - 1) / 2.0 - j - r.shift_y;
      double value = picture(c * x + s * y, -s * x + c * y);
      if (shown.speckle_frames > 0) value *= grain(j, i);
      image(j, i) = float(r.gain * (value + shown.noise * gaussian(random)) + r.offset);
    }
  return image;
}

// Error of a registration at the worst corner of a picture of that size [pixels of the photograph].
double worst_corner(const Registration& found, const Registration& truth, int ny, int nx) {
  double worst = 0;
  for (const double x : {-nx / 2.0, nx / 2.0})
    for (const double y : {-ny / 2.0, ny / 2.0}) {
      const auto p = found(x, y), q = truth(x, y);
      worst = std::max(worst, std::hypot(p[0] - q[0], p[1] - q[1]));
    }
  return worst;
}

Registration truth_of(double scale, double degrees, double x, double y, double gain, double offset = 0) {
  Registration r;
  r.scale = scale;
  r.rotation = degrees * pi / 180;
  r.shift_x = x;
  r.shift_y = y;
  r.gain = gain;
  r.offset = offset;
  return r;
}

struct Case {
  const char* name;
  Registration truth;
  Shown photograph, simulation;
};

class Register : public testing::TestWithParam<Case> {};

// A tenth of a pixel at the worst corner, and so everywhere inside. Pictures and noise are chosen so that the standard
// error that the registration states is below that too; the noise is the same in every run.
TEST_P(Register, RecoversAKnownMapToATenthOfAPixel) {
  const auto& [name, truth, photograph, simulation] = GetParam();
  const Picture picture(7);
  const Image moving = show(picture, truth, photograph, 1), fixed = show(picture, {}, simulation, 2);
  const Registration found = register_image(moving, fixed);
  EXPECT_LT(worst_corner(found, truth, simulation.ny, simulation.nx), 0.1) << found.uncertainty;
  EXPECT_LT(found.uncertainty, 0.1);
  // The light is a mean over some 10⁴ grains of contrast 1 at most, in two pictures: 2 %, two times that.
  EXPECT_NEAR(found.gain / truth.gain, 1, 0.04);
}

INSTANTIATE_TEST_SUITE_P(
    Register, Register,
    testing::Values(Case{"as_it_is", truth_of(1, 0, 0, 0, 1), {256, 200}, {256, 200}},
                    Case{"smaller", truth_of(0.7, -30, 20.3, -12.6, 0.3), {300, 260, 4, 0.01}, {320, 256}},
                    Case{"larger", truth_of(1.4, 30, -25.2, 14.7, 3), {600, 520, 9, 0.01}, {400, 360, 9, 0.01}},
                    Case{"quarter_turn", truth_of(1.1, 90, 33.1, 8.4, 2), {320, 400, 2, 0.02}, {360, 256}},
                    Case{"upside_down", truth_of(0.9, 180, 5.5, -9.25, 1), {400, 320}, {360, 300, 2, 0.02}},
                    Case{"strong_speckle", truth_of(1.2, 8, 40.3, -31.7, 0.5), {512, 440, 1, 0.01}, {400, 360}}),
    [](const auto& info) { return std::string(info.param.name); });

// What a JPEG of that quality keeps of values 0 … 255: each cosine of 8 × 8 pixels is rounded to multiples of the standard's
// table for luminance (ITU T.81, table K.1), scaled as libjpeg scales it.
void compress(Image& image, int channel, double quality) {
  constexpr int table[64] = {16, 11, 10, 16, 24,  40,  51,  61,  12, 12, 14, 19, 26,  58,  60,  55,
                             14, 13, 16, 24, 40,  57,  69,  56,  14, 17, 22, 29, 51,  87,  80,  62,
                             18, 22, 37, 56, 68,  109, 103, 77,  24, 35, 55, 64, 81,  104, 113, 92,
                             49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99};
  const double percent = quality < 50 ? 5000 / quality : 200 - 2 * quality;
  double cosine[8][8];  // [frequency][place], orthonormal
  for (int k = 0; k < 8; ++k)
    for (int x = 0; x < 8; ++x) cosine[k][x] = std::sqrt((k == 0 ? 1 : 2) / 8.0) * std::cos((2 * x + 1) * k * pi / 16);
  for (int top = 0; top + 8 <= image.ny; top += 8)
    for (int left = 0; left + 8 <= image.nx; left += 8) {
      double kept[8][8] = {};
      for (int v = 0; v < 8; ++v)
        for (int u = 0; u < 8; ++u) {
          double sum = 0;
          for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x)
              sum += cosine[v][y] * cosine[u][x] * (double(image(top + y, left + x, channel)) - 128);
          const double step = std::max(1.0, std::floor((table[8 * v + u] * percent + 50) / 100));
          const double rounded = step * std::round(sum / step);
          for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) kept[y][x] += cosine[v][y] * cosine[u][x] * rounded;
        }
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) image(top + y, left + x, channel) = float(std::clamp(kept[y][x] + 128, 0.0, 255.0));
    }
}

// A camera's picture of a screen: turned, larger or smaller, tinted, darker toward its corners, noisy and a JPEG, all at once.
// One pixel is what a comparison of blurred details needs; noise of 0.06 of white in each of 10⁵ pixels allows far less.
TEST(RegisterImage, AViewThatIsTurnedTintedShadedNoisyAndCompressedIsPlacedWithinAPixel) {
  struct Camera {
    double scale, degrees;
    int nx, ny;
    double shading, noise, quality;
  };
  for (const Camera& camera : {Camera{1.5, 4, 480, 384, 0.5, 0.05, 40},
                               {1.5, -4, 320, 256, 0.6, 0.06, 30},
                               {0.7, 6, 320, 256, 0.3, 0.08, 50},
                               {1.1, -2, 352, 280, 0.6, 0.02, 70}})
    for (const uint64_t seed : {3, 4}) {
      const Picture picture(seed, 10);
      const Registration truth = truth_of(camera.scale, camera.degrees, 9.3, -6.4, 0.25);
      const Image fixed = show(picture, {}, {320, 256}, 1), plain = show(picture, truth, {camera.nx, camera.ny}, 2);
      Image moving(plain.ny, plain.nx, 3);
      CounterRandom random(seed, 2000, 0);
      for (int j = 0; j < plain.ny; ++j)
        for (int i = 0; i < plain.nx; ++i) {
          const double x = 2.0 * i / (plain.nx - 1) - 1, y = 2.0 * j / (plain.ny - 1) - 1;
          for (int c = 0; c < 3; ++c) {
            const double light =
                plain(j, i) * (1 - camera.shading * (x * x + y * y) / 2) * (c == 1 ? 1 : 0.5 + 0.1 * c);
            const double code = std::pow(std::clamp(light, 0.0, 1.0), 1 / 2.2) + camera.noise * gaussian(random);
            moving(j, i, c) = float(std::round(255 * std::clamp(code, 0.0, 1.0)));
          }
        }
      for (int c = 0; c < 3; ++c) compress(moving, c, camera.quality);
      for (float& value : moving.values) value = std::pow(value / 255, 2.2F);
      const Registration found = register_image(moving, fixed);
      EXPECT_LT(worst_corner(found, truth, fixed.ny, fixed.nx), 1) << camera.scale << " " << seed;
    }
}

// A white page with thin lines, on a dark table: the page's edge is far stronger than its lines. Without the table all is well.
TEST(RegisterImage, NamesTheDarkGroundOfABrightPicture) {
  const auto page = [](double x, double y) {
    const double curve = 60 - 120 / (1 + std::exp(-x / 12)) + 25 * std::sin(x / 15);
    return std::abs(x) > 150 || std::abs(y) > 100               ? 0.0
           : std::abs(y - curve) < 1 || std::abs(x + 120) < 0.7 ? 0.3
                                                                : 1.0;
  };
  Image fixed(192, 288, 1), moving(224, 320, 1);
  const double c = std::cos(0.09) / 0.9, s = std::sin(0.09) / 0.9;
  for (int j = 0; j < fixed.ny; ++j)
    for (int i = 0; i < fixed.nx; ++i) fixed(j, i) = float(page(i - 143.5, 95.5 - j));
  for (int j = 0; j < moving.ny; ++j)
    for (int i = 0; i < moving.nx; ++i) {
      const double x = i - 159.5, y = 111.5 - j;
      moving(j, i) = float(page(c * x + s * y, c * y - s * x));
    }
  const std::string error = error_of([&] { register_image(moving, fixed); });
  EXPECT_NE(error.find("the photograph has a dark border that the simulation does not have: crop the photograph"),
            std::string::npos)
      << error;
}

TEST(RegisterImage, StatesAnErrorThatItKeeps) {
  // Three standard errors are exceeded once in some hundred cases; without noise the error nearly vanishes.
  const Picture picture(3);
  const Registration truth = truth_of(1.05, 5, 3, -4, 1);
  const Image fixed = show(picture, {}, {160, 128}, 1);
  const Registration noisy = register_image(show(picture, truth, {160, 128, 2, 0.02}, 2), fixed);
  EXPECT_LT(worst_corner(noisy, truth, 128, 160), 3 * noisy.uncertainty);
  EXPECT_GT(noisy.uncertainty, 0.02);  // some 5000 grains of contrast 0.7
  const Registration clean = register_image(show(picture, truth, {160, 128}, 2), fixed);
  EXPECT_LT(clean.uncertainty, 0.02);
  EXPECT_LT(worst_corner(clean, truth, 128, 160), 0.05);
}

TEST(RegisterImage, TellsAnOffsetFromAGainUnderSpeckleInBoth) {
  const Picture picture(4, 12);
  const Registration truth = truth_of(1, 3, 2, 1, 2, 0.5);
  const Image moving = show(picture, truth, {256, 256, 4, 0}, 1), fixed = show(picture, {}, {256, 256, 4, 0}, 2);
  const Registration found = register_image(moving, fixed, {.offset = true});
  EXPECT_NEAR(found.gain, 2, 0.2);  // least squares on the pixels would find 2/(1 + speckle/structure), about 1.4
  EXPECT_NEAR(found.offset, 0.5, 0.08);
}

// The photograph shows only a part of the simulation: the rest counts neither in the gain nor in the residual.
// Without noise the line through the blocks is exact except for the places (0.05 pixels of a picture with 12 pixels per
// period) and the blur at the photograph's border: gains to 0.5 %. If the uncovered pixels counted as dark, the gain at
// 74 % would be 1.88 (offset 0.5) or 2.42 (offset 2).
TEST(RegisterImage, PixelsThatThePhotographDoesNotShowDoNotCount) {
  const Picture picture(4, 12);
  const Image fixed = show(picture, {}, {256, 256}, 1);
  double squares = 0;
  for (const float v : fixed.values) squares += double(v) * v;
  const double rms = std::sqrt(squares / double(fixed.values.size()));
  struct Part {
    int columns;
    double offset;
  };
  for (const auto& [columns, offset] : {Part{190, 0}, Part{190, 0.5}, Part{190, 2}, Part{130, 2}}) {  // 74 and 50 %
    const Registration truth = truth_of(1, 2, (columns - 256) / 4.0, 3, 1.7, offset);
    const Image photograph = show(picture, truth, {columns, 256}, 1);
    const Registration found = register_image(photograph, fixed, {.offset = offset > 0});
    EXPECT_NEAR(found.overlap, columns / 256.0, 0.05);  // less what is rotated out of view, and the borders
    EXPECT_NEAR(found.gain / 1.7, 1, 0.005) << columns << " " << offset;
    EXPECT_NEAR(found.offset, offset, 0.01 * 1.7) << columns;  // 1 % of the light, whose mean is about 1/2
    EXPECT_LT(found.residual, 0.02 * rms) << columns << " " << offset;
  }
}

TEST(RegisterImage, AColourPhotographLiesAsItsMeanDoes) {
  const Picture picture(5);
  const Registration truth = truth_of(1, 0, 6, -4, 1);
  const Image grey = show(picture, truth, {128, 128}, 1), fixed = show(picture, {}, {128, 128}, 1);
  Image colour(grey.ny, grey.nx, 3);
  for (size_t i = 0; i < grey.values.size(); ++i) {
    colour.values[3 * i] = 2 * grey.values[i];
    colour.values[3 * i + 1] = grey.values[i];
  }
  const Registration found = register_image(colour, fixed);
  EXPECT_LT(worst_corner(found, truth, 128, 128), 0.03);  // no noise: only edges and cubic convolution
  EXPECT_NEAR(found.gain, 1, 1e-3);
}

TEST(RegisterImage, AnAlignedPhotographIsTheSimulation) {
  const Picture picture(6, 12);  // 12 pixels per period: cubic convolution is exact to some 1e-2
  const Registration truth = truth_of(1.3, 20, 10, -6, 2, 0.25);
  const Image moving = show(picture, truth, {300, 280}, 1), fixed = show(picture, {}, {200, 180}, 1);
  const AlignedImage aligned = align_image(moving, truth, fixed.ny, fixed.nx);
  EXPECT_GT(aligned.covered.rows, 120);
  EXPECT_GT(aligned.covered.columns, 120);
  const Metrics m = compare(cropped(fixed, aligned.covered), cropped(aligned.image, aligned.covered));
  EXPECT_GT(m.psnr_unscaled, 45);
  EXPECT_NEAR(m.scale, 1, 0.01);
}

TEST(RegisterImage, TheCoveredRectangleIsTheLargestOne) {
  // A shift by 10 columns and 5 rows uncovers as many. Cubic convolution needs one pixel before and two after.
  Registration shift = truth_of(1, 0, 10, -5, 1);
  const AlignedImage aligned = align_image(show(Picture(1), {}, {64, 48}, 1), shift, 48, 64);
  EXPECT_EQ(aligned.covered.first_column, 0);
  EXPECT_EQ(aligned.covered.columns, 64 - 10 - 2);
  EXPECT_EQ(aligned.covered.first_row, 0);
  EXPECT_EQ(aligned.covered.rows, 48 - 5 - 2);
}

TEST(RegisterImage, RefusesPicturesThatDoNotShowTheSame) {
  for (uint64_t seed = 0; seed < 2; ++seed) {
    const Image moving = show(Picture(20 + seed), {}, {128, 128}, 1),
                fixed = show(Picture(40 + seed), {}, {128, 128}, 1);
    const std::string error = error_of([&] { register_image(moving, fixed); });
    EXPECT_EQ(
        error.find("expected a photograph of what the simulation shows, with enough structure to locate it, got "), 0U)
        << error;
  }
}

TEST(RegisterImage, RefusesADiscWhichLooksTheSameAtEveryAngle) {
  Image disc(96, 96, 1);
  for (int j = 0; j < 96; ++j)
    for (int i = 0; i < 96; ++i) disc(j, i) = float(1 / (1 + std::exp(std::hypot(i - 47.5, j - 47.5) - 20)));
  EXPECT_EQ(error_of([&] {
              register_image(disc, disc);
            }).find("expected a photograph of what the simulation shows, with enough structure to locate it"),
            0U);
}

TEST(RegisterImage, SaysWhatIsWrong) {
  const Image good = show(Picture(1), {}, {32, 32}, 1);
  EXPECT_EQ(error_of([&] { register_image(Image(8, 32, 1), good); }),
            "expected a photograph of at least 16 × 16 pixels to register, got 32 × 8");
  EXPECT_EQ(error_of([&] { register_image(good, Image(32, 32, 1)); }),
            "expected a simulation with structure to register, got the same value 0 in every pixel");
  Image bad = good;
  bad(3, 4) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error_of([&] { register_image(bad, good); }), "expected finite values in the photograph, got nan");
  EXPECT_EQ(error_of([&] { register_image(good, good, {.smallest_scale = 2, .largest_scale = 1}); }),
            "expected scales to try above 0, the smallest no larger than the largest, got 2 to 1");
  EXPECT_EQ(error_of([&] { align_image(good, truth_of(1, 0, 28, 0, 1), 32, 32); }),
            "expected a photograph that covers 8 × 8 pixels of the simulation or more, got 2 × 29; show more of it");
}

}  // namespace
}  // namespace holotrace
