// Sums of waves that stay on the device that sums them.

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <thread>

#include "holotrace/base/thread_count.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/summation.h"
#include "holotrace/wave/synthesize.h"
#include "support/build_paths.h"
#include "support/error_of.h"
#include "support/fields.h"
#include "support/stages_on_devices.h"
#if HOLOTRACE_HAS_OPENCL
#include "support/faulty_api.h"
#endif

namespace holotrace {
namespace {

using namespace literals;

class PlacedSums : public test::StagesOnDevices {
 protected:
  PlacedSums() {
    sources_.name = "lamp";
    sources_.frame = 3;
    sources_.cone_wavelength = 500_nm;
  }
  static const Field& field_of(const PlacedField& placed) { return *placed.on_processor(); }

  Grid panel_{96, 70, 8_um};
  Sources sources_ = test::make_random_sources(60, panel_, 532_nm, 0.05, 0.08);
  SynthesizeParams params_ = on_device(SynthesizeParams{.method = SynthesisMethod::tiled});
};

HOLOTRACE_FOR_ALL_DEVICES(PlacedSums);

TEST_P(PlacedSums, AreTheFieldThatReturns) {
  for (const bool has_tiles : {false, true}) {
    if (has_tiles) {  // 3 × 2 parts of the panel, of which one has no waves
      sources_.tiles.columns = 3;
      sources_.tiles.rows = 2;
      for (int tile = 0; tile < 6; ++tile)
        sources_.tiles.values.insert(sources_.tiles.values.end(), sources_.waves.size(), tile == 4 ? 0.0F : 1.0F);
    }
    const PlacedField placed = synthesize_placed(sources_, panel_, params_);
    const Field field = synthesize(sources_, panel_, params_);
    EXPECT_EQ(field_of(placed).samples.values, field.samples.values) << has_tiles;
    EXPECT_EQ(field_of(placed).wavelength, field.wavelength);
    EXPECT_EQ(placed.head().name, "lamp");
    EXPECT_EQ(placed.head().frame, 3u);
    EXPECT_EQ(field_of(placed).cone_wavelength, 500_nm);
  }
}

// At most 48 bytes of each wave, and 8 of each place of a tile; of each row the energy comes back, perhaps twice.
TEST_P(PlacedSums, TransferWavesOnly) {
  const DeviceUse before = device_.use();
  const PlacedField placed = synthesize_placed(sources_, panel_, params_);
  const DeviceUse after = device_.use();
  EXPECT_EQ((after.bytes_out - before.bytes_out) % (4 * 70), 0u);
  EXPECT_LE(after.bytes_out - before.bytes_out, 2u * 4 * 70);
  EXPECT_LE(after.bytes_in - before.bytes_in, 2u * (48 * 60 + 8 * (96 + 70)));
  EXPECT_EQ(after.bytes_held - before.bytes_held, 8u * 96 * 70);
  EXPECT_EQ(placed.seconds_to(device_), 0);
}

TEST_P(PlacedSums, ReturnIfMemoryIsShort) {
  const Field field = synthesize(sources_, panel_, params_);
  device_.limit_memory((double(device_.use().bytes_held) + 200e3) /
                       0.8);  // less than a field twice, and enough for a sum
  const size_t before = device_.use().bytes_held;
  const PlacedField placed = synthesize_placed(sources_, {200, 70, 8_um}, params_);
  EXPECT_EQ(device_.use().bytes_held, before);
  device_.limit_memory(0);
  EXPECT_EQ(field_of(placed).samples.values, synthesize(sources_, {200, 70, 8_um}, params_).samples.values);
}

// Of floats that are summed in parts: 1e-6 of the sum.
TEST_P(PlacedSums, KnowTheEnergyOfABox) {
  Field field(panel_, 532_nm);
  for (size_t i = 0; i < field.samples.size(); ++i) field.samples.values[i] = {float(i % 97), float(i / 97)};
  const DeviceField there = send(device_, field);
  for (const PixelBox& box : {PixelBox{0, 96, 0, 70}, {5, 90, 12, 13}, {3, 4, 0, 70}, {30, 96, 69, 70}}) {
    double sum = 0;
    for (int j = box.y0; j < box.y1; ++j)
      for (int i = box.x0; i < box.x1; ++i) sum += std::norm(std::complex<double>(field.samples(j, i)));
    EXPECT_NEAR(energy(there, box), sum, 1e-6 * sum);
  }
}

TEST_P(PlacedSums, OfTheProcessorAreItsOwn) {
  const SynthesizeParams params{.method = SynthesisMethod::tiled};
  Field field = into_field(synthesize_placed(sources_, panel_, params));
  EXPECT_EQ(field.samples.values, synthesize(sources_, panel_, params).samples.values);
  EXPECT_EQ(field.name, "lamp");
}

TEST_P(PlacedSums, AreMovedOutIfNobodySharesThem) {
  Field field = synthesize(sources_, panel_, {});
  const auto* const samples = field.samples.values.data();
  PlacedField placed(std::move(field));
  const PlacedField copy = placed;
  EXPECT_NE(into_field(placed).samples.values.data(), samples);
  EXPECT_EQ(copy.on_processor()->samples.values.data(), samples);
  placed = PlacedField(Field());
  const auto held = copy.on_processor();
  EXPECT_NE(into_field(copy).samples.values.data(), samples);
  PlacedField alone(synthesize(sources_, panel_, {}));
  const auto* const own = alone.on_processor()->samples.values.data();
  EXPECT_EQ(into_field(std::move(alone)).samples.values.data(), own);
}

// The waves alone take half of the processor's time, the field more than all of it.
TEST_P(PlacedSums, AreChosenWithoutTheFieldsReturn) {
  SummationRates slow;
  slow.multiply_adds = slow.factors = slow.wave_tiles = 1e3;
  set_summation_rates([slow] { return slow; });
  const double seconds = forecast_sum(sources_, panel_, params_.tolerance, Approach::tiled).seconds * thread_count() /
                         std::max(1U, std::thread::hardware_concurrency());
  ASSERT_LT(2 * 48 * 60, 8 * 96 * 70);
  const int number = device_.info().number;
  set_device_rates([=](Device& device) {
    return device.info().number == number ? DeviceRates{1e15, 2 * 48 * 60 / seconds, 1e15} : DeviceRates();
  });
  const auto uses_device = [&](const auto& sum) {
    const size_t before = device_.use().kernels;
    sum(sources_, panel_, automatic(params_), Observer{});
    return device_.use().kernels > before;
  };
  EXPECT_TRUE(uses_device(synthesize_placed));
  EXPECT_FALSE(uses_device(synthesize));
}

TEST_P(PlacedSums, WriteNothingPastTheirBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  synthesize_placed(sources_, panel_, params_);
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

#if HOLOTRACE_HAS_OPENCL
TEST_P(PlacedSums, AreSummedAgainIfTheirDeviceIsLost) {
  const int number = device_.info().number;
  SummationRates slow;
  slow.multiply_adds = slow.factors = slow.wave_tiles = 1e3;
  set_summation_rates([slow] { return slow; });
  set_device_rates([=](Device& device) {
    return device.info().number == number ? DeviceRates{1e15, 1e15, 1e15} : DeviceRates();
  });
  const PlacedField placed = synthesize_placed(sources_, panel_, automatic(params_));
  ASSERT_EQ(placed.seconds_to(device_), 0) << "it is there";
  test::FaultyApi api;
  api.failing = 0;
  std::vector<std::string> warnings;
  Observer observer;
  observer.on_warning = [&](const std::string& sentence) { warnings.push_back(sentence); };
  SynthesizeParams on_processor = params_;
  on_processor.device = {};
  EXPECT_EQ(placed.on_processor(observer)->samples.values, synthesize(sources_, panel_, on_processor).samples.values);
  EXPECT_EQ(placed.on_processor()->name, "lamp");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("the device auto: the processor took over, because the device "), 0u);
}
#endif

}  // namespace
}  // namespace holotrace
