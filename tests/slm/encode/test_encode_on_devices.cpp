// Encoders on OpenCL devices: the levels of the processor, what is transferred, and what happens if the device fails.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "holotrace/base/units.h"
#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/encode_on_device.h"
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
  std::copy_n(special, std::min(std::size(special), field.samples.size()), field.samples.values.begin());
  return field;
}

struct EncodeCase {
  std::string name;
  Slm slm = make_panel(50, 37);
  EncodeParams params{.method = Encoding::phase};
  int most_off = 1;           // steps by which a level may differ from the processor's
  double most_differ = 2e-3;  // part of the pixels: three of 1850
};

// A phase in float is known to some 2e-7 turns: 1e-4 of the pixels of 256 levels lie as near to the middle between two of them,
// 3 % of those of 65536. Values of amplitudes and irradiances are known as well.
std::vector<EncodeCase> encode_cases() {
  std::vector<EncodeCase> cases;
  const auto add = [&](const std::string& name, Encoding method, const std::function<void(EncodeCase&)>& change = {}) {
    EncodeCase one{name};
    one.params.method = method;
    if (change) change(one);
    if (one.slm.levels == 65536) one.most_differ = 0.03;
    cases.push_back(one);
  };
  const auto real_image = [](EncodeCase& one) { one.params.image = ImageSide::real_image; };
  const auto tilted = [](EncodeCase& one) {
    one.params.reference_angle_x = -0.012;
    one.params.reference_angle_y = 0.007;
    one.params.image = ImageSide::real_image;
  };
  const auto many = [](EncodeCase& one) { one.slm.levels = 65536; };
  add("phase", Encoding::phase);
  add("real image", Encoding::phase, real_image);
  add("1.3π", Encoding::phase, [](EncodeCase& one) { one.slm.phase_range = 1.3 * pi; });
  add("2.8π", Encoding::phase, [](EncodeCase& one) { one.slm.phase_range = 2.8 * pi; });
  add("two levels", Encoding::phase, [](EncodeCase& one) { one.params.levels = 2; });
  add("65536 levels", Encoding::phase, many);
  add("amplitude", Encoding::amplitude, [](EncodeCase& one) { one.slm.modulation = Modulation::amplitude; });
  add("complex", Encoding::complex, [](EncodeCase& one) { one.slm.modulation = Modulation::complex; });
  add("off-axis", Encoding::off_axis);
  add("off-axis, tilted", Encoding::off_axis, tilted);
  add("off-axis without bias", Encoding::off_axis, [](EncodeCase& one) { one.params.with_bias = false; });
  add("off-axis, 65536 levels", Encoding::off_axis, many);
  add("double-phase", Encoding::double_phase);
  add("double-phase, real image", Encoding::double_phase, real_image);
  add("double-phase, 1.3π, wide stop", Encoding::double_phase, [](EncodeCase& one) {
    one.slm.phase_range = 1.3 * pi;
    one.params.stop = 0.9;
  });
  // Phases of samples of modulus near 1 are known to 1e-4 turns, six steps. Of all, half are known to 4e-7 turns or so.
  add("double-phase, 65536 levels", Encoding::double_phase, [&](EncodeCase& one) {
    many(one);
    one.most_off = 6;
  });
  cases.back().most_differ = 0.1;
  add("binary", Encoding::binary);
  add("binary, tilted", Encoding::binary, tilted);
  add("binary, dark and bright", Encoding::binary, [](EncodeCase& one) {
    one.slm.modulation = Modulation::amplitude;
    one.slm.grid.nx = 51;  // carriers of whole quarters of a turn: Re(U·R*) is 0 for some of the special samples
  });
  for (EncodeCase& one : cases)
    if (one.params.method == Encoding::binary) one.most_differ = one.most_off = 0;
  return cases;
}

class EncodeOnDevices : public test::StagesOnDevices {
 protected:
  PlacedField there(const Field& field) const { return PlacedField(send(device_, field)); }

  // What an encoder does on the device with that memory for the field and itself.
  EncodeForecast forecast(const EncodeCase& one, double memory) const { return forecast(one, memory, device_); }
  static EncodeForecast forecast(const EncodeCase& one, double memory, const Device& device) {
    const Field head = head_of(Field(one.slm.grid, test_wavelength));
    const Hologram blank = blank_hologram(head, one.slm, one.params, {});
    return forecast_encoding(device, head, blank, PhaseLevels(one.slm, blank.levels, test_wavelength), one.params,
                             memory);
  }

