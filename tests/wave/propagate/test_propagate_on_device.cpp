// Propagation on the device that the parameters name: what is transferred, kept, counted and released.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <thread>
#include <vector>

#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/convolve.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/temporary.h"
#include "wave/propagate/propagation_on_devices.h"

namespace holotrace {
namespace {

using namespace literals;
using test::PropagationOnDevices;

constexpr size_t sample = sizeof(std::complex<float>);

HOLOTRACE_FOR_ALL_DEVICES(PropagationOnDevices);

TEST_P(PropagationOnDevices, SendTheTransferFunctionOnce) {
  const size_t fields = sample * 66 * 49;
  EXPECT_EQ(sent_for(0.03_m), fields + forecast(0.03_m).bytes_held);
  EXPECT_EQ(sent_for(0.03_m), fields);
  const size_t before = device_.use().bytes_out;
  propagate_to_irradiance(field_, 0.03_m, params_);
  EXPECT_EQ(device_.use().bytes_out - before, fields / 2) << "a float for each sample";
  EXPECT_GT(sent_for(0.04_m), fields) << "another distance";
  EXPECT_EQ(sent_for(0.03_m), fields) << "kept beside it";
}

TEST_P(PropagationOnDevices, SayTheSameForEveryField) {
  params_.method = PropagationMethod::fresnel;
  const auto said_by = [&](const PropagateParams& params) {
    std::vector<std::string> said;
    Observer observer;
    observer.on_fact = [&](const std::string& name, const Fact& value) {
      said.push_back(name + " = " + (std::holds_alternative<std::string>(value) ? std::get<std::string>(value) : ""));
    };
    observer.on_warning = [&](const std::string& sentence) { said.push_back(sentence); };
    propagate(field_, 2_mm, params, observer);
    return said;
  };
  const std::vector<std::string> first = said_by(params_);
  EXPECT_EQ(said_by(params_), first);
  PropagateParams on_processor = params_;
  on_processor.device = {};
  std::vector<std::string> expected = said_by(on_processor);  // the method, and what Fresnel neglects
  EXPECT_GE(expected.size(), 2U);
  std::erase_if(expected, [](const std::string& text) { return text.starts_with("energy_beyond_band"); });
  expected.push_back("device = " + device_.info().name);
  EXPECT_EQ(first, expected);
}

TEST_P(PropagationOnDevices, KeepWhatFieldsHaveBesideTheirSamples) {
  field_.image = ImageSide::real_image;
  field_.filter = SpectralFilter{1e3, -2e3, 3e4, 4e4};
  field_.label = {"light 1", 3, 450e-9};
  const auto expect_kept = [&](const Field& out, const std::string& how) {
    EXPECT_EQ(out.image, field_.image) << how;
    EXPECT_EQ(out.filter, field_.filter) << how;
    EXPECT_EQ(out.label, field_.label) << how;
  };
  expect_kept(there(0.03_m), "whole");
  expect_kept(fetch(propagate(send(device_, field_, "a field"), 0.03_m, params_)), "on the device");
  PropagateParams shifted = params_;
  shifted.centre_x = 16_um;
  expect_kept(propagate(field_, 0, shifted), "to a shifted window");
  expect_kept(fetch(propagate(send(device_, field_, "a field"), 0, shifted)), "to a shifted window on the device");
  drop_device_propagators();
  leave_memory(40e3);
  expect_kept(there(0.03_m), "in bands");
}

// The memory that is counted is that of the buffers: for windows on the lattice (whose light is even or not), of twice the
// pitch and of any pitch, for square ones, whose axes share factors, and for lines in global memory.
TEST_P(PropagationOnDevices, TakeTheMemoryThatIsCounted) {
  const auto automatic = PropagationMethod::automatic;
  const Grid usual = field_.grid, square{60, 60, 8_um}, wide{4200, 6, 8_um};
  const std::pair<Grid, PropagateParams> cases[] = {{usual, {}},
                                                    {usual, {automatic, 75, 40, 0, 30_um, -16_um}},
                                                    {usual, {automatic, 31, 40, 16_um}},
                                                    {usual, {automatic, 101, 64, 5.3217_um, 40_um, -90_um}},
                                                    {square, {}},
                                                    {square, {automatic, 60, 60, 7_um}},
                                                    {wide, {PropagationMethod::fresnel}}};
  for (const auto& [grid, window] : cases) {
    drop_device_propagators();
    field_ = Field(grid, 532_nm);
    const DeviceChoice device = params_.device;
    params_ = window;
    params_.device = device;
    there(0.03_m);
    const DeviceUse use = forecast(0.03_m, window);
    EXPECT_EQ(held(), use.bytes_held) << grid.nx << ", " << window.columns;
    const auto sent_for_irradiance = [&] {
      const size_t before = device_.use().bytes_in;
      propagate_to_irradiance(field_, 0.03_m, params_);
      return device_.use().bytes_in - before;
    };
    sent_for_irradiance();  // compiles its kernel
    const size_t of_field = sample * size_t(grid.pixels());
    leave_memory(double(use.most_released()));
    EXPECT_EQ(sent_for_irradiance(), of_field) << grid.nx << ", " << window.columns;
    leave_memory(double(use.most_released()) - 8);
    EXPECT_GT(sent_for_irradiance(), of_field) << "in bands, with the transfer function: " << grid.nx;
    device_.limit_memory(0);
  }
}

// A propagation moves and sends what is forecast, for all windows, and with lines that local memory does not hold (periods of
// 66 = 2·3·11 and 49 = 7² samples).
TEST_P(PropagationOnDevices, DoWhatIsForecast) {
  std::vector<PropagateParams> windows(std::begin(test::all_kinds_of_windows), std::end(test::all_kinds_of_windows));
  windows.emplace_back().is_periodic = true;
  for (const PropagateParams& window : windows) {
    const DeviceChoice device = params_.device;
    params_ = window;
    params_.device = device;
    const DeviceUse forecast = this->forecast(0.03_m, window);
    there(0.03_m);  // sends the transfer function
    const DeviceUse before = device_.use();
    there(0.03_m);
    const DeviceUse after = device_.use();
    EXPECT_EQ(after.bytes_moved - before.bytes_moved, forecast.bytes_moved) << window.columns;
    EXPECT_EQ(double(after.bytes_in + after.bytes_out - before.bytes_in - before.bytes_out),
              bytes_of_fields(plan(0.03_m, window)))
        << window.columns;
  }
}

// Each part of the spectrum along x reads the input; of each of its columns, the spectrum is written, transposed, read by each
// part along y with its transfer function, and added up, transposed and read; the output is written, and by the second part read
// as well. The factors of lines of 200 samples are a few percent of that.
TEST_P(PropagationOnDevices, CountWhatTheirKernelsReadAndWrite) {
  const auto plan = plan_propagator<float>({200, 180, 8_um}, 532_nm, 0.3_m, {});
  ASSERT_EQ(plan.x.parts, 2);
  const double in = 200.0 * 180, rows = 180, parts = plan.y.parts;
  const double of_column = (3 + parts) * rows + plan.y.padded + (2 * parts - 1) * rows + 3 * rows;
  const double samples = 2 * in + plan.x.frequencies() * of_column + 3 * in;
  const DeviceUse use = forecast_propagation(device_, plan);
  EXPECT_NEAR(double(use.bytes_moved), 8 * samples, 0.04 * 8 * samples);
  // Both fields, and a part of the spectrum row by row, and column by column before and after the transfer function.
  const double columns = std::max(part_frequencies(plan.x, 0).count, part_frequencies(plan.x, 1).count);
  EXPECT_EQ(double(use.most_released()), 8 * (2 * in + 3 * rows * columns));
  EXPECT_EQ(double(use.largest_buffer), 8.0 * plan.transfer_rows() * plan.transfer_columns());
}

// White light of all frequencies: every row is transformed twice for each part along x (there and back), every column of
// each part twice for each part along y.
TEST(PropagationWork, CountsTheTransforms) {
  const auto plan = plan_propagator<float>({256, 120, 8_um}, 532_nm, 0.3_m, {});  // a kernel: all frequencies
  ASSERT_EQ(plan.x.frequencies(), plan.padded_nx);
  const double x = plan.padded_nx, y = plan.padded_ny, nx = x / plan.x.parts, ny = y / plan.y.parts;
  const double rows = 2 * 120 * x * std::log2(nx), columns = 2 * x * y * std::log2(ny);
  EXPECT_NEAR(propagation_work(plan).fft_operations, 5 * (rows + columns), 1e-6 * columns);
  // At another pitch: one transform of a row, one of a column, and a convolution with a chirp along each.
  const auto scaled =
      plan_propagator<float>({256, 120, 8_um}, 532_nm, 0.3_m, {PropagationMethod::automatic, 256, 120, 7_um});
  EXPECT_GT(propagation_work(scaled).fft_operations, propagation_work(plan).fft_operations);
  EXPECT_LT(propagation_work(scaled).fft_operations, 6 * propagation_work(plan).fft_operations);
}

TEST_P(PropagationOnDevices, KeepWhatIsWithinTheLimit) {
  there(0.03_m);
  const size_t one = held();
  limit_device_propagators(2.5 * double(one));
  there(0.04_m);
  EXPECT_GE(held(), 2 * one - 100);  // bands of nearly the same width
  there(0.03_m);
  there(0.05_m);  // drops 0.04 m, which was used least recently
  EXPECT_LE(double(held()), 2.5 * double(one));
  EXPECT_EQ(sent_for(0.03_m), sample * 66 * 49);
  EXPECT_GT(sent_for(0.04_m), sample * 66 * 49);
  limit_device_propagators(1.5 * double(one));
  EXPECT_LE(double(held()), 1.5 * double(one)) << "dropped at once";
  EXPECT_GT(held(), 0U);
  limit_device_propagators(0);
  EXPECT_EQ(held(), 0U);
  there(0.03_m);
  EXPECT_EQ(held(), 0U);
}

TEST_P(PropagationOnDevices, MakeRoomForOthers) {
  there(0.03_m);
  there(0.04_m);
  const size_t two = held();
  const DeviceUse one = forecast(0.04_m);
  // Memory for a field, if the other propagator is dropped.
  device_.limit_memory(double(start_ + one.most_held) / 0.8 + 1);
  EXPECT_EQ(sent_for(0.04_m), sample * 66 * 49);
  EXPECT_LT(held(), two);
  EXPECT_EQ(sent_for(0.04_m), sample * 66 * 49) << "it stays";
  EXPECT_EQ(error_of([&] { there(0.03_m); }), "no error") << "the other way round";
  EXPECT_EQ(held(), forecast(0.03_m).bytes_held);
}

TEST_P(PropagationOnDevices, SayThatMemoryIsShort) {
  leave_memory(5e3);  // less than the factors and a column of the spectrum
  const std::string error = error_of([&] { there(0.03_m); });
  EXPECT_NE(error.find("of memory for a propagation on the device " + device_.info().name), std::string::npos) << error;
  EXPECT_EQ(held(), 0U);
  device_.limit_memory(0);
  EXPECT_EQ(error_of([&] { there(0.03_m); }), "no error");
}

TEST_P(PropagationOnDevices, WriteNothingPastTheirBuffers) {
  const size_t before = device_.broken_guards();
  device_.guard_buffers(true);
  for (const double pitch : {0.0, 5.3_um}) {
    params_.pitch = pitch;
    there(0.03_m);
    propagate_to_irradiance(field_, 0.03_m, params_);  // 3234 samples: not whole groups
  }
  drop_device_propagators();
  device_.guard_buffers(false);
  EXPECT_EQ(device_.broken_guards(), before);
  EXPECT_EQ(held(), 0U);
}

TEST_P(PropagationOnDevices, MayBeAskedFromManyThreads) {
  const Field expected = there(0.03_m);
  limit_device_propagators(1.5 * double(held()));  // others are dropped all the time
  std::vector<Field> results(12);
  std::vector<std::thread> threads;
  for (size_t t = 0; t < results.size(); ++t)
    threads.emplace_back([&, t] {
      results[t] = there(t % 2 ? 0.03_m : 0.02_m + double(t) * 1_mm);
      if (t % 4 == 0) drop_device_propagators();
    });
  for (std::thread& thread : threads) thread.join();
  for (size_t t = 1; t < results.size(); t += 2) EXPECT_EQ(results[t].samples.values, expected.samples.values);
}

TEST_P(PropagationOnDevices, RefuseDoublePrecision) {
  const FieldDouble field = convert<double>(field_);
  EXPECT_EQ(error_of([&] { propagate(field, 0.03_m, params_); }),
            "expected a field in single precision to propagate on an OpenCL device, got one in double precision; use "
            "the device cpu, or leave out --double (in Python: a complex64 array)");
  params_.device.kind = DeviceKind::automatic;
  EXPECT_EQ(propagate(field, 0.03_m, params_).samples.values, propagate(field, 0.03_m).samples.values);
}

TEST(PropagationOnNoDevice, IsAnError) {
  const Field field({8, 8, 8_um}, 532_nm);
  PropagateParams params;
  params.device = {DeviceKind::opencl, 1000};
  EXPECT_NE(error_of([&] { propagate(field, 0.03_m, params); }), "no error");
}

}  // namespace
}  // namespace holotrace
