#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/targets.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

std::complex<double> inner(const AlignedVector<Complex>& a, const AlignedVector<Complex>& b) {
  std::complex<double> sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::conj(std::complex<double>(a[i])) * std::complex<double>(b[i]);
  return sum;
}

const Pupil small_pupil{{1e-4, -6e-5, 0.05}, 3e-4};

PupilPropagation to_pupils(const Slm& slm) {
  return {slm, test_wavelength, window_of_pupils(slm.grid, small_pupil.diameter), small_pupil.centre.z, {}};
}

Grid picture_of(const Grid& panel, const Pupil& pupil, double z) {
  return picture_grid(panel, panel.width(), panel.height(), pupil, test_wavelength, z);
}

TEST(PupilPropagation, WayBackIsTheAdjoint) {
  // Float sums of some ten thousand products: 1e-5 of the norms.
  const Slm slm = make_panel(72, 40);
  const PupilPropagation eyes = to_pupils(slm);
  const Field u = random_field(slm.grid, 1);
  Field g = eyes.dark_eye();
  g.samples = random_field(g.grid, 2).samples;
  const Field there = eyes.to_eye(u), back = eyes.to_panel(g);
  const double norms = std::sqrt(inner(there.samples.values, there.samples.values).real() *
                                 inner(g.samples.values, g.samples.values).real());
  EXPECT_LT(std::abs(inner(g.samples.values, there.samples.values) - inner(back.samples.values, u.samples.values)),
            1e-5 * norms);
}

// A window for pupils beside the axis is as small as can be, and on the panel's lattice, whether the panel has an even or an odd
// number of samples. There the light is that of a wide window, by the kernel of Rayleigh and Sommerfeld, which is the same sum in any.
TEST(PupilPropagation, WindowHoldsItsPartOnTheLatticeOfThePanel) {
  const PlanePart part{{3.1e-4, -5.3e-4}, {6.2e-4, -2.1e-4}};
  for (const int nx : {72, 73}) {
    const Slm slm = make_panel(nx, 40);
    const Grid window = pupil_window_grid(slm.grid, part), wide = window_of_pupils(slm.grid, 2e-3);
    EXPECT_LE(window.x(-0.5), part.low.x);
    EXPECT_GE(window.x(window.nx - 0.5), part.high.x);
    EXPECT_LE(window.y(window.ny - 0.5), part.low.y);
    EXPECT_GE(window.y(-0.5), part.high.y);
    EXPECT_LE(window.width(), part.high.x - part.low.x + 2 * window.pitch);
    const double column = (window.x(0) - wide.x(0)) / wide.pitch, row = (wide.y(0) - window.y(0)) / wide.pitch;
    ASSERT_NEAR(column, std::round(column), 1e-9);
    ASSERT_NEAR(row, std::round(row), 1e-9);
    const Field u = random_field(slm.grid, 1);
    const Field part_of_light =
        PupilPropagation(slm, test_wavelength, window, 0.3, {.aperture = PixelAperture::left_out}).to_eye(u);
    const Field light =
        PupilPropagation(slm, test_wavelength, wide, 0.3, {.aperture = PixelAperture::left_out}).to_eye(u);
    double error = 0, power = 0;
    for (int j = 0; j < window.ny; ++j)
      for (int i = 0; i < window.nx; ++i) {
        const Complex there = light.samples(j + int(std::lround(row)), i + int(std::lround(column)));
        error += std::norm(part_of_light.samples(j, i) - there);
        power += std::norm(there);
      }
    EXPECT_LT(std::sqrt(error / power), 1e-4) << nx;  // floats, of less light than the panel's whole
  }
}

