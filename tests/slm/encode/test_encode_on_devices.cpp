// Encoders of single pixels on OpenCL devices: the levels of the processor, what is transferred, and what happens if the device
// fails.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

#include "holotrace/slm/encode/encode.h"
#include "support/build_paths.h"
#include "support/panels.h"
#include "support/stages_on_devices.h"
#if HOLOTRACE_HAS_OPENCL
#include "support/faulty_api.h"
#endif

namespace holotrace {
namespace {

// Random samples, and some of phases 0 and ½ turn, of either sign of 0, and dark ones.
Field drawn_field(const Grid& grid) {
  Field field(grid, test_wavelength);
  CounterRandom random(5, 0, 0);
  for (auto& u : field.samples.values) u = std::polar(float(random.uniform()), float(2 * pi * random.uniform()));
  const std::complex<float> special[] = {{1, 0}, {1, -0.0F}, {-1, 0}, {-1, -0.0F},
                                         {0, 1}, {0, -1},    {0, 0},  {-0.0F, -0.0F}};
  std::copy(std::begin(special), std::end(special), field.samples.values.begin());
  return field;
}

struct EncodeCase {
  std::string name;
  Slm slm = make_panel(50, 37);
  EncodeParams params{.method = Encoding::phase};
};

std::vector<EncodeCase> encode_cases() {
  EncodeCase phase{"phase"}, real{"real image"}, shorter{"1.3π"}, longer{"2.8π"}, two{"two levels"},
      many{"65536 levels"}, amplitude{"amplitude"}, complex{"complex"};
  real.params.image = ImageSide::real_image;
  shorter.slm.phase_range = 1.3 * pi;
  longer.slm.phase_range = 2.8 * pi;
  two.params.levels = 2;
  many.slm.levels = 65536;
  amplitude.params.method = Encoding::amplitude;
  amplitude.slm.modulation = Modulation::amplitude;
  complex.params.method = Encoding::complex;
  complex.slm.modulation = Modulation::complex;
  return {phase, real, shorter, longer, two, many, amplitude, complex};
}

class EncodeOnDevices : public test::StagesOnDevices {
 protected:
  PlacedField there(const Field& field) const { return PlacedField(send(device_, field)); }