  // The memory that the field and its encoder take as a whole, and in the smallest parts.
  double whole_memory(const EncodeCase& one) const { return double(forecast(one, 1e12).use.most_held); }
  double least_memory(const EncodeCase& one) const { return double(forecast(one, 0).use.most_held); }

  void leave_memory(double bytes) const { device_.limit_memory((double(device_.use().bytes_held) + bytes) / 0.8); }

  // The part of levels that differ; none does by more than it may, around the circle of so many levels.
  static double different(const Array2D<uint16_t>& a, const Array2D<uint16_t>& b, int levels, int most_off) {
    size_t count = 0;
    for (size_t i = 0; i < b.size(); ++i) {
      const int off = std::abs(int(a.values[i]) - int(b.values[i]));
      EXPECT_LE(std::min(off, levels - off), most_off) << i;
      count += off > 0;
    }
    return b.size() > 0 ? double(count) / double(b.size()) : 0;
  }
};

HOLOTRACE_FOR_ALL_DEVICES(EncodeOnDevices);

TEST_P(EncodeOnDevices, GiveTheLevelsOfTheProcessor) {
  for (const EncodeCase& one : encode_cases()) {
    SCOPED_TRACE(one.name);
    const Field field = drawn_field(one.slm.grid);
    Heard expected, heard;
    const Hologram here = encode(field, one.slm, one.params, expected.observer());
    const Hologram hologram = encode(there(field), one.slm, on_device(one.params), heard.observer());
    const bool is_phase = here.modulation != Modulation::amplitude;
    EXPECT_LE(different(hologram.level, here.level, is_phase ? here.levels : 1 << 17, one.most_off), one.most_differ);
    ASSERT_EQ(hologram.modulus_level.size(), here.modulus_level.size());
    EXPECT_LE(different(hologram.modulus_level, here.modulus_level, 1 << 17, one.most_off), one.most_differ);
    if (one.params.method == Encoding::phase || one.params.method == Encoding::binary) {
      for (size_t i = 0; i < 8; ++i) EXPECT_EQ(hologram.level.values[i], here.level.values[i]) << i;
    }
    EXPECT_NEAR(hologram.illumination, here.illumination, 2e-6 * here.illumination);
    EXPECT_EQ(hologram.image, here.image);
    EXPECT_EQ(hologram.modulation, here.modulation);
    EXPECT_EQ(hologram.encoder, here.encoder);
    EXPECT_EQ(hologram.filter, here.filter);
    EXPECT_EQ(heard.warnings, expected.warnings);
    EXPECT_EQ(std::get<std::string>(heard.facts.at("device")), device_.info().name);
    EXPECT_EQ(heard.facts.size(), expected.facts.size() + 1);
    for (const auto& [name, value] : expected.facts)
      if (std::holds_alternative<double>(value)) {  // sums of floats, 1e-6; the part that is clipped is a difference
        const double off = 2e-6 * (name == "clipped_part" ? 1 : std::abs(std::get<double>(value)));
        EXPECT_NEAR(heard.number(name), std::get<double>(value), off) << name;
      }
  }
}

// Scaled by powers of two, so that squares are far beyond floats or far below: the same levels, to the last one.
TEST_P(EncodeOnDevices, TakeFieldsOfEveryBrightness) {
  for (const EncodeCase& one : encode_cases()) {
    SCOPED_TRACE(one.name);
    const Field field = drawn_field(one.slm.grid);
    const Hologram expected = encode(there(field), one.slm, on_device(one.params));
    for (const int exponent : {-90, 90, 126}) {
      Field scaled = field;
      for (auto& u : scaled.samples.values) u *= std::ldexp(1.0F, exponent);
      const size_t before = device_.use().kernels;
      Heard heard;
      const Hologram hologram = encode(there(scaled), one.slm, on_device(one.params), heard.observer());
      EXPECT_GT(device_.use().kernels, before + 2);
      EXPECT_EQ(heard.facts.count("device"), 1u);
      EXPECT_EQ(hologram.level.values, expected.level.values) << exponent;
      EXPECT_EQ(hologram.modulus_level.values, expected.modulus_level.values) << exponent;
      EXPECT_DOUBLE_EQ(hologram.illumination, std::ldexp(expected.illumination, 2 * exponent));
    }
  }
}

