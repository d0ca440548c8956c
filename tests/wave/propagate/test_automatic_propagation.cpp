// How `auto` chooses between the processor and devices for a propagation, with rates that are made up, and what it does when
// a device fails.

#include <gtest/gtest.h>

#include "holotrace/base/units.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/build_paths.h"
#include "support/temporary.h"
#include "wave/propagate/propagation_on_devices.h"
#if HOLOTRACE_HAS_OPENCL
#include "support/faulty_api.h"
#endif

namespace holotrace {
namespace {

using namespace literals;
using test::PropagationOnDevices;

class AutomaticPropagation : public PropagationOnDevices {
 protected:
  AutomaticPropagation() {
    params_.device = {DeviceKind::automatic};
    // The processor takes more than 66 · 49 · 8 samples / 2e3 = 13 s: waiting for the transfers of many bands takes less.
    test::set_processor_rates({.samples = 2e3});
  }
  void give_devices(const DeviceRates& rates) {
    const int number = device_.info().number;
    set_device_rates([=](Device& device) { return device.info().number == number ? rates : DeviceRates(); });
  }
  bool runs_on_device() const {
    const size_t before = device_.use().kernels;
    there(0.03_m);
    return device_.use().kernels > before;
  }
};

HOLOTRACE_FOR_ALL_DEVICES(AutomaticPropagation);

TEST_P(AutomaticPropagation, TakesTheFasterOne) {
  const double moved = double(forecast(0.03_m).bytes_moved);
  const double seconds =
      seconds_to_propagate(plan_propagator<float>(field_.grid, field_.wavelength, 0.03_m, PropagateParams()));
  give_devices({0, 1e12, 1.1 * moved / seconds});
  EXPECT_TRUE(runs_on_device());
  give_devices({0, 1e12, 0.9 * moved / seconds});
  EXPECT_FALSE(runs_on_device());
  give_devices({});
  EXPECT_FALSE(runs_on_device()) << "not measured";
}

TEST_P(AutomaticPropagation, CountsTransfers) {
  const double fields = bytes_of_fields(plan(0.03_m)), kept = double(forecast(0.03_m).bytes_held);
  const double seconds =
      seconds_to_propagate(plan_propagator<float>(field_.grid, field_.wavelength, 0.03_m, PropagateParams()));
  give_devices({0, 0.9 * fields / seconds, 1e15});
  EXPECT_FALSE(runs_on_device());
  give_devices({0, (fields + 0.9 * kept) / seconds, 1e15});
  EXPECT_FALSE(runs_on_device()) << "with the transfer function";
  PropagateParams on_device;
  on_device.device = {DeviceKind::opencl, device_.info().number};
  propagate(field_, 0.03_m, on_device);
  EXPECT_TRUE(runs_on_device()) << "which is there now";
}

TEST_P(AutomaticPropagation, KeepsToTheProcessorForFieldsInDouble) {
  give_devices({0, 1e15, 1e15});
  const size_t before = device_.use().kernels;
  propagate(convert<double>(field_), 0.03_m, params_);
  EXPECT_EQ(device_.use().kernels, before);
  EXPECT_TRUE(runs_on_device());
}

TEST_P(AutomaticPropagation, GoesOnWithTheProcessorIfMemoryIsShort) {
  give_devices({0, 1e15, 1e15});
  leave_memory(5e3);  // less than the factors and a column of the spectrum
  std::string warning;
  Observer observer;
  observer.on_warning = [&](const std::string& text) { warning = text; };
  EXPECT_EQ(propagate(field_, 0.03_m, params_, observer).samples.values, propagate(field_, 0.03_m).samples.values);
  EXPECT_EQ(warning.rfind("the device auto: the processor took over, because expected ", 0), 0U) << warning;
  EXPECT_EQ(held(), 0U);
  EXPECT_EQ(propagate_to_irradiance(field_, 0.03_m, params_).values,
            propagate_to_irradiance(field_, 0.03_m, {}).values);
}

// A field beside the window is an error of the question, not of the device.
TEST_P(AutomaticPropagation, DoesNotWarnOfWrongQuestions) {
  give_devices({0, 1e15, 1e15});
  params_.centre_x = 1_m;
  Observer observer;
  observer.on_warning = [](const std::string& text) { ADD_FAILURE() << text; };
  EXPECT_NE(error_of([&] { propagate(field_, 0.03_m, params_, observer); }), "no error");
}

#if HOLOTRACE_HAS_OPENCL

// Whichever call of the driver fails: `opencl` says so, `auto` gives the processor's field, and nothing stays on the device.
TEST_P(AutomaticPropagation, OutlivesFaults) {
  give_devices({0, 1e15, 1e15});
  const Field expected = propagate(field_, 0.03_m);
  PropagateParams on_device;
  on_device.device = {DeviceKind::opencl, device_.info().number};
  for (const PropagateParams& params : {params_, on_device}) {
    bool is_done = false;
    for (int failing = 0; !is_done; ++failing) {
      std::string warning, error;
      Observer observer;
      observer.on_warning = [&](const std::string& text) { warning = text; };
      {
        test::FaultyApi api;
        api.failing = failing;
        Field found;
        error = error_of([&] { found = propagate(field_, 0.03_m, params, observer); });
        is_done = api.calls <= failing;
        EXPECT_EQ(error == "no error", is_done || params.device.kind == DeviceKind::automatic) << failing << error;
        EXPECT_EQ(warning.empty(), is_done || params.device.kind == DeviceKind::opencl) << failing << warning;
        if (!warning.empty()) {
          EXPECT_EQ(found.samples.values, expected.samples.values) << failing;
        }
        if (is_done) drop_device_propagators();
        EXPECT_TRUE(api.held.empty()) << failing;
        EXPECT_FALSE(api.was_released_twice) << failing;
      }
      EXPECT_EQ(held(), 0U) << failing;
    }
  }
}

#endif

}  // namespace
}  // namespace holotrace
