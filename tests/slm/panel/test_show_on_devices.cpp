// Panels shown by OpenCL devices: the field and the facts of the processor, and what happens if the device fails.

#include <gtest/gtest.h>

#include "holotrace/slm/panel/panel_field_by_device.h"
#include "holotrace/slm/panel/show.h"
#include "support/build_paths.h"
#include "support/fields.h"
#include "support/panels.h"
#include "support/stages_on_devices.h"
#if HOLOTRACE_HAS_OPENCL
#include "support/faulty_api.h"
#endif

namespace holotrace {
namespace {

// A hologram of random levels, and the light that it is shown in.
struct ShownCase {
  std::string name;
  Slm slm = make_panel(48, 37, 200, 0.9);
  ShowParams params{};
  IlluminationState state{.wavelength = test_wavelength};
  std::optional<SpectralFilter> filter{};

  Hologram hologram() const {
    CounterRandom random(1, 0, 0);
    Hologram hologram = make_hologram(slm, slm.modulation, [](int) { return 0; });
    for (uint16_t& level : hologram.level.values) level = uint16_t(slm.levels * random.uniform());
    if (slm.modulation == Modulation::complex) {
      hologram.modulus_level = hologram.level;
      for (uint16_t& level : hologram.modulus_level.values) level = uint16_t(slm.levels * random.uniform());
    }
    hologram.image = ImageSide::real_image;
    hologram.filter = filter;
    return hologram;
  }
};

std::vector<ShownCase> shown_cases() {
  ShownCase plain{"plain"}, amplitude{"amplitudes"}, complex{"complex"}, errors{"all effects in tilted light"},
      fine{"three samples per pixel"}, state{"another state of light that flickers"},
      crystal{"the second polarisation of a twisted crystal"};
  amplitude.slm.modulation = Modulation::amplitude;
  complex.slm.modulation = Modulation::complex;
  for (ShownCase* one : {&errors, &fine, &state}) {
    SlmEffects& effects = one->slm.effects;
    effects.crosstalk = 0.3;
    effects.gap_amplitude = 0.2;
    effects.aberration = {{2, 0, 0.8}};
    effects.dead_fraction = 0.05;
    effects.flicker = 0.4;
    one->params.effects = {"all"};
    one->params.irradiance = 2;
  }
  errors.params.tilt_x = errors.state.tilt_x = 0.01;
  errors.filter = SpectralFilter{1e3, 0, 2e4, 2e4};
  fine.params.subpixels = 3;
  fine.params.light = Wavefront::gaussian;
  fine.params.beam_radius = 2e-4;
  state.state.wavelength = 540e-9;
  state.state.flicker = 0.7;
  crystal.slm.effects.crystal = Crystal{.twist = 1, .polariser = 0.3};
  crystal.slm.effects.gap_amplitude = 0.2;
  crystal.params.effects = {"all"};
  crystal.state.polarisation = 1;
  return {plain, amplitude, complex, errors, fine, state, crystal};
}

class ShowDevices : public test::StagesOnDevices {
 protected:
  static Field shown(const ShownCase& one, const ShowParams& params, const Observer& observer = {}) {
    return show(one.hologram(), one.slm, params, one.state, observer);
  }
  bool uses_device(const ShowParams& params) const {
    const size_t before = device_.use().kernels;
    shown(one_, params);
    return device_.use().kernels > before;
  }