// Frequencies of n samples within so many cycles of n.
size_t within(double cycles) { return 2 * size_t(cycles) + 1; }

// Two bytes for each level, and four sums of each row. A spectrum takes the scale of each column and the roots of unity along both
// axes, and returns a sum for each of its columns within the stop. A reference wave takes 8 bytes for each row and column.
TEST_P(EncodeOnDevices, TransferLevelsOnly) {
  for (const EncodeCase& one : encode_cases()) {
    const Field field = drawn_field(one.slm.grid);
    const PlacedField light = there(field);
    const size_t nx = size_t(field.grid.nx), ny = 37, pixels = field.samples.size();
    const size_t of_spectrum = 8 * nx + 8 * (nx + ny), of_wave = 8 * (nx + ny), of_counts = 4 * 4097;
    size_t in = 0, out = 2 * pixels + 16 * ny;
    switch (one.params.method) {
      case Encoding::complex:
        out += 2 * pixels;
        break;
      case Encoding::off_axis:  // for the range of irradiances, and for the levels
        in += of_spectrum + 2 * of_wave;
        out += 8 * ny;
        break;
      case Encoding::binary:
        in += of_spectrum + of_wave;
        break;
      case Encoding::double_phase:  // of the field within the stop: moments, counts, what is clipped
        in += of_spectrum + of_counts;
        out += 16 * ny + of_counts + 4 * ny;
        break;
      default:
        break;
    }
    Heard heard;
    const Hologram hologram = encode(field, one.slm, one.params, heard.observer());
    if (hologram.filter) out += 4 * within(hologram.filter->half_u * field.grid.width());
    for (const bool is_there : {true, false}) {
      const DeviceUse before = device_.use();
      encode(is_there ? light : PlacedField::of(field), one.slm, on_device(one.params));
      const DeviceUse after = device_.use();
      EXPECT_EQ(after.bytes_in - before.bytes_in, in + (is_there ? 0 : 8 * pixels)) << one.name;
      EXPECT_EQ(after.bytes_out - before.bytes_out, out) << one.name;
    }
  }
}

// The encoder that is run on a device that only counts does there what it then does on the device, but for what sending the field
// takes: the same kernels and transfers, as a whole and in parts. The next test is about memory.
TEST_P(EncodeOnDevices, DoWhatIsForecast) {
  for (EncodeCase one : encode_cases())
    for (const double part : {2.0, 0.3, 0.0}) {
      SCOPED_TRACE(one.name + ", " + std::to_string(part));
      one.slm.grid = part == 0.3 ? Grid{102, 74, test_pitch}
                                 : Grid{200, 150, test_pitch};  // 17 and 37 are no factors of held lines
      const size_t bytes = 8 * size_t(one.slm.grid.pixels());
      const Field field = drawn_field(one.slm.grid);
      const double least = least_memory(one), memory = std::max(least, part * whole_memory(one));
      const EncodeForecast expected = forecast(one, memory);
      EXPECT_TRUE(expected.fits);
      EXPECT_EQ(expected.parts == 1, part > 1);
      leave_memory(memory);
      const DeviceUse before = device_.use();
      encode(field, one.slm, on_device(one.params));
      const DeviceUse after = device_.use();
      device_.limit_memory(0);
      const size_t of_sending = expected.parts == 1 ? 1 : 0;
      EXPECT_EQ(after.kernels - before.kernels, expected.use.kernels);
      EXPECT_EQ(after.bytes_moved - before.bytes_moved, expected.use.bytes_moved);
      EXPECT_EQ(after.bytes_out - before.bytes_out, expected.use.bytes_out);
      EXPECT_EQ(after.bytes_in - before.bytes_in, expected.use.bytes_in + of_sending * bytes);
      EXPECT_EQ(after.transfers - before.transfers, expected.use.transfers + of_sending);
    }
}