// Also for a plane so near to the pupils that the picture is wider than the period λs/p of its transform.
TEST(PupilPropagation, PictureHasItsAdjoint) {
  const Slm slm = make_panel(72, 40);
  for (const double s : {small_pupil.centre.z + 0.03, 0.004}) {
    const double z = small_pupil.centre.z - s;
    const Grid picture = picture_of(slm.grid, small_pupil, z);
    ASSERT_EQ(picture.width() > test_wavelength * s / test_pitch, s == 0.004);
    Field eye = to_pupils(slm).dark_eye();
    eye.samples = random_field(eye.grid, 3).samples;
    const auto taken = take_picture(eye, small_pupil, z, picture);
    const auto g = random_field(picture, 4).samples;
    Field back(eye.grid, test_wavelength);
    add_picture_adjoint(g, small_pupil, z, picture, back);
    const double norms = std::sqrt(inner(taken.values, taken.values).real() * inner(g.values, g.values).real());
    ASSERT_GT(norms, 0);
    EXPECT_LT(std::abs(inner(g.values, taken.values) - inner(back.samples.values, eye.samples.values)), 1e-5 * norms)
        << s;
  }
}

// The same light by plain propagation through the disc, at the samples of the picture, which lie on pixels of the panel's
// lattice or between them: the irradiance is compared where a sample is within a tenth of a pixel of a pixel's middle.
TEST(PupilPropagation, PictureIsThatOfPlainPropagation) {
  const Slm slm = make_panel(101, 75);  // odd numbers: a pixel's middle is on the axis
  const double z = -0.03;
  const Field u = random_field(slm.grid, 5);
  const Grid picture = picture_of(slm.grid, small_pupil, z);
  const auto taken = take_picture(to_pupils(slm).to_eye(u), small_pupil, z, picture);
  Field in_pupil = to_pupils(slm).to_eye(u);
  for (int j = 0; j < in_pupil.grid.ny; ++j)
    for (int i = 0; i < in_pupil.grid.nx; ++i)
      if (std::hypot(in_pupil.grid.x(i) - small_pupil.centre.x, in_pupil.grid.y(j) - small_pupil.centre.y) >
          small_pupil.diameter / 2)
        in_pupil.samples(j, i) = 0;
  PropagateParams back;
  back.columns = slm.grid.nx;
  back.rows = slm.grid.ny;
  const Field plain = propagate(in_pupil, z - small_pupil.centre.z, back);
  double error = 0, power = 0;
  int compared = 0;
  for (int j = 0; j < picture.ny; ++j)
    for (int i = 0; i < picture.nx; ++i) {
      const double column = picture.x(i) / slm.grid.pitch + 50, row = 37 - picture.y(j) / slm.grid.pitch;
      const long at_column = std::lround(column), at_row = std::lround(row);
      if (std::hypot(column - double(at_column), row - double(at_row)) > 0.1) continue;
      const double a = std::norm(taken(j, i)), b = std::norm(plain.samples(int(at_row), int(at_column)));
      error += (a - b) * (a - b);
      power += b * b;
      ++compared;
    }
  ASSERT_GE(compared, 5);
  // A speckle is λs/D = 140 µm wide: a tenth of a pixel, 0.8 µm, changes it by some 2 %. Fresnel's approximation adds less.
  EXPECT_LT(std::sqrt(error / power), 0.04);
}

TEST(PupilPropagation, PicturesHaveTheSamplesThatTheirDetailNeeds) {
  const Slm slm = make_panel(101, 75);
  for (const double diameter : {1e-4, 3e-4, 5e-4}) {
    const Grid grid = picture_of(slm.grid, {{0, 0, 0.05}, diameter}, -0.03);
    EXPECT_LE(grid.pitch, test_wavelength * 0.08 / (2 * diameter));  // Nyquist's for the cut-off D/λs of irradiance
    EXPECT_GT(grid.pitch, test_wavelength * 0.08 / (2 * diameter) / 2);
    EXPECT_EQ(grid.nx % 2, 1);
    EXPECT_EQ(grid.ny % 2, 1);
    EXPECT_LE(std::abs(grid.width() - slm.grid.width()), grid.pitch);
  }
}

}  // namespace
}  // namespace holotrace
