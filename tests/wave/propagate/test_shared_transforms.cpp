#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/convolve.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/propagate/propagator.h"
#include "support/fields.h"
#include "support/panels.h"
#include "support/targets.h"
#include "wave/propagate/displaced_windows.h"

namespace holotrace {
namespace {

using test::relative_error;
using Link = ConvolutionLink<float>;

// A field that is limited in space and in its band; 1/8p leaves nothing at the edge of the band.
Field smooth_field(const Grid& grid) {
  const FieldDouble noise = test::make_band_limited_noise(grid, test_wavelength, 1 / (12 * grid.pitch));
  Field field(grid, test_wavelength);
  for (size_t i = 0; i < field.samples.size(); ++i)
    field.samples.values[i] = std::complex<float>(noise.samples.values[i]);
  return field;
}

std::vector<Link> displaced_links(const Propagator<float>& propagator, bool is_adjoint = false) {
  std::vector<Link> links;
  for (const Vec2& shift : shifts) links.push_back({&propagator, is_adjoint, shift.x, shift.y});
  return links;
}

TEST(SharedTransforms, ADisplacedWindowHasTheLightBetweenTheSamples) {
  for (const Grid& output : {Grid{64, 48, test_pitch}, {51, 70, test_pitch, 3.3e-5, -6.1e-5}})
    for (const double z : {0.0, 0.002, -0.002, 0.1, -0.1}) {
      const Field field = smooth_field({64, 48, test_pitch});
      const auto propagator = make_propagator<float>(field.grid, test_wavelength, z, window(output));
      const std::vector<Field> found = convolve_to_many(field, displaced_links(propagator));
      for (size_t i = 0; i < shifts.size(); ++i) {
        Grid there = output;
        there.centre_x += shifts[i].x * test_pitch;
        there.centre_y -= shifts[i].y * test_pitch;
        const Field expected = propagate(field, z, window(there));
        EXPECT_NEAR(found[i].grid.centre_x, there.centre_x, 1e-15);
        EXPECT_NEAR(found[i].grid.centre_y, there.centre_y, 1e-15);
        EXPECT_EQ(found[i].z, z);
        EXPECT_LT(relative_error(found[i], expected), 1e-6) << z << " " << i;  // float
      }
    }
}

TEST(SharedTransforms, SeveralDistancesFromOneField) {
  // Rayleigh–Sommerfeld kernels have the whole band, so they can share.
  const Field field = smooth_field({64, 48, test_pitch});
  std::vector<Propagator<float>> propagators;
  for (const double z : {0.05, 0.08, -0.1})
    propagators.push_back(make_propagator<float>(field.grid, test_wavelength, z));
  std::vector<Link> links;
  for (const auto& p : propagators) links.push_back({&p});
  const std::vector<Field> found = convolve_to_many(field, links);
  for (size_t i = 0; i < links.size(); ++i) {
    EXPECT_EQ(found[i].z, propagators[i].distance);
    EXPECT_LT(relative_error(found[i], propagate(field, propagators[i])), 1e-6);  // float
  }
}

TEST(SharedTransforms, ASumIsThatOfItsParts) {
  // Each field is displaced by its own shift on the way. Windows of odd and even sizes, at one place or beside the axis.
  for (const Grid& output : {Grid{64, 48, test_pitch}, {51, 70, test_pitch, 3.3e-5, -6.1e-5}})
    for (const double z : {0.002, -0.1}) {
      const Grid input{64, 48, test_pitch};
      const auto propagator = make_propagator<float>(input, test_wavelength, z, window(output));
      const std::vector<Link> links = displaced_links(propagator);
      std::vector<Field> fields;
      std::vector<const Field*> pointers;
      for (size_t i = 0; i < links.size(); ++i) fields.push_back(random_field(input, 1 + i));
      for (const Field& field : fields) pointers.push_back(&field);
      const Field found = convolve_to_sum(pointers, links);
      Field expected(output, test_wavelength);
      for (size_t i = 0; i < links.size(); ++i) {
        const Field part = convolve_to_many(fields[i], {links[i]}).front();
        for (size_t n = 0; n < part.samples.size(); ++n) expected.samples.values[n] += part.samples.values[n];
      }
      EXPECT_LT(relative_error(found, expected), 1e-6) << z;  // float
    }
}

TEST(SharedTransforms, AnAdjointLinkNeedsNoTableOfItsOwn) {
  const Field field = random_field({64, 45, test_pitch}, 1);
  for (const double z : {0.002, -0.1}) {
    const auto there = make_propagator<float>(field.grid, test_wavelength, z);
    const Field back = convolve_to_many(field, {Link{&there, true}}).front();
    EXPECT_EQ(back.z, -z);
    EXPECT_LT(relative_error(back, propagate(field, adjoint_of(there))), 1e-6) << z;  // float
  }
}

TEST(SharedTransforms, TheSumOfAdjointsIsTheAdjoint) {
  // ⟨gᵢ, Tᵢu⟩ summed = ⟨ΣTᵢᴴgᵢ, u⟩, for noise that fills the band; float sums of some thousand products.
  for (const double z : {0.002, -0.002, 0.1}) {
    const Field u = random_field({64, 45, test_pitch}, 1);
    const auto there = make_propagator<float>(u.grid, test_wavelength, z);
    const std::vector<Field> shown = convolve_to_many(u, displaced_links(there));
    std::vector<Field> g;
    std::vector<const Field*> pointers;
    std::vector<Link> links = displaced_links(there, true);
    std::complex<double> sum = 0;
    double of_g = 0, of_light = 0;
    for (size_t i = 0; i < shown.size(); ++i) {  // g: the light and noise, so that the products are large
      const double light = inner(shown[i], shown[i]).real();
      g.push_back(random_field(u.grid, 2 + i));
      const float part = float(std::sqrt(light / inner(g[i], g[i]).real()));
      for (size_t n = 0; n < u.samples.size(); ++n)
        g[i].samples.values[n] = part * g[i].samples.values[n] + shown[i].samples.values[n];
      of_light += light;
      links[i].shift_x *= -1;
      links[i].shift_y *= -1;
      sum += inner(g[i], shown[i]);
      of_g += inner(g[i], g[i]).real();
    }
    for (const Field& field : g) pointers.push_back(&field);
    const std::complex<double> back = inner(convolve_to_sum(pointers, links), u);
    EXPECT_LT(std::abs(sum - back), 1e-5 * std::sqrt(of_g * of_light)) << z;
    EXPECT_GT(std::abs(sum), 0.5 * std::sqrt(of_g * of_light)) << z;  // 1/√2 ± the noise's part along the light
  }
}

TEST(SharedTransforms, OnlyLikeCanShare) {
  const Grid grid{64, 48, test_pitch};
  const Field field = random_field(grid, 1);
  const auto p = make_propagator<float>(grid, test_wavelength, 0.002);
  const auto error = [&](const Propagator<float>& other, bool is_adjoint = false) {
    return error_of([&] { convolve_to_many(field, {Link{&p}, Link{&other, is_adjoint}}); });
  };
  const std::string same = "expected propagations with the same windows and the same band";
  EXPECT_EQ(error(make_propagator<float>(grid, test_wavelength, 0.002, window({64, 50, test_pitch}))), same);
  EXPECT_EQ(error(make_propagator<float>(grid, test_wavelength, 0.002, window({64, 48, test_pitch, 1e-5}))), same);
  PropagateParams farther;  // with a narrower band limit
  farther.method = PropagationMethod::angular_spectrum;
  EXPECT_EQ(error(make_propagator<float>(grid, test_wavelength, 0.05, farther)), same);
  EXPECT_EQ(error(make_propagator<float>(grid, test_wavelength, 0.002, window({64, 48, 2 * test_pitch}))),
            "expected propagations between windows of one pitch, got two pitches");
  const auto wider = make_propagator<float>(grid, test_wavelength, 0.002, window({70, 48, test_pitch}));
  EXPECT_EQ(error_of([&] {
              convolve_to_many(field, {Link{&wider, true}});
            }),
            "expected equal windows for an adjoint propagation");
  EXPECT_EQ(error_of([&] {
              convolve_to_sum<float>({&field, &field}, {Link{&p}});
            }),
            "expected a propagation for each of 2 fields, got 1");
}

}  // namespace
}  // namespace holotrace
