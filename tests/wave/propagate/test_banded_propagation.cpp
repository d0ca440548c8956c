// Propagations that do not fit in a device's memory, on every OpenCL device.

#include <gtest/gtest.h>

#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/convolve.h"
#include "holotrace/wave/propagate/device_propagator.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/build_paths.h"
#include "support/error_of.h"
#include "support/fields.h"
#include "wave/propagate/propagation_on_devices.h"
#if HOLOTRACE_HAS_OPENCL
#include "support/faulty_api.h"
#endif

namespace holotrace {
namespace {

using namespace literals;
using test::propagation_rounding;
using test::relative_error;

// Both fields of 66 x 49 samples take 52 kB, up to 78 kB for the largest window; a column of the spectrum takes about 2 kB.
constexpr double memory_for_fields = 160e3, memory_for_rows = 40e3;

class BandedPropagationTest : public test::PropagationOnDevices {
 protected:
  struct Result {
    double error;
    BandedPlan plan;
  };
  // In bands that fit in this memory, against the processor's in double.
  Result result_in(double memory, const Field& field, double distance, const PropagateParams& params) {
    const auto grid = field.grid;
    const auto expected = propagate(convert<double>(field), make_propagator<double>(grid, 532_nm, distance, params));
    BandedPropagation banded(
        device_, std::make_shared<Propagator<float>>(make_propagator<float>(grid, 532_nm, distance, params)));
    leave_memory(memory);
    const BandedPlan plan =
        plan_bands_of_spectrum(device_, plan_propagator<float>(grid, 532_nm, distance, params), device_.memory_left());
    const double error = relative_error(banded(field), expected);
    device_.limit_memory(0);
    return {error, plan};
  }
};

HOLOTRACE_FOR_ALL_DEVICES(BandedPropagationTest);

TEST_P(BandedPropagationTest, AgreesWithTheProcessorForAllWindows) {
  for (const double distance : {0.03_m, 2_mm})
    for (const PropagateParams& params : test::all_kinds_of_windows)
      for (const double memory : {memory_for_fields, memory_for_rows}) {
        const Result result = result_in(memory, field_, distance, params);
        EXPECT_LT(result.error, propagation_rounding) << distance << ", " << params.columns << ", " << memory;
        EXPECT_GE(result.plan.bands.size(), 2U);
        EXPECT_EQ(result.plan.has_fields, memory == memory_for_fields) << params.columns;
      }
}

// Lines whose transforms are in global memory: periods of 66 = 2·3·11 and 49 = 7² samples, and of 8640.
TEST_P(BandedPropagationTest, AgreesWithTheProcessorForLinesInGlobalMemory) {
  PropagateParams periodic;
  periodic.is_periodic = true;
  for (const double memory : {memory_for_fields, memory_for_rows}) {
    const Result result = result_in(memory, field_, 0.3_m, periodic);
    EXPECT_LT(result.error, propagation_rounding) << memory;
    EXPECT_GE(result.plan.bands.size(), 2U);
  }
  Field wide({4200, 6, 8_um}, 532_nm);
  for (size_t i = 0; i < wide.samples.size(); ++i) wide.samples.values[i] = field_.samples.values[i % 3234];
  const Result result = result_in(900e3, wide, 0.02_m, {PropagationMethod::fresnel});
  EXPECT_LT(result.error, propagation_rounding);
  EXPECT_GE(result.plan.bands.size(), 3U);  // and two parts
}

// The steps of a convolution, for two bands of each part of the spectrum, give what it gives as a whole: also at a window that
// is displaced by parts of a sample.
TEST_P(BandedPropagationTest, StepsOfAConvolutionAddUp) {
  const auto p = make_propagator<float>(field_.grid, 532_nm, 0.03_m);
  DeviceConvolution convolution(device_, p, {{0.3, -0.45}});
  const auto lock = device_.lock();
  const DeviceConvolution::Work work = convolution.make_work();
  const DeviceBuffer from = device_.upload(field_.samples.values, "a field"),
                     whole = device_.make_buffer(from.bytes(), "a field"),
                     sum = device_.make_buffer(from.bytes(), "a field");
  convolution.to_many(from, {{0, &whole}}, work);
  LineTransforms lines(device_);
  bool adds = false;
  for (int part = 0; part < p.x.parts; ++part) {
    const int all = part_frequencies(p.x, part).count, half = all / 3;
    for (const ColumnBand& band : {ColumnBand{size_t(part), 0, half}, ColumnBand{size_t(part), half, all - half}}) {
      std::vector<std::complex<float>> rows;
      for (const int row : convolution.transfer_rows(band))
        rows.insert(rows.end(), p.transfer.row(row), p.transfer.row(row) + p.transfer.nx);
      const DeviceBuffer transfer = device_.upload(rows, "a transfer function");
      convolution.enter(band, p.y.inputs, from, work.rows);
      lines.transpose(p.y.inputs, band.count, work.rows, work.columns);
      convolution.filter(band, {&transfer, 0, 1, p.transfer.nx}, work.columns, work.filtered);
      lines.transpose(band.count, p.y.outputs, work.filtered, work.rows);
      convolution.leave(band, p.y.outputs, adds, work.rows, sum);
      adds = true;
      device_.finish();
    }
  }
  Field a(field_.grid, 532_nm), b = a;
  device_.read(whole, a.samples.values.data(), whole.bytes());
  device_.read(sum, b.samples.values.data(), sum.bytes());
  EXPECT_LT(relative_error(b, a), propagation_rounding);
}

// `opencl` runs whatever its memory; the fields are those of the processor, and nothing stays on the device.
TEST_P(BandedPropagationTest, IsWhatADeviceOfLittleMemoryDoes) {
  const Field expected = propagate(field_, 0.03_m);
  const Array2D<float> light = propagate_to_irradiance(field_, 0.03_m, {});
  for (const double memory : {memory_for_fields, memory_for_rows}) {
    leave_memory(memory);
    std::string device;
    Observer observer;
    observer.on_fact = [&](const std::string& name, const Fact& value) {
      if (name == "device") device = std::get<std::string>(value);
    };
    const Field there = propagate(field_, 0.03_m, params_, observer);
    EXPECT_LT(relative_error(there, expected), propagation_rounding) << memory;
    EXPECT_EQ(there.z, expected.z);
    EXPECT_EQ(device, device_.info().name);
    EXPECT_EQ(propagate(field_, 0.03_m, params_).samples.values, there.samples.values) << "the same bytes again";
    const Array2D<float> irradiance = propagate_to_irradiance(field_, 0.03_m, params_);
    double error = 0, energy = 0;
    for (size_t i = 0; i < light.size(); ++i) {
      error += std::pow(irradiance.values[i] - light.values[i], 2);
      energy += std::pow(light.values[i], 2);
    }
    EXPECT_LT(std::sqrt(error / energy), 2 * propagation_rounding);
    EXPECT_EQ(held(), 0U);
  }
}

// A propagator that is kept on the device makes room for its own bands if the memory for a field is gone.
TEST_P(BandedPropagationTest, TakesOverFromAKeptPropagator) {
  const Field expected = there(0.03_m);
  const double kept = double(held());
  EXPECT_GT(kept, 0);
  leave_memory(20e3);  // beside it
  EXPECT_LT(relative_error(there(0.03_m), expected), propagation_rounding);
  EXPECT_EQ(held(), 0U);
}

// Fields that fit are sent and fetched once. Each column of the transfer function is sent once: the columns of both parts are
// the frequencies along x, each with the padded period along y.
TEST_P(BandedPropagationTest, SendsFieldsThatFitAndTheTransferFunctionOnce) {
  const auto host = std::make_shared<Propagator<float>>(make_propagator<float>(field_.grid, 532_nm, 0.03_m));
  BandedPropagation banded(device_, host);
  banded(field_);  // sends the roots of its transforms
  leave_memory(memory_for_fields);
  const DeviceUse before = device_.use();
  banded(field_);
  const DeviceUse after = device_.use();
  EXPECT_EQ(after.bytes_in - before.bytes_in, 8U * (66 * 49 + size_t(host->x.frequencies()) * size_t(host->y.padded)));
  EXPECT_EQ(after.bytes_out - before.bytes_out, 8U * 66 * 49);
  EXPECT_EQ(after.bytes_held, before.bytes_held);
}

TEST_P(BandedPropagationTest, DoesWhatIsForecast) {
  for (const PropagateParams& params : test::all_kinds_of_windows)
    for (const double memory : {memory_for_fields, memory_for_rows}) {
      const auto host =
          std::make_shared<Propagator<float>>(make_propagator<float>(field_.grid, 532_nm, 0.03_m, params));
      leave_memory(memory);
      const DeviceUse forecast = forecast_banded_propagation(device_, *host, device_.memory_left());
      EXPECT_LE(double(forecast.most_held), device_.memory_left());
      EXPECT_EQ(forecast.bytes_held, 0U);
      const DeviceUse before = device_.use();
      BandedPropagation(device_, host)(field_);
      const DeviceUse after = device_.use();
      device_.limit_memory(0);
      EXPECT_EQ(after.bytes_moved - before.bytes_moved, forecast.bytes_moved) << params.columns;
      EXPECT_EQ(after.bytes_in - before.bytes_in, forecast.bytes_in);
      EXPECT_EQ(after.bytes_out - before.bytes_out, forecast.bytes_out);
    }
}

TEST_P(BandedPropagationTest, IsTakenByAutoIfItIsFaster) {
  // The processor takes more than 13 s, much more than waiting for transfers
  test::set_processor_rates({.samples = 2e3});
  PropagateParams automatic;
  automatic.device = {DeviceKind::automatic};
  const auto runs_on_device = [&](const DeviceRates& rates) {
    const int number = device_.info().number;
    set_device_rates([=](Device& device) { return device.info().number == number ? rates : DeviceRates(); });
    const size_t before = device_.use().kernels;
    propagate(field_, 0.03_m, automatic);
    return device_.use().kernels > before;
  };
  const auto plan = plan_propagator<float>(field_.grid, 532_nm, 0.03_m, PropagateParams());
  const double seconds = seconds_to_propagate(plan);
  double fewer = 0;  // transfers if the fields are sent once
  for (const double memory : {memory_for_fields, memory_for_rows}) {
    leave_memory(memory);
    const DeviceUse use = forecast_banded_propagation(device_, plan, device_.memory_left());
    const double transfers = double(use.bytes_in + use.bytes_out);
    EXPECT_GT(transfers, fewer + bytes_of_fields(plan)) << "sent for every band";
    fewer = transfers;
    EXPECT_TRUE(runs_on_device({0, 1.1 * transfers / seconds, 1e15})) << memory;
    EXPECT_TRUE(runs_on_device({0, 1.1 * transfers / seconds, 1e15})) << "nothing is kept";
    EXPECT_FALSE(runs_on_device({0, 0.9 * transfers / seconds, 1e15})) << memory;
    device_.limit_memory(0);
  }
}

TEST_P(BandedPropagationTest, WritesNothingPastItsBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  for (const PropagateParams& params : test::all_kinds_of_windows)
    for (const double memory : {memory_for_fields, memory_for_rows}) result_in(memory, field_, 0.03_m, params);
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
}

TEST_P(BandedPropagationTest, ReportsItsProgress) {
  std::vector<double> fractions;
  Observer observer;
  observer.on_progress = [&](double fraction) { fractions.push_back(fraction); };
  BandedPropagation banded(device_,
                           std::make_shared<Propagator<float>>(make_propagator<float>(field_.grid, 532_nm, 0.03_m)));
  leave_memory(memory_for_rows);
  banded(field_, observer);
  EXPECT_GE(fractions.size(), 3U);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_DOUBLE_EQ(fractions.back(), 1);
}

#if HOLOTRACE_HAS_OPENCL

// Some of the calls that may fail, of a hundred with whole fields and of several hundred with some of their rows.
TEST_P(BandedPropagationTest, ReleasesItsMemoryWhereverItFails) {
  struct Case {
    double pitch, memory;
    int step;
  };
  for (const Case& c :
       {Case{0, memory_for_fields, 5}, Case{16_um, memory_for_fields, 5}, Case{0, memory_for_rows, 61}}) {
    PropagateParams params;
    params.pitch = c.pitch;
    const auto host = std::make_shared<Propagator<float>>(make_propagator<float>(field_.grid, 532_nm, 0.03_m, params));
    leave_memory(c.memory);
    EXPECT_GT(test::fail_every(c.step, [&] { BandedPropagation(device_, host)(field_); }), 4);
    device_.limit_memory(0);
  }
}

#endif

}  // namespace
}  // namespace holotrace