  ShownCase one_{"one"};
};

HOLOTRACE_FOR_ALL_DEVICES(ShowDevices);

// Phases of a few cycles in float are known to 1e-6 rad, and each of two transforms adds about 3e-7.
TEST_P(ShowDevices, ShowTheFieldOfTheProcessor) {
  for (const ShownCase& one : shown_cases()) {
    Heard expected, heard;
    const Field here = shown(one, one.params, expected.observer());
    const Field there = shown(one, on_device(one.params), heard.observer());
    EXPECT_LT(test::relative_error(there, here), 2e-6) << one.name;
    EXPECT_NE(there.samples.values, here.samples.values) << one.name << ": by the processor?";
    EXPECT_EQ(there.grid.nx, here.grid.nx);
    EXPECT_EQ(there.grid.pitch, here.grid.pitch);
    EXPECT_EQ(there.wavelength, here.wavelength);
    EXPECT_EQ(there.image, here.image);
    ASSERT_EQ(there.filter.has_value(), here.filter.has_value());
    if (here.filter) {
      EXPECT_EQ(there.filter->u0, here.filter->u0);
    }
    EXPECT_EQ(std::get<std::string>(heard.facts.at("device")), device_.info().name);
    heard.facts.erase("device");
    ASSERT_EQ(heard.facts.size(), expected.facts.size()) << one.name;
    for (const char* fact : {"power_in", "power_out", "efficiency"})
      EXPECT_NEAR(heard.number(fact), expected.number(fact), 4e-6 * expected.number(fact)) << one.name << fact;
  }
}

// Four bytes for the level of each pixel and for the projection of the light over a pixel, and eight for each sample that
// comes back.
TEST_P(ShowDevices, TransferLevelsAndTheFieldOnly) {
  one_.params.subpixels = 2;
  const DeviceUse before = device_.use();
  shown(one_, on_device(one_.params));
  const DeviceUse after = device_.use();
  const size_t pixels = size_t(one_.slm.grid.pixels()), lines = size_t(one_.slm.grid.nx + one_.slm.grid.ny);
  EXPECT_EQ(after.bytes_out - before.bytes_out, 4 * pixels * 8);
  EXPECT_GE(after.bytes_in - before.bytes_in, pixels * 4);
  EXPECT_LE(after.bytes_in - before.bytes_in, pixels * 4 + 4 + 2 * lines * 2 * 8)
      << "weights and factors of transforms";
}

// What does not fit at once is done in bands; the bytes are the same. The limits are those where a byte less makes a band more.
TEST_P(ShowDevices, ShowInBandsWhatDoesNotFit) {
  for (ShownCase one : shown_cases()) {
    one.slm.grid.ny = 40;  // lines that need no work space
    const PanelModel panel(with_effects(one.slm, one.params.effects), one.params, one.slm.modulation, one.slm.levels,
                           test_wavelength, one.state);
    const Array2D<float> drive(one.slm.grid.ny, one.slm.grid.nx);
    const PanelModel::Pattern pattern{drive, one.slm.modulation == Modulation::complex ? &drive : nullptr};
    // Of the memory, nine tenths are taken.
    const double enough = std::ceil(double(forecast_panel(device_, panel, pattern, false, 1e9).use.most_held) / 0.9);
    EXPECT_EQ(forecast_panel(device_, panel, pattern, false, enough).parts, 1);
    EXPECT_EQ(forecast_panel(device_, panel, pattern, false, enough - 1).parts, 2);
    const Field expected = shown(one, on_device(one.params));
    const auto sent_with = [&](double bytes) {
      device_.limit_memory((double(device_.use().bytes_held) + bytes) / 0.8);
      const size_t before = device_.use().bytes_in;
      EXPECT_EQ(shown(one, on_device(one.params)).samples.values, expected.samples.values) << one.name << bytes;
      return device_.use().bytes_in - before;
    };
    const size_t whole = sent_with(enough);
    const size_t pixels = size_t(one.slm.grid.pixels());
    EXPECT_EQ(sent_with(1e9), whole) << one.name;
    EXPECT_GE(sent_with(enough - 1), whole + pixels * 4) << one.name << ": levels are sent for every band of columns";
  }
}

// Whole, and in parts: with half of the memory that the whole takes, and with a fifth.
TEST_P(ShowDevices, DoWhatIsForecast) {
  for (const ShownCase& one : shown_cases()) {
    const PanelModel panel(with_effects(one.slm, one.params.effects), one.params, one.slm.modulation, one.slm.levels,
                           test_wavelength, one.state);
    const Array2D<float> drive(one.slm.grid.ny, one.slm.grid.nx);
    const PanelModel::Pattern pattern{drive, one.slm.modulation == Modulation::complex ? &drive : nullptr};
    const double whole = std::ceil(double(forecast_panel(device_, panel, pattern, true, 1e9).use.most_held) / 0.9);
    int most_parts = 0;
    for (const bool may_stay : {false, true})
      for (const double part : {1.0, 0.5, 0.2}) {
        SCOPED_TRACE(one.name + ", " + std::to_string(part));
        const PanelForecast expected = forecast_panel(device_, panel, pattern, may_stay, part * whole);
        ASSERT_TRUE(expected.fits);
        EXPECT_EQ(expected.parts == 1, part == 1);
        most_parts = std::max(most_parts, expected.parts);
        device_.limit_memory((double(device_.use().bytes_held) + part * whole) / 0.8);
        const DeviceUse before = device_.use();
        const DeviceChoice choice{DeviceKind::opencl, GetParam()};
        if (may_stay) {
          const PanelField field = *panel_field_on_device(panel, pattern, choice);
          EXPECT_EQ(std::holds_alternative<DeviceField>(field.field), expected.stays);
        } else {
          panel_field_by_device(panel, pattern, choice);
        }
        const DeviceUse after = device_.use();
        device_.limit_memory(0);
        EXPECT_EQ(after.kernels - before.kernels, expected.use.kernels);
        EXPECT_EQ(after.bytes_moved - before.bytes_moved, expected.use.bytes_moved);
        EXPECT_EQ(after.bytes_out - before.bytes_out, expected.use.bytes_out);
        EXPECT_EQ(after.bytes_in - before.bytes_in, expected.use.bytes_in);
        EXPECT_EQ(after.transfers - before.transfers, expected.use.transfers);
      }
    EXPECT_GE(most_parts, 5);
  }
}

// A panel without effects. In memory, for each pixel: its phase (4 bytes); its light, the same for the transform, and after the
// transforms along rows and columns and each transposition (6 × 8). Read and written: the level and the phase (4 + 4); the phase and the
// light (4 + 8); and five steps of 8 + 8. Beside this the projection of the light over a pixel (4), and weights and factors of transforms (8 + 8).
TEST_P(ShowDevices, CountMemoryAndWhatKernelsReadAndWrite) {
  one_.slm.grid = {48, 40, test_pitch};  // lines that a group of work items holds
  const PanelModel panel(one_.slm, {}, Modulation::phase, 200, 0, one_.state);
  const Array2D<float> drive(one_.slm.grid.ny, one_.slm.grid.nx);
  const DeviceUse use = forecast_panel(device_, panel, {drive}, false, 1e9).use;
  const size_t pixels = 48 * 40, lines = 48 + 40;
  EXPECT_EQ(use.bytes_moved, (8 + 12 + 5 * 16) * pixels + 2 * 8 * lines + 4);
  EXPECT_GE(use.most_held, (4 + 6 * 8) * pixels + 8 * lines + 4);
  EXPECT_LE(use.most_held, (4 + 6 * 8) * pixels + 2 * 8 * lines + 4) << "factors of transforms, at most as many";
  EXPECT_EQ(use.bytes_out, 8 * pixels);
}

// With crosstalk at 4 × 4 points, expanded in 3 terms along each axis (6 pairs). For each pixel: response 8 bytes; for each row of points
// the blur along columns 8, its result 4, and 6 terms of 8 that are written, or from the second row on read and written; for each pair its
// copy 16, and a transform 16, or 24 if it adds; for each term along y a transposition 16, and a transform, as before; a transposition
// 16. Taps of the blur and factors of transforms come to less than 12 bytes.
TEST_P(ShowDevices, CountWhatKernelsOfCrosstalkReadAndWrite) {
  one_.slm.grid = {48, 40, test_pitch};
  one_.slm.effects.crosstalk = 0.3;
  ShowParams params;
  params.fine_samples = 4;
  const PanelModel panel(one_.slm, params, Modulation::phase, 200, 0, one_.state);
  const Array2D<float> drive(one_.slm.grid.ny, one_.slm.grid.nx);
  const double of_pixel = 8 + 4 * 12 + 6 * 8 * 7 + 6 * 16 + (3 * 16 + 3 * 24) + 3 * 16 + (16 + 2 * 24) + 16;
  const double pixels = 48 * 40;
  EXPECT_NEAR(double(forecast_panel(device_, panel, {drive}, false, 1e9).use.bytes_moved), of_pixel * pixels,
              12 * pixels);
}

// A field that stays is copied together from bands, 8 + 8 bytes for each sample, and its power is the sum of sums of rows: 8 bytes for
// each sample, and 4 for each row, which come back in place of the field.
TEST_P(ShowDevices, CountTheFieldThatStays) {
  const PanelModel panel(one_.slm, {}, Modulation::phase, 200, 0, one_.state);
  const Array2D<float> drive(one_.slm.grid.ny, one_.slm.grid.nx);
  DeviceInfo info = device_.info();
  const size_t samples = size_t(one_.slm.grid.pixels()), rows = size_t(one_.slm.grid.ny);
  const auto forecast = [&](bool may_stay, double largest) {
    info.largest_buffer = largest;
    return forecast_panel(Device(info, 1e9), panel, {drive}, may_stay, 1e9);
  };
  const PanelForecast stays = forecast(true, double(8 * samples)), returns = forecast(false, double(8 * samples));
  EXPECT_EQ(stays.parts, 1);
  EXPECT_EQ(stays.use.bytes_moved - returns.use.bytes_moved, 8 * samples + 4 * rows);
  EXPECT_EQ(stays.use.bytes_out, 4 * rows);
  // The field itself is the largest buffer: it cannot be larger than the device allows, and comes back.
  const PanelForecast parts = forecast(true, double(8 * samples - 1));
  EXPECT_EQ(parts.parts, 2);
  EXPECT_FALSE(parts.stays);
  EXPECT_TRUE(parts.fits);
}

// A field that does not fit beside its bands comes back.
TEST_P(ShowDevices, LetTheFieldStayIfItFits) {
  one_.params.subpixels = 2;
  const PanelModel panel(one_.slm, one_.params, Modulation::phase, 200, 0, one_.state);
  CounterRandom random(1, 0, 0);
  Array2D<float> drive(one_.slm.grid.ny, one_.slm.grid.nx);
  for (float& level : drive.values) level = float(199 * random.uniform());
  const DeviceChoice choice{DeviceKind::opencl, GetParam()};
  const Field expected = *panel_field_by_device(panel, {drive}, choice);
  const double bytes = double(expected.samples.size()) * 8;
  const auto left_with = [&](double memory) {
    device_.limit_memory((double(device_.use().bytes_held) + memory) / 0.8);
    return *panel_field_on_device(panel, {drive}, choice);
  };
  for (const double memory : {1e8, 2.2 * bytes}) {
    const PanelField stays = left_with(memory);
    ASSERT_TRUE(std::holds_alternative<DeviceField>(stays.field)) << memory;
    EXPECT_EQ(fetch(std::get<DeviceField>(stays.field)).samples.values, expected.samples.values) << memory;
    EXPECT_NEAR(stays.power, power(expected), 1e-6 * power(expected));
  }
  const PanelField returns = left_with(1.8 * bytes);
  ASSERT_TRUE(std::holds_alternative<Field>(returns.field));
  EXPECT_EQ(std::get<Field>(returns.field).samples.values, expected.samples.values);
  EXPECT_NEAR(returns.power, power(expected), 1e-6 * power(expected));
  const ShownLight light = show_light(one_.hologram(), one_.slm, on_device(one_.params), one_.state);
  EXPECT_EQ(light.field.on_processor()->samples.values, shown(one_, on_device(one_.params)).samples.values);
}

// Levels are sent, and rows transformed, once for each band of columns: `auto` counts that.
TEST_P(ShowDevices, CountTheirBandsForAuto) {
  make_device_fast(1e15);
  const auto uses_bus = [&](double bus, double memory) {
    set_device_rates([=](Device&) { return DeviceRates{0, bus, 1e15}; });
    device_.limit_memory((double(device_.use().bytes_held) + memory) / 0.8);
    return uses_device(automatic(one_.params));
  };
  EXPECT_TRUE(uses_bus(6e4, 1e9));
  EXPECT_TRUE(uses_bus(1e9, 20e3));
  EXPECT_FALSE(uses_bus(6e4, 20e3));
}

TEST_P(ShowDevices, SayThatNotEvenTheSmallestPartsFit) {
  device_.limit_memory((double(device_.use().bytes_held) + 1e3) / 0.8);
  const std::string error = error_of([&] { shown(one_, on_device(one_.params)); });
  EXPECT_EQ(error.rfind("expected memory for the smallest parts of a panel of 48 × 37 pixels on the device " +
                            device_.info().name + ", got ",
                        0),
            0u)
      << error;
}

#if HOLOTRACE_HAS_OPENCL
// Every seventh call fails: memory, transfers and kernels.
TEST_P(ShowDevices, ReleaseTheirMemoryAndGiveWayAfterAnyFault) {
  const ShownCase one = shown_cases()[3];  // all effects
  make_device_fast(1e15);
  shown(one, on_device(one.params));  // compiles the kernels
  const Field expected = shown(one, one.params);
  const auto on_named = [&] { shown(one, on_device(one.params)); };
  const int faults = test::fail_every(7, on_named, [&](const std::string& error) {
    Heard heard;
    EXPECT_EQ(shown(one, automatic(one.params), heard.observer()).samples.values, expected.samples.values);
    EXPECT_EQ(heard.warnings, std::vector{test::warning_after(error)});
  });
  EXPECT_GT(faults, 5);
}
#endif

TEST_P(ShowDevices, RefuseAPatternOfAnotherSize) {
  const PanelModel panel(one_.slm, {}, Modulation::phase, 200, 0, one_.state);
  make_device_fast(1e15);
  for (const DeviceChoice& choice : {DeviceChoice{DeviceKind::opencl, GetParam()}, {DeviceKind::automatic}}) {
    Heard heard;
    EXPECT_EQ(error_of([&] { panel_field_by_device(panel, {Array2D<float>(2, 3)}, choice, heard.observer()); }),
              "expected a drive of 48 × 37 pixels, as the SLM \"test\" has, got 3 × 2");
    EXPECT_TRUE(heard.warnings.empty());
  }
}

}  // namespace
}  // namespace holotrace