// A counted kernel moves each sample of 8 bytes once for the largest part, once for the moments and once for its level of 2
// bytes; and sums of rows, 16 bytes.
TEST_P(EncodeOnDevices, CountWhatKernelsReadAndWrite) {
  EncodeCase one{"one"};
  one.slm.grid = {200, 150, test_pitch};
  EXPECT_EQ(forecast(one, 1e12).use.bytes_moved, (3u * 8 + 2) * 30'000 + 16 * 150);
  EXPECT_EQ(forecast(one, 1e12).use.most_held, (8u + 2) * 30'000);
}

// A field of 240 kB goes in four parts to a device whose buffers have 70 kB at most, whatever its memory.
TEST_P(EncodeOnDevices, TakeNoLargerBufferThanTheDeviceHas) {
  EncodeCase one{"one"};
  one.slm.grid = {200, 150, test_pitch};
  DeviceInfo info = device_.info();
  info.largest_buffer = 70e3;
  const EncodeForecast parts = forecast(one, 1e12, Device(info, 1e12));
  EXPECT_TRUE(parts.fits);
  EXPECT_EQ(parts.parts, 4);
}

// With less than is forecast the field goes to the device in bands.
TEST_P(EncodeOnDevices, NeedTheMemoryThatIsForecast) {
  for (EncodeCase one : encode_cases()) {
    SCOPED_TRACE(one.name);
    one.slm.grid = {200, 150, test_pitch};
    const PlacedField light = there(drawn_field(one.slm.grid));
    const double needed = whole_memory(one) - 8 * 30'000;
    const auto bytes_sent = [&](double left) {
      leave_memory(left);
      const size_t before = device_.use().bytes_in;
      encode(light, one.slm, on_device(one.params));
      return double(device_.use().bytes_in - before);
    };
    EXPECT_LT(bytes_sent(needed), 8 * 30'000) << "tables";
    EXPECT_GE(bytes_sent(0.9 * needed), 2 * 8 * 30'000) << "rows for moments, and for levels";
    device_.limit_memory(0);
  }
}

// In a few bands of rows and of columns, with lines that a group of work items holds (200 and 150) and with others (37 and 1009),
// and single rows and columns: the levels are those of the whole field, byte for byte. Moments are added up in another order, in
// double.
TEST_P(EncodeOnDevices, GiveTheSameLevelsInBands) {
  struct Case {
    int nx, ny;
    double share;  // of the memory between what the smallest bands take and what the whole does
  };
  for (EncodeCase one : encode_cases())
    for (const auto& [nx, ny, share] :
         {Case{200, 150, 0.1}, Case{51, 37, 0.05}, Case{1009, 7, 0.1}, Case{60, 1, 0}, Case{1, 60, 0}, Case{2, 3, 0}}) {
      SCOPED_TRACE(one.name + " " + std::to_string(nx) + " x " + std::to_string(ny));
      one.slm.grid = {nx, ny, test_pitch};
      const Field field = drawn_field(one.slm.grid);
      Heard of_whole, of_bands, of_resident;
      const Hologram whole = encode(field, one.slm, on_device(one.params), of_whole.observer());
      const double least = least_memory(one), memory = least + share * (whole_memory(one) - least);
      const EncodeForecast parts = forecast(one, memory);
      ASSERT_TRUE(parts.fits);
      if (share > 0) {
        ASSERT_GT(parts.parts, 1);
      }
      leave_memory(memory);
      const Hologram banded = encode(field, one.slm, on_device(one.params), of_bands.observer());
      device_.limit_memory(0);
      EXPECT_EQ(banded.level.values, whole.level.values);
      EXPECT_EQ(banded.modulus_level.values, whole.modulus_level.values);
      EXPECT_NEAR(banded.illumination, whole.illumination, 1e-12 * whole.illumination);
      EXPECT_EQ(banded.filter, whole.filter);
      EXPECT_EQ(of_bands.warnings, of_whole.warnings);
      ASSERT_EQ(of_bands.facts.size(), of_whole.facts.size());
      for (const auto& [name, value] : of_whole.facts)
        if (const double* number = std::get_if<double>(&value)) {
          EXPECT_NEAR(of_bands.number(name), *number, 1e-12 * std::abs(*number)) << name;
        }
    }
}

// A field that is on the device, but leaves no room for what its encoder takes, returns and gives up its memory.
TEST_P(EncodeOnDevices, FreeTheDeviceOfTheFieldForBands) {
  const size_t before = device_.use().buffers;
  for (const EncodeCase& one : encode_cases()) {
    SCOPED_TRACE(one.name);
    const Field field = drawn_field(one.slm.grid);
    const Hologram whole = encode(there(field), one.slm, on_device(one.params));
    const PlacedField light = there(field);
    leave_memory(least_memory(one) - 8.0 * double(field.grid.pixels()));
    EXPECT_EQ(encode(light, one.slm, on_device(one.params)).level.values, whole.level.values);
    EXPECT_EQ(device_.use().buffers, before);
    device_.limit_memory(0);
  }
}

TEST_P(EncodeOnDevices, GiveTheSameLevelsIfKernelsAreStartedInParts) {
  for (const EncodeCase& one : encode_cases()) {
    const Field field = drawn_field(one.slm.grid);
    const Hologram expected = encode(field, one.slm, on_device(one.params));
    device_.limit_groups(3);
    const Hologram in_parts = encode(field, one.slm, on_device(one.params));
    device_.limit_groups(0);
    EXPECT_EQ(in_parts.level.values, expected.level.values) << one.name;
    EXPECT_EQ(in_parts.modulus_level.values, expected.modulus_level.values) << one.name;
    EXPECT_EQ(in_parts.illumination, expected.illumination) << one.name;
  }
}

TEST_P(EncodeOnDevices, NameASampleThatIsNotFiniteInAnyBand) {
  const EncodeCase one{"one"};
  leave_memory(4e3);  // six rows of 516 bytes
  for (const int row : {0, 20, 36}) {
    Field field = drawn_field(one.slm.grid);
    field.samples(row, 4) = {std::numeric_limits<float>::infinity(), 0};
    const std::string error = error_of([&] { encode(field, one.slm, on_device(one.params)); });
    EXPECT_NE(error.find("expected finite samples in the field"), std::string::npos) << error;
  }
}

TEST_P(EncodeOnDevices, SayThatABandDoesNotFit) {
  for (const EncodeCase& one : encode_cases()) {
    leave_memory(500);  // a row takes 400 bytes and those of its levels
    const std::string error = error_of([&] { encode(drawn_field(one.slm.grid), one.slm, on_device(one.params)); });
    const double least = least_memory(one);
    EXPECT_EQ(error, "expected " + format_bytes(least) + " of memory for bands of a field of " +
                         std::to_string(one.slm.grid.nx) + " × 37 samples on the device " + device_.info().name +
                         ", got 500 B; use a smaller panel, or the device cpu");
    make_device_fast(1e15);
    Heard heard;
    const Field field = drawn_field(one.slm.grid);
    EXPECT_EQ(encode(field, one.slm, automatic(one.params), heard.observer()).level.values,
              encode(field, one.slm, one.params).level.values);
    EXPECT_EQ(heard.facts.count("device"), 0u);
  }
}

// A field of 1850 samples goes there twice, 8 bytes each, and 2 of each level and 16 of each of 37 rows return: 0.339 s at 1e5
// bytes/s. Seven bands of six rows are sent twice, and return two sums and levels: 35 transfers take 0.0105 s.
TEST_P(EncodeOnDevices, AreChosenByTheTransfersOfTheirBands) {
  const EncodeCase one{"one"};
  const int number = device_.info().number;
  set_device_rates([=](Device& device) {
    return device.info().number == number ? DeviceRates{0, 1e5, 1e15} : DeviceRates();
  });
  leave_memory(4e3);
  for (const double seconds : {0.344, 0.355}) {
    test::set_processor_rates({.samples = 2 * 1850 / seconds});
    const size_t before = device_.use().kernels;
    encode(drawn_field(one.slm.grid), one.slm, automatic(one.params));
    EXPECT_EQ(device_.use().kernels > before, seconds > 0.35) << seconds;
  }
}

TEST_P(EncodeOnDevices, AreChosenByWhereTheFieldIs) {
  const EncodeCase one{"one"};
  const Field field = drawn_field(one.slm.grid);
  const PlacedField light = there(field);
  // The processor takes 0.1 s; 8 bytes of each of 1850 samples take 0.15 s on their way, the levels 0.04 s.
  test::set_processor_rates({.samples = 2 * 1850 / 0.1});
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
  leave_memory(1850);  // of 2 bytes per level
  EXPECT_FALSE(uses_device(light, automatic(one.params))) << "levels do not fit, and bands take longer";
  device_.limit_memory(0);
  set_device_rates({});
  EXPECT_FALSE(uses_device(there(field), automatic(one.params))) << "not measured";
}

// The processor takes 1850·5·(log₂50 + log₂37)/1e5 = 1 s for a transform, and some µs for all else. The way to the device and
// back takes 8·1850/1e5 + 2·1850/1e5 = 0.2 s.
TEST_P(EncodeOnDevices, AreChosenByTheirTransforms) {
  test::set_processor_rates({.fft_operations = 1e5});
  const int number = device_.info().number;
  set_device_rates([=](Device& device) {
    return device.info().number == number ? DeviceRates{0, 1e5, 1e15} : DeviceRates();
  });
  for (const EncodeCase& one : encode_cases()) {
    const size_t before = device_.use().kernels;
    encode(drawn_field(one.slm.grid), one.slm, automatic(one.params));
    const Encoding method = one.params.method;
    const bool has_transforms =
        method == Encoding::off_axis || method == Encoding::binary || method == Encoding::double_phase;
    EXPECT_EQ(device_.use().kernels > before, has_transforms) << one.name;
  }
}

TEST_P(EncodeOnDevices, LeaveToTheProcessorWhatItDoesBetter) {
  make_device_fast(1e15);
  EncodeCase one{"one"};
  Field field = drawn_field(one.slm.grid);
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
  Heard warned;
  EXPECT_EQ(encode(there(field), one.slm, on_device(one.params), warned.observer()).level.values,
            encode(field, one.slm, one.params).level.values);
  ASSERT_EQ(warned.warnings.size(), 1U);
  EXPECT_EQ(warned.warnings[0],
            "the hologram is encoded on the processor, not on the OpenCL device, because the SLM \"test\" has a "
            "calibration, a crystal, a wavefront error or a light map; use the device cpu, or [encode] effects = none");
  one.params.method = Encoding::binary;  // of a calibration one step is used
  EXPECT_EQ(encode(there(field), one.slm, on_device(one.params)).level.values,
            encode(field, one.slm, one.params).level.values);
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
  for (const EncodeCase& one : encode_cases()) {
    encode(there(drawn_field(one.slm.grid)), one.slm, on_device(one.params));
    leave_memory(80e3);  // bands, and 8 kB around each buffer
    encode(drawn_field(one.slm.grid), one.slm, on_device(one.params));
    device_.limit_memory(0);
  }
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

#if HOLOTRACE_HAS_OPENCL
TEST_P(EncodeOnDevices, ReleaseTheirMemoryAndGiveWayAfterAnyFault) {
  for (const EncodeCase& one : encode_cases()) {
    if (one.name != "complex" && one.name != "off-axis" && one.name != "double-phase" && one.name != "binary") continue;
    SCOPED_TRACE(one.name);
    const Field field = drawn_field(one.slm.grid);
    Heard here;
    const Hologram expected = encode(field, one.slm, one.params, here.observer());
    encode(field, one.slm, on_device(one.params));  // compiles the kernels
    make_device_fast(1e15);
    for (const double memory : {1e9, one.name == "double-phase" ? 48e3 : 8e3}) {  // as a whole, and in bands
      leave_memory(memory);
      const auto on_named = [&] { encode(field, one.slm, on_device(one.params)); };
      const int faults =
          test::fail_every(memory < 1e6 && one.name != "complex" ? 7 : 1, on_named, [&](const std::string& error) {
            Heard heard;
            std::map<std::string, int> told;
            Observer observer = heard.observer();
            observer.on_fact = [&](const std::string& name, const Fact&) { ++told[name]; };
            const Hologram hologram = encode(field, one.slm, automatic(one.params), observer);
            for (const auto& [name, times] : told) EXPECT_EQ(times, 1) << name;
            EXPECT_EQ(hologram.level.values, expected.level.values);
            EXPECT_EQ(hologram.modulus_level.values, expected.modulus_level.values);
            ASSERT_EQ(heard.warnings.size(), here.warnings.size() + 1);
            EXPECT_EQ(std::count(heard.warnings.begin(), heard.warnings.end(), test::warning_after(error)), 1);
          });
      EXPECT_GT(faults, 8);
      device_.limit_memory(0);
    }
  }
}
#endif

}  // namespace
}  // namespace holotrace