  // Levels that differ, as a fraction; by more than one, around the circle, none does.
  static double different(const Array2D<uint16_t>& a, const Array2D<uint16_t>& b, int levels) {
    size_t count = 0;
    for (size_t i = 0; i < b.size(); ++i) {
      const int off = std::abs(int(a.values[i]) - int(b.values[i]));
      EXPECT_LE(std::min(off, levels - off), 1) << i;
      count += off > 0;
    }
    return b.size() > 0 ? double(count) / double(b.size()) : 0;
  }
};

HOLOTRACE_FOR_ALL_DEVICES(EncodeOnDevices);

// A phase in float is known to some 2e-7 turns: 1e-4 of the pixels of 256 levels lie as near to the middle between two of them,
// 3 % of those of 65536.
TEST_P(EncodeOnDevices, GiveTheLevelsOfTheProcessor) {
  for (const EncodeCase& one : encode_cases()) {
    const Field field = drawn_field(one.slm.grid);
    Heard expected, heard;
    const Hologram here = encode(field, one.slm, one.params, expected.observer());
    const Hologram hologram = encode(there(field), one.slm, on_device(one.params), heard.observer());
    const double most = one.slm.levels == 65536 ? 0.03 : 2e-3;  // 2e-3: three of 1850 pixels
    EXPECT_LE(different(hologram.level, here.level, here.levels), most) << one.name;
    ASSERT_EQ(hologram.modulus_level.size(), here.modulus_level.size()) << one.name;
    EXPECT_LE(different(hologram.modulus_level, here.modulus_level, 1 << 17), most) << one.name;
    for (size_t i = 0; i < 8; ++i) EXPECT_EQ(hologram.level.values[i], here.level.values[i]) << one.name << i;
    EXPECT_NEAR(hologram.illumination, here.illumination, 2e-6 * here.illumination) << one.name;
    EXPECT_EQ(hologram.image, here.image);
    EXPECT_EQ(hologram.modulation, here.modulation);
    EXPECT_EQ(hologram.encoder, here.encoder);
    EXPECT_EQ(heard.warnings, expected.warnings) << one.name;
    EXPECT_EQ(std::get<std::string>(heard.facts.at("device")), device_.info().name);
    EXPECT_EQ(heard.facts.size(), expected.facts.size() + 1) << one.name;
    for (const char* fact : {"illumination", "modulus_max", "mean_transmittance"})
      if (expected.facts.count(fact)) {
        EXPECT_NEAR(heard.number(fact), expected.number(fact), 2e-6 * expected.number(fact)) << one.name << fact;
      }
  }
}

// Two bytes for each level, and three sums of each row.
TEST_P(EncodeOnDevices, TransferLevelsOnly) {
  for (const EncodeCase& one : encode_cases()) {
    const Field field = drawn_field(one.slm.grid);
    const PlacedField light = there(field);
    const size_t pixels = field.samples.size(), kinds = one.params.method == Encoding::complex ? 2 : 1;
    for (const bool is_there : {true, false}) {
      const DeviceUse before = device_.use();
      encode(is_there ? light : PlacedField::of(field), one.slm, on_device(one.params));
      const DeviceUse after = device_.use();
      EXPECT_EQ(after.bytes_in - before.bytes_in, is_there ? 0 : 8 * pixels) << one.name;
      EXPECT_EQ(after.bytes_out - before.bytes_out, 2 * kinds * pixels + 12 * 37) << one.name;
    }
  }
}

TEST_P(EncodeOnDevices, AreChosenByWhereTheFieldIs) {
  const EncodeCase one{"one"};
  const Field field = drawn_field(one.slm.grid);
  const PlacedField light = there(field);
  // The processor takes 0.1 s; 8 bytes of each of 1850 samples take 0.15 s on their way, the levels 0.04 s.
  SummationRates slow;
  slow.samples = 2 * 1850 / 0.1 / std::max(1U, std::thread::hardware_concurrency());
  set_summation_rates([slow] { return slow; });
  const int number = device_.info().number;
  set_device_rates([=](Device& device) {
    return device.info().number == number ? DeviceRates{0, 1e5, 1e15} : DeviceRates();
  });
  const auto uses_device = [&](const PlacedField& shown, const EncodeParams& params) {
    const size_t before = device_.use().kernels;
    encode(shown, one.slm, params);
    return device_.use().kernels > before;
  };
  EXPECT_TRUE(uses_device(light, automatic(one.params)));
  EXPECT_FALSE(uses_device(PlacedField::of(field), automatic(one.params)));
  EXPECT_FALSE(uses_device(light, one.params)) << "the processor is the default";
  set_device_rates({});
  EXPECT_FALSE(uses_device(there(field), automatic(one.params))) << "not measured";
}

TEST_P(EncodeOnDevices, LeaveToTheProcessorWhatItDoesBetter) {
  make_device_fast(1e15);
  EncodeCase one{"one"};
  Field field = drawn_field(one.slm.grid);
  for (auto& u : field.samples.values) u *= 1e25F;  // whose squares are beyond floats
  EXPECT_EQ(encode(there(field), one.slm, on_device(one.params)).level.values,
            encode(field, one.slm, one.params).level.values);
  field.samples(3, 4) = {std::numeric_limits<float>::quiet_NaN(), 0};
  const std::string error = error_of([&] { encode(field, one.slm, one.params); });
  EXPECT_NE(error.find("expected finite samples in the field"), std::string::npos) << error;
  for (const EncodeParams& params : {on_device(one.params), automatic(one.params)}) {
    Heard heard;
    EXPECT_EQ(error_of([&] { encode(there(field), one.slm, params, heard.observer()); }), error);
    EXPECT_TRUE(heard.warnings.empty());
  }
  for (int level = 0; level < 256; ++level)
    one.slm.effects.calibration.push_back({0.02 * level + 4e-5 * level * level, 1});
  one.params.effects = {"calibration"};
  field = drawn_field(one.slm.grid);
  EXPECT_EQ(encode(there(field), one.slm, automatic(one.params)).level.values,
            encode(field, one.slm, one.params).level.values);
  EXPECT_EQ(error_of([&] { encode(there(field), one.slm, on_device(one.params)); }),
            "expected levels of even steps on an OpenCL device, got those of the calibration of \"test\"; leave "
            "calibration out of [encode] effects, or use the device cpu");
}

TEST_P(EncodeOnDevices, WarnOfADarkField) {
  const EncodeCase one{"one"};
  const Field dark(one.slm.grid, test_wavelength);
  Heard expected, heard;
  const Hologram here = encode(dark, one.slm, one.params, expected.observer());
  const Hologram hologram = encode(there(dark), one.slm, on_device(one.params), heard.observer());
  ASSERT_EQ(expected.warnings.size(), 1u);
  EXPECT_EQ(heard.warnings, expected.warnings);
  EXPECT_EQ(hologram.level.values, here.level.values);
  EXPECT_EQ(hologram.illumination, 0);
}

TEST_P(EncodeOnDevices, WriteNothingPastTheirBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  for (const EncodeCase& one : encode_cases()) encode(there(drawn_field(one.slm.grid)), one.slm, on_device(one.params));
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

#if HOLOTRACE_HAS_OPENCL
TEST_P(EncodeOnDevices, ReleaseTheirMemoryAndGiveWayAfterAnyFault) {
  const EncodeCase one = encode_cases().back();
  const Field field = drawn_field(one.slm.grid);
  const Hologram expected = encode(field, one.slm, one.params);
  encode(field, one.slm, on_device(one.params));  // compiles the kernels
  make_device_fast(1e15);
  int faults = 0;
  for (int failed = 0;; ++failed) {
    test::FaultyApi api;
    api.failing = failed;
    const std::string error = error_of([&] { encode(field, one.slm, on_device(one.params)); });
    EXPECT_TRUE(api.held.empty()) << failed;
    if (api.calls <= failed) {
      EXPECT_EQ(error, "no error");
      break;
    }
    EXPECT_NE(error, "no error");
    ++faults;
    api.calls = 0;
    Heard heard;
    const Hologram hologram = encode(field, one.slm, automatic(one.params), heard.observer());
    EXPECT_EQ(hologram.level.values, expected.level.values) << failed;
    EXPECT_EQ(hologram.modulus_level.values, expected.modulus_level.values) << failed;
    ASSERT_EQ(heard.warnings.size(), 1u) << failed;
    EXPECT_EQ(heard.warnings[0], "the device auto: the processor took over, because " + error);
  }
  EXPECT_GT(faults, 8);
}
#endif

}  // namespace
}  // namespace holotrace
