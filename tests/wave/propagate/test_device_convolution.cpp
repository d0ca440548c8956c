// Convolutions that share transforms, and their adjoints, on every OpenCL device, against the processor's.

#include <gtest/gtest.h>

#include <vector>

#include "holotrace/wave/propagate/convolve.h"
#include "holotrace/wave/propagate/device_convolution.h"
#include "support/devices.h"
#include "support/fields.h"
#include "support/targets.h"
#include "wave/propagate/displaced_windows.h"

namespace holotrace {
namespace {

using test::relative_error;
using Link = ConvolutionLink<float>;

// Two propagations in single precision, each within 1e-6 of the exact one.
constexpr double convolution_rounding = 2e-6;

const Grid input{66, 49, test_pitch};
// As large as the input; larger, on the axis; of odd sizes beside the axis.
const Grid outputs[] = {{66, 49, test_pitch}, {80, 50, test_pitch}, {51, 70, test_pitch, 3.3e-5, -6.1e-5}};
constexpr double distances[] = {0, 0.002, -0.1};  // bands of several widths, and a kernel

class DeviceConvolutions : public test::OnEveryDevice {
 protected:
  DeviceBuffer upload(const Field& field) { return device_.upload(samples_of(field), "a test"); }
  DeviceBuffer space(const Grid& grid) {
    return device_.upload(std::vector<std::complex<float>>(size_t(grid.pixels()), {7, 7}), "a test");
  }
  Field fetch(const DeviceBuffer& from, const Grid& grid) {
    Field field(grid, test_wavelength);
    device_.read(from, field.samples.values.data(), from.bytes());
    return field;
  }
  static std::vector<std::complex<float>> samples_of(const Field& field) {
    return {field.samples.values.begin(), field.samples.values.end()};
  }
};

HOLOTRACE_FOR_ALL_DEVICES(DeviceConvolutions);

TEST_P(DeviceConvolutions, DisplaceWindowsAsTheProcessorDoes) {
  const auto lock = device_.lock();
  for (const Grid& output : outputs)
    for (const double z : distances) {
      const Field field = random_field(input, 1);
      const auto host = make_propagator<float>(input, test_wavelength, z, window(output));
      DeviceConvolution convolution(device_, host, shifts);
      std::vector<Link> links;
      std::vector<DeviceBuffer> there;
      for (const Vec2& shift : shifts)
        links.push_back({&host, false, shift.x, shift.y}), there.push_back(space(output));
      std::vector<DisplacedSamples> to;
      for (size_t i = 0; i < shifts.size(); ++i) to.push_back({i, &there[i]});
      convolution.to_many(upload(field), to, convolution.make_work());
      const std::vector<Field> expected = convolve_to_many(field, links);
      for (size_t i = 0; i < shifts.size(); ++i)
        EXPECT_LT(relative_error(fetch(there[i], output), expected[i]), convolution_rounding)
            << z << " " << i << " " << output.nx;
    }
}

// Σ⟨gᵢ, Tᵢu⟩ = ⟨ΣTᵢᴴgᵢ, u⟩ with the processor's Tᵢ, for all windows; and for equal windows the processor's own sum.
TEST_P(DeviceConvolutions, SumAdjointsAsTheProcessorDoes) {
  const auto lock = device_.lock();
  for (const Grid& output : outputs)
    for (const double z : distances) {
      const auto host = make_propagator<float>(input, test_wavelength, z, window(output));
      DeviceConvolution convolution(device_, host, shifts);
      const Field u = random_field(input, 9);
      std::vector<Field> g;
      std::vector<DeviceBuffer> there;
      std::vector<const Field*> pointers;
      std::vector<DisplacedSamples> from;
      std::vector<Link> forward, adjoint;
      for (size_t i = 0; i < shifts.size(); ++i) {
        g.push_back(random_field(output, 2 + i));
        there.push_back(upload(g.back()));
        forward.push_back({&host, false, shifts[i].x, shifts[i].y});
        adjoint.push_back({&host, true, -shifts[i].x, -shifts[i].y});
      }
      for (size_t i = 0; i < shifts.size(); ++i) from.push_back({i, &there[i]}), pointers.push_back(&g[i]);
      const DeviceBuffer to = space(input);
      convolution.to_sum(from, to, convolution.make_work());
      const Field found = fetch(to, input);
      const std::vector<Field> shown = convolve_to_many(u, forward);
      std::complex<double> expected = 0;
      double of_g = 0, of_light = 0;
      for (size_t i = 0; i < shifts.size(); ++i) {
        expected += inner(g[i], shown[i]);
        of_g += inner(g[i], g[i]).real();
        of_light += inner(shown[i], shown[i]).real();
      }
      // Random fields are nearly orthogonal, |Σ⟨g, Tu⟩| is about 1/√samples of the norms' product: 1e-2; a float's
      // rounding of the fields is 1e-6 of the norms.
      EXPECT_LT(std::abs(inner(found, u) - expected), convolution_rounding * std::sqrt(of_g * of_light))
          << z << " " << output.nx;
      if (output != input) continue;
      EXPECT_LT(relative_error(found, convolve_to_sum(pointers, adjoint)), convolution_rounding) << z;
    }
}

TEST_P(DeviceConvolutions, NeedWindowsOfOnePitch) {
  const auto host = make_propagator<float>(input, test_wavelength, 0.1, {.columns = 40, .rows = 40, .pitch = 5e-6});
  EXPECT_EQ(error_of([&] { DeviceConvolution(device_, host); }),
            "expected a propagation between windows of one pitch, got two pitches");
}

}  // namespace
}  // namespace holotrace
