// Sums of waves that stay on the device that sums them.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <complex>
#include <future>
#include <memory>
#include <set>

#include "holotrace/base/machine.h"
#include "holotrace/base/threads.h"
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
    sources_.label.name = "lamp";
    sources_.label.frame = 3;
    sources_.label.cone_wavelength = 500_nm;
  }
  static const Field& field_of(const PlacedField& placed) { return *placed.on_processor(); }
  PlacedField placed_sum(const Grid& panel, const SynthesizeParams& params) const {
    return synthesize_placed(std::make_shared<const Sources>(sources_), panel, params);
  }
  PlacedField placed_sum(const SynthesizeParams& params) const { return placed_sum(panel_, params); }
  // Samples on the device and, if it is lost, those of again(observer).
  PlacedField field_there(ComputeAgain again) const {
    return PlacedField(send(device_, Field(panel_, 532_nm)), std::move(again));
  }

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
    const PlacedField placed = placed_sum(params_);
    const Field field = synthesize(sources_, panel_, params_);
    EXPECT_EQ(field_of(placed).samples.values, field.samples.values) << has_tiles;
    EXPECT_EQ(field_of(placed).wavelength, field.wavelength);
    EXPECT_EQ(placed.head().label.name, "lamp");
    EXPECT_EQ(placed.head().label.frame, 3u);
    EXPECT_EQ(field_of(placed).label.cone_wavelength, 500_nm);
  }
}

