// The panel with its effects on every OpenCL device, against the processor's.

#include <gtest/gtest.h>

#include "holotrace/slm/panel/device_panel.h"
#include "holotrace/slm/panel/panel_field_by_device.h"
#include "support/devices.h"
#include "support/fields.h"
#include "support/panels.h"

namespace holotrace {
namespace {

struct PanelCase {
  std::string name;
  Slm slm = make_panel(48, 37, 256, 0.9);
  int subpixels = 1;
  Modulation modulation = Modulation::phase;
  ShowParams light{};
  double tilt = 0;

  ShowParams params() const {
    ShowParams shown = light;
    shown.subpixels = subpixels;
    return shown;
  }
  IlluminationState state() const { return {.wavelength = test_wavelength, .tilt_x = tilt, .tilt_y = -tilt / 2}; }
};

std::vector<PanelCase> cases() {
  std::vector<PanelCase> all;
  for (const int subpixels : {1, 2, 3}) {
    PanelCase plain{"plain"}, crosstalk{"crosstalk"}, gaps{"gaps"}, errors{"static errors"}, dead{"dead pixels"},
        calibrated{"calibration"}, amplitude{"amplitudes"}, complex{"complex"}, all_effects{"all"},
        tilted{"tilted light"}, beam{"a beam"}, diverging{"spherical light"};
    crosstalk.slm.effects.crosstalk = 0.35;
    gaps.slm.effects.gap_amplitude = 0.3;
    gaps.slm.effects.gap_phase = 0.7;
    errors.slm.effects.aberration = {{2, 0, 0.8}, {3, 1, -0.4}};
    errors.slm.effects.gap_amplitude = 0.2;  // its light passes the errors, too
    dead.slm.effects.dead_fraction = 0.05;
    dead.slm.levels = 200;
    for (int level = 0; level < 256; ++level)
      calibrated.slm.effects.calibration.push_back({0.02 * level + 4e-5 * level * level, 1 - level / 1000.0});
    amplitude.modulation = complex.modulation = Modulation::complex;
    amplitude.modulation = amplitude.slm.modulation = Modulation::amplitude;
    complex.slm.modulation = Modulation::complex;
    all_effects.slm.effects = calibrated.slm.effects;
    all_effects.slm.effects.crosstalk = 0.25;
    all_effects.slm.effects.gap_amplitude = 0.1;
    all_effects.slm.effects.aberration = errors.slm.effects.aberration;
    all_effects.slm.effects.dead_fraction = 0.03;
    all_effects.slm.modulation = all_effects.modulation = Modulation::complex;
    for (PanelCase* lit : {&tilted, &beam, &diverging, &all_effects}) {
      lit->slm.effects.gap_amplitude = 0.2;
      lit->light.irradiance = 3;
      lit->tilt = 0.01;
    }
    beam.light.light = all_effects.light.light = Wavefront::gaussian;
    beam.light.beam_radius = all_effects.light.beam_radius = 1.5e-4;
    diverging.light.light = Wavefront::spherical;
    diverging.light.source_distance = 0.02;
    for (PanelCase one :
         {plain, crosstalk, gaps, errors, dead, calibrated, amplitude, complex, all_effects, tilted, beam, diverging}) {
      one.subpixels = subpixels;
      all.push_back(one);
    }
  }
  return all;
}

Array2D<float> drawn(const Slm& slm, int levels, uint64_t seed) {
  CounterRandom random(seed, 0, 0);
  Array2D<float> values(slm.grid.ny, slm.grid.nx);
  for (float& value : values.values) value = float((levels - 1) * random.uniform());
  return values;
}

double relative(const Array2D<float>& found, const Array2D<float>& expected) {
  double error = 0, square = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    error += std::pow(double(found.values[i]) - double(expected.values[i]), 2);
    square += std::pow(double(expected.values[i]), 2);
  }
  return std::sqrt(error / square);
}

class DevicePanels : public test::OnEveryDevice {
 protected:
  DeviceBuffer upload(const void* values, size_t bytes) {
    DeviceBuffer buffer = device_.make_buffer(bytes, "a test");
    device_.write(buffer, values, bytes);
    return buffer;
  }
  DeviceBuffer upload(const Array2D<float>& values) {
    return upload(values.values.data(), values.size() * sizeof(float));
  }
  Array2D<float> fetch(const DeviceBuffer& buffer, const Grid& grid) {
    Array2D<float> values(grid.ny, grid.nx);
    device_.read(buffer, values.values.data(), values.size() * sizeof(float));
    return values;
  }
};

HOLOTRACE_FOR_ALL_DEVICES(DevicePanels);

// With crosstalk, details of the light over a pixel differ.
std::vector<std::pair<PanelCase, PixelDetail>> with_all_details(const std::vector<PanelCase>& cases) {
  std::vector<std::pair<PanelCase, PixelDetail>> all;
  for (const PanelCase& one : cases)
    for (const PixelDetail detail : {PixelDetail::as_shown, PixelDetail::coarse, PixelDetail::mean})
      if (detail == PixelDetail::as_shown || one.slm.effects.crosstalk > 0) all.emplace_back(one, detail);
  return all;
}

// Phases of a few cycles in float are known to 1e-6 rad, and each of two transforms adds about 3e-7; slopes of the panel are
// differences of light.
TEST_P(DevicePanels, LeaveTheLightAndPullBackTheSlopesOfTheProcessor) {
  const auto lock = device_.lock();
  DevicePanel::Memory memory;
  for (const auto& [one, detail] : with_all_details(cases())) {
    const int levels = 100;
    const PanelModel host(one.slm, one.params(), one.modulation, levels, 633e-9, one.state(),
                          pixel_expansion(one.slm, one.params(), detail));
    DevicePanel panel(device_, host);
    const bool is_complex = one.modulation == Modulation::complex;
    const Array2D<float> drive = drawn(one.slm, levels, 1), modulus = drawn(one.slm, levels, 2);
    const Field expected = host.leave(drive, is_complex ? &modulus : nullptr);
    const DeviceBuffer level = upload(drive), moduli = upload(modulus);
    const DevicePattern pattern{level, is_complex ? &moduli : nullptr};
    Field found = expected;
    const size_t bytes = found.samples.size() * sizeof(std::complex<float>);
    const DeviceBuffer u = device_.make_buffer(bytes, "a test");
    panel.leave(pattern, u, memory);
    device_.read(u, found.samples.values.data(), bytes);
    EXPECT_LT(test::relative_error(found, expected), 2e-6) << one.name << one.subpixels;

    CounterRandom random(3, 0, 0);
    for (auto& g : found.samples.values) g = {float(random.uniform()) - 0.5F, float(random.uniform()) - 0.5F};
    const PatternSlopes slopes = slopes_of(host, drive, found.samples, is_complex ? &modulus : nullptr);
    Array2D<float> before(one.slm.grid.ny, one.slm.grid.nx);
    const DeviceBuffer g = upload(found.samples.values.data(), bytes), slope = upload(before),
                       of_modulus = upload(before);
    panel.add_slopes(pattern, g, {slope, is_complex ? &of_modulus : nullptr, 1}, memory);
    EXPECT_LT(relative(fetch(slope, one.slm.grid), slopes.drive), 5e-6) << one.name << one.subpixels;
    if (is_complex) {
      EXPECT_LT(relative(fetch(of_modulus, one.slm.grid), slopes.modulus), 5e-6) << one.name << one.subpixels;
    }
    panel.add_slopes(pattern, g, {slope, is_complex ? &of_modulus : nullptr, -1}, memory);
    for (const float rest : fetch(slope, one.slm.grid).values) ASSERT_EQ(rest, 0) << "adds the opposite";
  }
}

// However the panel is cut, the samples are the same. The device makes no buffer beyond its memory, so this also checks that a
// plan counts all of them.
TEST_P(DevicePanels, LeaveTheSameLightInBands) {
  const auto lock = device_.lock();
  DevicePanel::Memory memory;
  for (const PanelCase& one : cases()) {
    if (one.subpixels == 2 || one.name == "gaps" || one.name == "calibration" || one.name == "a beam") continue;
    const PanelModel host(one.slm, one.params(), one.modulation, 100, 633e-9, one.state());
    const bool is_complex = one.modulation == Modulation::complex;
    const Array2D<float> drive = drawn(one.slm, 100, 1), modulus = drawn(one.slm, 100, 2);
    Field expected = host.head(), found = host.head();
    expected.samples = found.samples = Array2D<std::complex<float>>(expected.grid.ny, expected.grid.nx);
    {
      DevicePanel panel(device_, host);
      const DeviceBuffer level = upload(drive), moduli = upload(modulus);
      const DeviceBuffer u = device_.make_buffer(expected.samples.size() * sizeof(std::complex<float>), "a test");
      panel.leave({level, is_complex ? &moduli : nullptr}, u, memory);
      device_.read(u, expected.samples.values.data(), u.bytes());
    }
    std::vector<int> cuts{1, 2, 5};
    if (one.name == "all" && one.subpixels == 1) cuts.push_back(std::max(expected.grid.nx, expected.grid.ny));
    for (const int parts : cuts) {
      int columns_done = 0, bands = 0;
      each_band_of_light(device_, host, {drive, is_complex ? &modulus : nullptr}, parts,
                         [&](const SampleColumns& columns, const DeviceBuffer& u) {
                           const auto part = device_.fetch<std::complex<float>>(u);
                           for (int j = 0; j < found.grid.ny; ++j)
                             std::copy_n(part.data() + j * columns.count, columns.count,
                                         found.samples.row(j) + columns.first);
                           columns_done += columns.count;
                           ++bands;
                           return true;
                         });
      EXPECT_EQ(columns_done, found.grid.nx);
      EXPECT_EQ(bands, std::min(parts, expected.grid.nx));
      EXPECT_EQ(found.samples.values, expected.samples.values) << one.name << one.subpixels << " " << parts;
    }
  }
}

// Of two levels, slopes are those halfway between them in all pixels but dead ones.
TEST_P(DevicePanels, TakeTheSlopesHalfwayBetweenTwoLevels) {
  const auto lock = device_.lock();
  Slm slm = make_panel(48, 37, 2, 0.9);
  slm.effects.dead_fraction = 0.05;
  slm.effects.crosstalk = 0.35;
  IlluminationState state;
  state.wavelength = test_wavelength;
  const PanelModel host(slm, {}, Modulation::phase, 2, test_wavelength, state);
  DevicePanel panel(device_, host);
  Field g = host.leave(drawn(slm, 3, 1));
  Array2D<float> halfway(slm.grid.ny, slm.grid.nx, 0.5F);
  const Array2D<float> expected = slopes_of(host, halfway, g.samples).drive, zeros(slm.grid.ny, slm.grid.nx);
  DevicePanel::Memory memory;
  const DeviceBuffer level = upload(drawn(slm, 2, 4)), slope = upload(zeros),
                     of_light = upload(g.samples.values.data(), g.samples.size() * sizeof g.samples.values[0]);
  panel.add_slopes({level, nullptr, true}, of_light, {slope}, memory);
  EXPECT_LT(relative(fetch(slope, slm.grid), expected), 5e-6);
}

TEST_P(DevicePanels, WriteNothingPastTheirBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  {
    const auto lock = device_.lock();
    const Array2D<float> drawn_moduli = drawn(cases().front().slm, 100, 2);
    for (const PanelCase& one : cases()) {
      if (one.name != "all") continue;
      const PanelModel host(one.slm, one.params(), one.modulation, 100, 0, one.state());
      DevicePanel panel(device_, host);
      const DeviceBuffer level = upload(drawn(one.slm, 100, 1)), moduli = upload(drawn(one.slm, 100, 2)),
                         slope = upload(drawn(one.slm, 100, 3)), of_modulus = upload(drawn(one.slm, 100, 4));
      const DeviceBuffer u = device_.make_buffer(
          size_t(one.slm.grid.pixels() * one.subpixels * one.subpixels) * sizeof(std::complex<float>), "a test");
      DevicePanel::Memory memory;
      panel.leave({level, &moduli}, u, memory);
      panel.add_slopes({level, &moduli}, u, {slope, &of_modulus}, memory);
      const Array2D<float> drive = drawn(one.slm, 100, 1);
      each_band_of_light(device_, host, {drive, &drawn_moduli}, 3,
                         [](const SampleColumns&, const DeviceBuffer&) { return true; });
    }
  }
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

}  // namespace
}  // namespace holotrace
