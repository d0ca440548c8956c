// What every stage that runs on OpenCL devices does in the same way: its bytes, its choice of a device, what it says.

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/panel/show.h"
#include "slm/encode/iterate/descents_on_devices.h"
#include "support/build_paths.h"
#include "support/panels.h"

namespace holotrace {
namespace {

using Bytes = std::vector<unsigned char>;

template <class Values>
Bytes bytes_of(const Values& values) {
  Bytes bytes(values.size() * sizeof values[0]);
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

// A stage with some input: what it returns on a device.
struct Stage {
  const char* name;
  std::function<Bytes(const DeviceChoice& device, const Observer& observer)> run;
  double short_memory;  // in which it does not fit [bytes]
};

const Slm panel = make_panel(48, 36);

Bytes encoded(EncodeParams params, const DeviceChoice& device, const Observer& observer) {
  params.device = device;
  const Field field = random_field(panel.grid, 6);
  if (params.method == Encoding::phase) return bytes_of(encode(field, panel, params, observer).level.values);
  return bytes_of(encode_targets(picture_targets(panel, params), field, panel, params, observer).level.values);
}

Bytes shown(const DeviceChoice& device, const Observer& observer) {
  const Hologram hologram = make_hologram(panel, Modulation::phase, [](int i) { return 7 * i % 200; });
  ShowParams params;
  params.device = device;
  return bytes_of(show(hologram, panel, params, {.wavelength = test_wavelength}, observer).samples.values);
}

Bytes four_frames(const DeviceChoice& device, const Observer& observer) {
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.006, 0.009}, .iterations = 3};
  params.device = device;
  Bytes all;
  for (const Hologram& frame :
       encode_frames({picture_targets(panel, params)}, test_wavelength, 4, panel, params, observer)) {
    const Bytes one = bytes_of(frame.level.values);
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

const std::vector<Stage> stages{
    {"phase",
     [](const DeviceChoice& device, const Observer& observer) {
       return encoded({.method = Encoding::phase}, device, observer);
     },
     500},
    {"gerchberg_saxton",
     [](const DeviceChoice& device, const Observer& observer) {
       return encoded({.method = Encoding::gerchberg_saxton, .target_distances = {0.006, 0.009}, .iterations = 3},
                      device, observer);
     },
     20e3},
    {"sgd",
     [](const DeviceChoice& device, const Observer& observer) {
       return encoded({.method = Encoding::sgd, .target_distances = {0.006}, .iterations = 3}, device, observer);
     },
     20e3},
    {"sgd_of_four_frames", four_frames, 20e3},
    {"show", shown, 1e3}};

class StagesOnADevice : public test::StagesOnDevices {
 protected:
  DeviceChoice named() const { return {DeviceKind::opencl, device_.info().number}; }

  bool uses_device(const Stage& stage, const DeviceChoice& choice) const {
    const size_t before = device_.use().kernels;
    stage.run(choice, {});
    return device_.use().kernels > before;
  }
};

const DeviceChoice cpu{DeviceKind::cpu}, fastest{DeviceKind::automatic};

HOLOTRACE_FOR_ALL_DEVICES(StagesOnADevice);

TEST_P(StagesOnADevice, GiveTheSameBytesForTheSameInput) {
  for (const Stage& stage : stages) EXPECT_EQ(stage.run(named(), {}), stage.run(named(), {})) << stage.name;
}

TEST_P(StagesOnADevice, AreDoneByTheFasterOne) {
  for (const Stage& stage : stages) {
    SCOPED_TRACE(stage.name);
    make_device_fast(1e15);
    EXPECT_TRUE(uses_device(stage, fastest));
    EXPECT_FALSE(uses_device(stage, cpu));
    make_device_fast(1e-3);
    EXPECT_FALSE(uses_device(stage, fastest));
    set_device_rates({});
    EXPECT_FALSE(uses_device(stage, fastest)) << "not measured";
    EXPECT_TRUE(uses_device(stage, named()));
    EXPECT_FALSE(uses_device(stage, {})) << "the processor is the default";
  }
}

TEST_P(StagesOnADevice, SayWhichDeviceDidThem) {
  for (const Stage& stage : stages) {
    std::vector<std::string> names;
    Observer observer;
    observer.on_fact = [&](const std::string& name, const Fact& value) {
      if (name == "device") names.push_back(std::get<std::string>(value));
    };
    stage.run(named(), observer);
    stage.run(cpu, observer);
    EXPECT_EQ(names, std::vector<std::string>{device_.info().name}) << stage.name;
  }
}

// A named device says that memory is short; `auto` knows it, and takes the processor.
TEST_P(StagesOnADevice, SayThatMemoryIsShort) {
  make_device_fast(1e15);
  for (const Stage& stage : stages) {
    SCOPED_TRACE(stage.name);
    device_.limit_memory((double(device_.use().bytes_held) + stage.short_memory) / 0.8);
    const std::string error = error_of([&] { stage.run(named(), {}); });
    EXPECT_EQ(error.rfind("expected ", 0), 0u) << error;
    EXPECT_NE(error.find("memory for "), std::string::npos) << error;
    EXPECT_NE(error.find(" on the device " + device_.info().name), std::string::npos) << error;
    Heard heard;
    EXPECT_EQ(stage.run(fastest, heard.observer()), stage.run(cpu, {}));
    EXPECT_TRUE(heard.warnings.empty());
    EXPECT_EQ(heard.facts.count("device"), 0u);
  }
}

TEST(StagesOnNoDevice, AreErrors) {
  for (const Stage& stage : stages)
    EXPECT_NE(error_of([&] { stage.run({DeviceKind::opencl, 1000}, {}); }), "no error") << stage.name;
}

}  // namespace
}  // namespace holotrace