// At most 48 bytes of each wave, and 8 of each place of a tile; of each row the energy comes back, perhaps twice.
TEST_P(PlacedSums, TransferWavesOnly) {
  const DeviceUse before = device_.use();
  const PlacedField placed = placed_sum(params_);
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
  const PlacedField placed = placed_sum({200, 70, 8_um}, params_);
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
  Field field = into_field(placed_sum(params));
  EXPECT_EQ(field.samples.values, synthesize(sources_, panel_, params).samples.values);
  EXPECT_EQ(field.label.name, "lamp");
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
TEST_P(PlacedSums, AreChosenWithTheFieldsReturnIfItIsNeeded) {
  SummationRates slow;
  slow.multiply_adds = slow.factors = slow.wave_tiles = 1e3;
  set_summation_rates([slow] { return slow; });
  const double seconds =
      forecast_sum(sources_, panel_, params_.tolerance, Approach::tiled).seconds * thread_count() / processor_threads();
  ASSERT_LT(2 * 48 * 60, 8 * 96 * 70);
  const int number = device_.info().number;
  set_device_rates([=](Device& device) {
    return device.info().number == number ? DeviceRates{1e15, 2 * 48 * 60 / seconds, 1e15} : DeviceRates();
  });
  const auto uses_device = [&](const auto& sum) {
    const size_t before = device_.use().kernels;
    sum();
    return device_.use().kernels > before;
  };
  const auto shared = std::make_shared<const Sources>(sources_);
  EXPECT_TRUE(uses_device([&] { synthesize_placed(shared, panel_, automatic(params_)); }));
  EXPECT_FALSE(uses_device([&] { synthesize_placed(shared, panel_, automatic(params_), {}, true); }));
  EXPECT_FALSE(uses_device([&] { synthesize(sources_, panel_, automatic(params_)); }));
}

TEST_P(PlacedSums, WriteNothingPastTheirBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  placed_sum(params_);
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

// Rates are measured when they are first needed.
TEST_P(PlacedSums, AreFarFromADeviceThatFailsWhenItIsMeasured) {
  const PlacedField placed = field_there({}), here = PlacedField(Field(panel_, 532_nm));
  set_device_rates([](Device&) -> DeviceRates { throw Error("the device stopped"); });
  EXPECT_TRUE(std::isinf(placed.seconds_to_processor()));
  EXPECT_EQ(placed.seconds_to(device_), 0);
  EXPECT_TRUE(std::isinf(here.seconds_to(device_)));
  EXPECT_EQ(here.seconds_to_processor(), 0);
}

TEST_P(PlacedSums, GiveUpTheirMemoryOnTheDevice) {
  const size_t before = device_.use().buffers;
  const PlacedField placed = field_there({});
  EXPECT_TRUE(placed.is_on(device_));
  const auto here = placed.only_on_processor();
  EXPECT_EQ(device_.use().buffers, before);
  EXPECT_FALSE(placed.is_on(device_));
  EXPECT_EQ(placed.on_processor(), here);
  EXPECT_EQ(fetch(*placed.on(device_)).samples.values, here->samples.values) << "it goes there again";
}

// As many kernels have more groups than some devices take at once: here 3, along y and z.
TEST_P(PlacedSums, AreTheSameIfKernelsAreStartedInParts) {
  for (const SynthesisMethod method : {SynthesisMethod::tiled, SynthesisMethod::planes}) {
    params_.method = method;
    const Field expected = synthesize(sources_, panel_, params_);
    const size_t before = device_.use().kernels;
    device_.limit_groups(3);
    const Field in_parts = synthesize(sources_, panel_, params_);
    device_.limit_groups(0);
    EXPECT_GT(device_.use().kernels, before);
    EXPECT_EQ(in_parts.samples.values, expected.samples.values) << int(method);
  }
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
  const auto waves = std::make_shared<const Sources>(sources_);
  const size_t before = device_.use().buffers;
  const PlacedField placed = synthesize_placed(waves, panel_, automatic(params_));
  ASSERT_EQ(placed.seconds_to(device_), 0) << "it is there";
  EXPECT_EQ(waves.use_count(), 2) << "no copy is kept";
  test::FaultyApi api;
  api.failing = 0;
  std::vector<std::string> warnings;
  std::set<std::string> facts;
  double progress = 0;
  Observer observer;
  observer.on_warning = [&](const std::string& sentence) { warnings.push_back(sentence); };
  observer.on_fact = [&](const std::string& name, const Fact&) { facts.insert(name); };
  observer.on_progress = [&](double fraction) { progress = std::max(progress, fraction); };
  SynthesizeParams on_processor = params_;
  on_processor.device = {};
  EXPECT_EQ(placed.on_processor(observer)->samples.values, synthesize(sources_, panel_, on_processor).samples.values);
  EXPECT_EQ(placed.on_processor()->label.name, "lamp");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("the device auto: the processor took over, because the device "), 0u);
  EXPECT_EQ(progress, 1) << "of the sum";
  EXPECT_TRUE(facts.empty()) << "they were told by the first sum";
  EXPECT_EQ(waves.use_count(), 1) << "the waves are not needed any more";
  EXPECT_EQ(device_.use().buffers, before) << "nor is the device";
  EXPECT_GT(placed.seconds_to(device_), 0);
}

// Whatever computes the field may wait for threads that ask for it.
TEST_P(PlacedSums, HoldNothingThatOthersNeedWhileTheyAreComputed) {
  bool others_wait = true;
  std::shared_ptr<const PlacedField> placed;
  std::future<double> other;
  placed = std::make_shared<const PlacedField>(field_there([&](const Observer&) {
    other = std::async(std::launch::async, [&] { return placed->seconds_to_processor(); });
    others_wait = other.wait_for(std::chrono::seconds(20)) != std::future_status::ready;
    return Field(panel_, 532_nm);
  }));
  test::FaultyApi api;
  api.failing = 0;
  placed->on_processor();
  EXPECT_FALSE(others_wait);
}

TEST_P(PlacedSums, AreOneFieldForAllThreads) {
  std::atomic<int> sums = 0;
  const auto ramp = [&] {
    Field field(panel_, 532_nm);
    parallel_for(0, int64_t(field.samples.size()), [&](int64_t i) { field.samples.values[size_t(i)] = float(i); });
    return field;
  };
  const PlacedField placed(send(device_, ramp()), [&](const Observer&) {
    ++sums;
    return ramp();
  });
  test::FaultyApi api;
  api.failing = 0;
  std::vector<std::shared_ptr<const Field>> seen(64);
  parallel_for(0, int64_t(seen.size()), [&](int64_t i) { seen[size_t(i)] = placed.on_processor(); });
  for (const auto& field : seen) EXPECT_EQ(field, placed.on_processor());
  EXPECT_EQ(seen[0]->samples(1, 0), std::complex<float>(96));
  EXPECT_EQ(sums, 1) << "the first call of the driver fails, and no other one";
}
#endif

}  // namespace
}  // namespace holotrace
