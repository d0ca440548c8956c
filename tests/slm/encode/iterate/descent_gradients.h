#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "holotrace/slm/encode/iterate/device_arrays.h"
#include "holotrace/slm/encode/iterate/processor_arrays.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "slm/encode/iterate/descents_on_devices.h"

// Descents of all kinds, and their first gradient, wherever it is computed.

namespace holotrace::test {

inline std::vector<DescentCase> descent_cases() {
  DescentCase one{"one frame"}, three{"three frames", 3}, diagonals{"four frames", 4},
      stop{"a stop and a part that counts"}, alone{"views alone", 2}, two{"two levels", 2, 2},
      few{"three levels", 1, 3}, colours{"two colours"}, odd{"an odd size"};
  odd.slm = make_panel(51, 38);
  stop.params.stop = 0.6;
  stop.params.target_columns = 30;
  stop.params.target_rows = 20;
  alone.has_views = alone.has_no_planes = true;
  colours.has_two_colours = true;
  colours.slm.design_wavelength = 633e-9;
  DescentCase crosstalk{"crosstalk", 2}, crosstalk_two{"crosstalk of two levels", 1, 2},
      amplitude{"amplitudes", 1, 256}, complex{"phases and amplitudes", 2, 256}, fine{"three samples per pixel", 4},
      views{"views", 2}, wide{"views of pictures wider than the period of their transform"};
  views.has_views = wide.has_views = true;
  wide.view_z = 0.017;
  for (DescentCase* blurred : {&crosstalk, &crosstalk_two}) {
    blurred->slm.fill_factor = 0.9;
    blurred->slm.effects.crosstalk = 0.3;
    blurred->slm.effects.gap_amplitude = 0.2;
  }
  amplitude.slm.modulation = Modulation::amplitude;
  complex.slm.modulation = Modulation::complex;
  fine.params.subpixels = 3;
  return {one, three,     diagonals,     stop,      alone,   two,  few,   colours,
          odd, crosstalk, crosstalk_two, amplitude, complex, fine, views, wide};
}

/// ‖found − expected‖/‖expected‖
inline double relative(const Array2D<float>& found, const Array2D<float>& expected) {
  double error = 0, square = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    error += std::pow(double(found.values[i]) - double(expected.values[i]), 2);
    square += std::pow(double(expected.values[i]), 2);
  }
  return std::sqrt(error / square);
}

/// Sums and errors of all planes of a colour, and the slopes that they give.
struct Gradient {
  std::vector<double> numbers;
  std::vector<Array2D<float>> slopes;
};

inline Gradient gradient_of(const DescentCase& one, FrameArrays& arrays, const PanelDetail& detail) {
  const TargetSet set = one.targets();
  const std::vector<Hologram> start = one.start();
  const DrivenPanel panel(one.slm, start.front(), test_wavelength, one.params.subpixels);
  Gradient gradient;
  {
    const auto light = arrays.light_of(panel, test_wavelength);
    size_t planes = 0;
    for (const TargetPlane& target : set.planes)
      if (target.wavelength == test_wavelength) light->add(target), ++planes;
    const SampleGroup group = samples_of_update(one.params.subpixels, 1, detail.light == PixelDetail::coarse);
    arrays.clear_slopes();
    light->leave(detail);
    for (size_t k = 0; k < planes; ++k)
      for (const bool is_judged : {true, false}) {
        const ModulusSums sums = light->plane_sums(k, is_judged ? SampleGroup::all : group, !is_judged);
        gradient.numbers.insert(gradient.numbers.end(), {sums.cross, sums.square});
      }
    for (size_t k = 0; k < planes; ++k) gradient.numbers.push_back(light->add_gradient(k, group, 1.3, 0.7));
    for (const int update : {1, 2}) {
      if (!one.has_views) break;
      const ViewTargets views = set.draw_views(update, test_wavelength);
      const ModulusSums sums = light->view_sums(views, true);
      const double factor = 1e4 / target_power(views);  // so that they count more than the planes
      gradient.numbers.insert(gradient.numbers.end(),
                              {sums.cross, sums.square, light->add_gradient_of_views(views, 1.3, factor)});
    }
  }
  const AdamStep mean_is_slope{0, 0, 0, 1};
  arrays.step({mean_is_slope, mean_is_slope, 0, float(one.levels), 1});
  const std::vector<Array2D<float>> state = arrays.state();
  const size_t of_frame = state.size() / start.size();  // rounded, drive, mean, square
  for (size_t i = 0; i < state.size(); ++i)
    if (i % of_frame / (of_frame / 4) == 2) gradient.slopes.push_back(state[i]);
  return gradient;
}

/// Gradients whose frames were added up in another order: sums of positive terms agree to 2e-6, and slopes, which are differences
/// of light, to 1e-5, as for one device.
inline void expect_near(const Gradient& found, const Gradient& expected, const std::string& name) {
  ASSERT_EQ(found.numbers.size(), expected.numbers.size()) << name;
  for (size_t i = 0; i < found.numbers.size(); ++i)
    EXPECT_NEAR(found.numbers[i], expected.numbers[i], 2e-6 * std::abs(expected.numbers[i])) << name << i;
  ASSERT_EQ(found.slopes.size(), expected.slopes.size()) << name;
  for (size_t m = 0; m < found.slopes.size(); ++m)
    EXPECT_LT(relative(found.slopes[m], expected.slopes[m]), 1e-5) << name;
}

}  // namespace holotrace::test
