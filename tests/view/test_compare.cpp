#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/view/compare.h"
#include "holotrace/view/comparison_plots.h"
#include "support/panels.h"

namespace holotrace {
namespace {

Image random_image(int ny, int nx, int channels, uint64_t seed) {
  Image image(ny, nx, channels);
  CounterRandom random(seed, 0, 0);
  for (float& v : image.values) v = float(random.uniform());
  return image;
}

TEST(Compare, IdenticalImages) {
  const Image image = random_image(20, 30, 3, 1);
  const Metrics m = compare(image, image);
  EXPECT_TRUE(std::isinf(m.psnr_unscaled) && m.psnr_unscaled > 0);
  EXPECT_TRUE(std::isinf(m.psnr) && m.psnr > 0);
  EXPECT_EQ(m.scale, 1);
  EXPECT_EQ(m.rms_error, 0);
  EXPECT_DOUBLE_EQ(m.ssim, 1);
  EXPECT_DOUBLE_EQ(m.ssim_unscaled, 1);
  EXPECT_NEAR(m.speckle_contrast, 0, 1e-12);
  EXPECT_EQ(m.power_ratio, 1);
}

TEST(Compare, AScaleIsFittedAway) {
  const Image reference = random_image(16, 16, 1, 2);
  Image image = reference;
  for (float& v : image.values) v *= 0.25F;  // exact in binary
  const Metrics m = compare(reference, image);
  EXPECT_EQ(m.scale, 4);
  EXPECT_TRUE(std::isinf(m.psnr));
  EXPECT_DOUBLE_EQ(m.ssim, 1);
  EXPECT_EQ(m.power_ratio, 0.25);
  double squares = 0;
  for (float v : reference.values) squares += double(v) * v / double(reference.values.size());
  const double peak = *std::max_element(reference.values.begin(), reference.values.end());
  EXPECT_NEAR(m.psnr_unscaled, 10 * std::log10(peak * peak / (0.5625 * squares)), 1e-9);  // (1 − 0.25)²
}

TEST(Compare, ConstantImagesHaveTheClosedForm) {
  // Without variance, SSIM is its luminance term (2ab + c₁)/(a² + b² + c₁), c₁ = (0.01·L)²; PSNR 20·log₁₀(L/|a − b|).
  const double a = 0.75, b = 0.5;
  Image reference(15, 15, 1), image(15, 15, 1);
  std::fill(reference.values.begin(), reference.values.end(), float(a));
  std::fill(image.values.begin(), image.values.end(), float(b));
  const Metrics m = compare(reference, image);
  const double c1 = 1e-4 * a * a;
  EXPECT_NEAR(m.ssim_unscaled, (2 * a * b + c1) / (a * a + b * b + c1), 1e-12);
  EXPECT_NEAR(m.psnr_unscaled, 20 * std::log10(a / 0.25), 1e-12);
  EXPECT_DOUBLE_EQ(m.scale, 1.5);
}

TEST(Compare, ABlackImageHasThePsnrOfTheLitPixels) {
  Image reference(20, 50, 1);
  for (const int pixel : {3, 500, 501, 999}) reference.values[size_t(pixel)] = 0.7F;
  // 4 of 1000 equal pixels: 10·lg(1000/4), whatever their brightness; and what compare finds for black.
  EXPECT_NEAR(psnr_of_black(reference), 10 * std::log10(250), 1e-12);
  EXPECT_NEAR(compare(reference, Image(20, 50, 1)).psnr, psnr_of_black(reference), 1e-12);
  EXPECT_NE(error_of([] { psnr_of_black(Image(2, 2, 1)); }).find("light in it"), std::string::npos);
}

TEST(Compare, AmplitudesAreTheRootsWithTheirOwnScale) {
  Image reference(1, 4, 1), image(1, 4, 1);
  reference.values = {4, 1, 1, 0};  // amplitudes 2, 1, 1, 0
  image.values = {1, 1, 0, -0.5F};  // 1, 1, 0, and 0 for the value below 0
  // s = (2 + 1)/(1 + 1) = 1.5, so the amplitudes differ by ½, −½, 1, 0: a mean square of 1.5/4. The largest is 2.
  EXPECT_NEAR(compare(reference, image).psnr_amplitude, 10 * std::log10(2 * 2 / (1.5 / 4)), 1e-12);
}

// SSIM as in the paper: a two-dimensional window at every pixel at which it fits.
double slow_similarity(const Image& a, const Image& b, double L) {
  double weights[11][11], total = 0, sum = 0;
  for (int y = 0; y < 11; ++y)
    for (int x = 0; x < 11; ++x)
      total += weights[y][x] = std::exp(-((x - 5) * (x - 5) + (y - 5) * (y - 5)) / (2 * 1.5 * 1.5));
  for (int j = 0; j + 11 <= a.ny; ++j)
    for (int i = 0; i + 11 <= a.nx; ++i) {
      double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
      for (int y = 0; y < 11; ++y)
        for (int x = 0; x < 11; ++x)
          ma += weights[y][x] / total * a(j + y, i + x), mb += weights[y][x] / total * b(j + y, i + x);
      for (int y = 0; y < 11; ++y)
        for (int x = 0; x < 11; ++x) {
          const double da = a(j + y, i + x) - ma, db = b(j + y, i + x) - mb, w = weights[y][x] / total;
          aa += w * da * da, bb += w * db * db, ab += w * da * db;
        }
      const double c1 = 1e-4 * L * L, c2 = 9e-4 * L * L;
      sum += (2 * ma * mb + c1) * (2 * ab + c2) / ((ma * ma + mb * mb + c1) * (aa + bb + c2));
    }
  return sum / (double(a.ny - 10) * (a.nx - 10));
}

TEST(Compare, SimilarityAgreesWithItsDefinition) {
  const Image reference = random_image(23, 31, 1, 3);
  Image image = random_image(23, 31, 1, 4);
  for (size_t i = 0; i < image.values.size(); ++i)
    image.values[i] = 0.6F * reference.values[i] + 0.4F * image.values[i];
  const double peak = *std::max_element(reference.values.begin(), reference.values.end());
  EXPECT_NEAR(compare(reference, image).ssim_unscaled, slow_similarity(reference, image, peak), 1e-12);  // double
}

TEST(Compare, SimilarityOfASmallImageTakesASmallWindow) {
  EXPECT_DOUBLE_EQ(compare(random_image(4, 7, 1, 5), random_image(4, 7, 1, 5)).ssim, 1);
  EXPECT_DOUBLE_EQ(compare(random_image(1, 1, 1, 5), random_image(1, 1, 1, 5)).ssim, 1);
}

TEST(Compare, LeastSquaresScaleIsBestAndItsErrorIsOrthogonal) {
  // The residual of a least-squares fit is orthogonal to the image: rms² = (Σr² − s·Σrv)/n.
  const Image reference = random_image(12, 12, 3, 6), image = random_image(12, 12, 3, 7);
  const Metrics m = compare(reference, image);
  double rr = 0, rv = 0, vv = 0;
  for (size_t i = 0; i < image.values.size(); ++i) {
    rr += double(reference.values[i]) * reference.values[i];
    rv += double(reference.values[i]) * image.values[i];
    vv += double(image.values[i]) * image.values[i];
  }
  EXPECT_NEAR(m.scale, rv / vv, 1e-12);
  EXPECT_NEAR(m.rms_error * m.rms_error, (rr - rv * rv / vv) / double(image.values.size()), 1e-12);
  EXPECT_GE(m.psnr, m.psnr_unscaled);
}

TEST(Compare, BrightFractionIsTheLightInsideTheWantedRegion) {
  Image reference(10, 10, 1), image(10, 10, 1);
  for (int j = 0; j < 10; ++j)
    for (int i = 0; i < 10; ++i) {
      reference(j, i) = i < 5 ? 1.0F : 0.05F;  // 0.05 is below a tenth of the maximum
      image(j, i) = i < 5 ? 3.0F : 1.0F;
    }
  EXPECT_NEAR(compare(reference, image).bright_fraction, 0.75, 1e-12);
  EXPECT_NEAR(compare(reference, image, {.bright = 0.01}).bright_fraction, 1, 1e-12);
}

TEST(Compare, SaysWhatIsWrong) {
  const Image a = random_image(4, 6, 1, 1);
  EXPECT_EQ(
      error_of([&] { compare(a, random_image(6, 4, 3, 1)); }),
      "expected an image of 6 × 4 pixels and 1 channel(s), as its reference, got 4 × 6 and 3; resample or crop one "
      "of them");
  Image bad = a;
  bad(2, 5) = std::numeric_limits<float>::infinity();
  EXPECT_EQ(error_of([&] { compare(a, bad); }), "expected finite values in the image, got inf at row 2, column 5");
  EXPECT_EQ(error_of([&] { compare(Image(4, 6, 1), a); }),
            "expected a reference with light in it, got one whose maximum is 0");
  EXPECT_EQ(error_of([&] {
              compare(Field({4, 4, test_pitch}, test_wavelength), Field({4, 5, test_pitch}, test_wavelength));
            }),
            "expected a field of 4 × 4 samples, as its reference, got 4 × 5");
}

// 1000 ratios from 0.5 to 1.499 in even steps: the 10th is 0.509, the 990th 1.489. One dark and one too bright pixel
// replace the outermost ratios; the result does not change.
TEST(Compare, UniformityIsThatOfPercentiles) {
  Image reference(25, 40, 1), image(25, 40, 1);
  for (size_t i = 0; i < 1000; ++i) {
    reference.values[i] = 1 + float(i % 7) / 7;
    image.values[i] = (0.5F + float(i * 389 % 1000) / 1000) * reference.values[i];
  }
  const double expected = 1 - (1.489 - 0.509) / (1.489 + 0.509);
  EXPECT_NEAR(compare(reference, image).uniformity, expected, 1e-6);
  for (size_t i = 0; i < 1000; ++i)
    if (i * 389 % 1000 == 0)
      image.values[i] = 0;
    else if (i * 389 % 1000 == 999)
      image.values[i] = 100;
  EXPECT_NEAR(compare(reference, image).uniformity, expected, 1e-6);
  EXPECT_EQ(compare(reference, reference).uniformity, 1);
}

TEST(Difference, IsGreyWhereEqualAndColouredBySign) {
  Image reference(1, 4, 1), image(1, 4, 1);
  reference.values = {1, 1, 1, 1};
  image.values = {0.5F, 0.75F, 0.25F, 0.375F};  // twice: 0, +0.5, −0.5, −0.25
  const DifferenceImage difference = difference_image(reference, image, 2);
  EXPECT_EQ(difference.range, 0.5);
  const auto expect_colour = [&](int column, double red, double green, double blue) {
    EXPECT_NEAR(difference.image(0, column, 0), red, 1e-4);  // the codes' linear light, to four digits
    EXPECT_NEAR(difference.image(0, column, 1), green, 1e-4);
    EXPECT_NEAR(difference.image(0, column, 2), blue, 1e-4);
  };
  expect_colour(0, 0.2159, 0.2159, 0.2159);              // #808080
  expect_colour(1, 0.6654, 0.1119, 0);                   // #D55E00
  expect_colour(2, 0, 0.1683, 0.4452);                   // #0072B2
  expect_colour(3, 0.2159 / 2, 0.3842 / 2, 0.6611 / 2);  // half way from grey
  EXPECT_EQ(difference_image(reference, image, 2, 0.25).range, 0.25);
  EXPECT_EQ(difference_image(reference, reference, 1).image(0, 0, 2), 0.2159F);
}

TEST(CompareFields, ErrorCorrelationAndScaleOfAKnownDifference) {
  // Two orthogonal plane waves r and e: f = c·(r + ε·e) has correlation c/(|c|·√(1+ε²)), scale 1/(c(1+ε²)).
  const Grid grid{32, 16, test_pitch};
  const std::complex<double> c = std::polar(2.0, 0.7);
  const double epsilon = 0.1;
  const FieldDouble r = convert<double>(sum_of({{2, 1, 1}}, grid));
  const FieldDouble f = convert<double>(sum_of({{2, 1, c}, {-3, 2, c * epsilon}}, grid));
  const FieldMetrics m = compare(r, f);
  const double tolerance = 1e-6;  // the fields were made in single precision
  EXPECT_LT(std::abs(m.correlation - std::polar(1 / std::sqrt(1 + epsilon * epsilon), 0.7)), tolerance);
  EXPECT_LT(std::abs(m.scale - 1.0 / (c * (1 + epsilon * epsilon))), tolerance);
  EXPECT_NEAR(m.relative_error, std::sqrt(std::norm(c - 1.0) + std::norm(c * epsilon)), tolerance);
  EXPECT_NEAR(m.scaled_error, epsilon / std::sqrt(1 + epsilon * epsilon), tolerance);
  EXPECT_EQ(compare(r, r).relative_error, 0);
}

// Noise that is the same in a whole window adds nothing to its variance, so nothing is subtracted. Noise that alternates by
// ±0.1 has the variance 0.01.
TEST(StructuralSimilarity, LeavesOutTheVarianceOfTheNoiseInEachWindow) {
  Image reference(24, 24, 1), noisy(24, 24, 1), view(24, 24, 1);
  std::vector<float> even(reference.values.size(), 0.1F), alternating(even.size());
  for (int j = 0; j < 24; ++j)
    for (int i = 0; i < 24; ++i) {
      const size_t at = size_t(24 * j + i);
      alternating[at] = (i + j) % 2 ? 0.1F : -0.1F;
      reference.values[at] = 0.3F + 0.02F * float(i);
      noisy.values[at] = reference.values[at] + alternating[at];
      view.values[at] = 0.3F + 0.02F * float(j);
    }
  const double without = structural_similarity(reference, view, 1, 1);
  EXPECT_NEAR(structural_similarity(reference, view, 1, 1, even), without, 1e-9);
  EXPECT_GT(std::abs(structural_similarity(noisy, view, 1, 1) - without), 0.05) << "else the line below claims little";
  EXPECT_NEAR(structural_similarity(noisy, view, 1, 1, alternating), without,
              0.005);  // the ramp and the noise mix a little
}

}  // namespace
}  // namespace holotrace
