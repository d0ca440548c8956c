#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "holotrace/opencl/device.h"
#include "support/devices.h"
#include "support/faulty_api.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::FaultyApi;

class Devices : public test::OnEveryDevice {};

HOLOTRACE_FOR_ALL_DEVICES(Devices);

// values[i] = factor·values[i] + i, and past the end of the buffer if `count` says so.
const Kernel scale{"scale",
                   {"__kernel void scale(__global float* values, float factor, int count) {\n",
                    "  const int i = get_global_id(0);\n  if (i < count) values[i] = factor * values[i] + i;\n}\n"}};

std::vector<float> numbers(int count) {
  std::vector<float> values(size_t(count), 0);
  std::iota(values.begin(), values.end(), 0.0F);
  return values;
}

TEST_P(Devices, RunKernelsOnTheirMemory) {
  std::vector<float> values = numbers(64);
  const DeviceUse before = device_.use();
  {
    const DeviceBuffer buffer = device_.upload(values, "numbers");
    device_.run(scale, {4, 1, 16, 1}, {buffer, 2.0F, 64});
    device_.run(scale, {4, 1, 16, 1}, {buffer, 1.0F, 64});  // after the first: 2i + i, then + i
    device_.read(buffer, values.data(), buffer.bytes());
    EXPECT_EQ(device_.use().bytes_held - before.bytes_held, 256u);
  }
  for (int i = 0; i < 64; ++i) EXPECT_EQ(values[size_t(i)], 4.0F * float(i));
  EXPECT_EQ(device_.use().bytes_held, before.bytes_held);
  EXPECT_EQ(device_.use().bytes_in - before.bytes_in, 256u);
  EXPECT_EQ(device_.use().bytes_out - before.bytes_out, 256u);
  EXPECT_EQ(device_.use().kernels - before.kernels, 2u);
}

// A device that only counts has the use of the one that it forecasts, which it leaves alone: no kernel runs, what is read stays as
// it was, and what is fetched are ones. It never lacks memory, but tells how much there is.
TEST_P(Devices, AreForecastByOneThatOnlyCounts) {
  Device counter(device_.info(), 1000);
  const DeviceUse before = device_.use();
  const auto work = [](Device& device) {
    std::vector<float> values = numbers(64);
    const DeviceBuffer one = device.upload(values, "numbers"), other = device.make_buffer(100, "numbers");
    device.run(scale, {4, 1, 16, 1}, {KernelArgument::changed(one), 2.0F, 64});
    device.run(scale, {1, 1, 16, 1}, {KernelArgument::moving(one, 48), 2.0F, 6});
    device.run(scale, {1, 1, 16, 1}, {other, 2.0F, 16});
    device.read(one, values.data(), 128);
    device.finish();
    return std::pair(values, device.fetch<float>(other));
  };
  const auto [read, fetched] = work(counter);
  EXPECT_EQ(read, numbers(64));
  EXPECT_EQ(fetched, std::vector<float>(25, 1));
  const DeviceUse forecast = counter.use();
  EXPECT_EQ(forecast.bytes_moved, 2u * 256 + 48 + 100);
  EXPECT_EQ(forecast.most_held, 356u);
  EXPECT_EQ(forecast.largest_buffer, 256u);
  EXPECT_EQ(forecast.bytes_held, 0u);
  EXPECT_EQ(device_.use().kernels, before.kernels);
  EXPECT_NE(work(device_).first, numbers(64));
  const DeviceUse after = device_.use();
  EXPECT_EQ(after.kernels - before.kernels, forecast.kernels);
  EXPECT_EQ(after.bytes_moved - before.bytes_moved, forecast.bytes_moved);
  EXPECT_EQ(after.bytes_in - before.bytes_in, forecast.bytes_in);
  EXPECT_EQ(after.bytes_out - before.bytes_out, forecast.bytes_out);
  EXPECT_EQ(after.transfers - before.transfers, forecast.transfers);
  const DeviceBuffer large = counter.make_buffer(5000, "numbers");
  EXPECT_DOUBLE_EQ(counter.memory(), 1000);
  EXPECT_DOUBLE_EQ(counter.memory_left(), -4000);
}

// More groups along y and z than some makers' devices take at once are started in two parts: each place gets its work once.
TEST_P(Devices, StartManyGroupsInParts) {
  const Kernel count{"count",
                     {"__kernel void count(int ny, __global int* times) {\n"
                      "  if (get_local_id(0) == 0) ++times[get_global_id(2) * ny + get_global_id(1)];\n}\n"}};
  constexpr size_t many = most_groups_across + 3;
  for (const auto& [size, parts] : {std::pair{WorkSize{1, many, 2, 1, 2}, 2}, std::pair{WorkSize{1, 2, 1, 3, many}, 2},
                                    std::pair{WorkSize{1, most_groups_across, 1, 1, 1}, 1}}) {
    const int rows = int(size.groups_y * size.group_y);
    std::vector<int> times(size_t(rows) * size.groups_z);
    const DeviceBuffer there = device_.upload(times, "counts");
    FaultyApi api;
    device_.run(count, size, {rows, there});
    EXPECT_EQ(api.calls, parts);
    device_.read(there, times.data(), there.bytes());
    EXPECT_EQ(std::count(times.begin(), times.end(), 1), std::ptrdiff_t(times.size()));
  }
}

TEST_P(Devices, FindWritesPastTheEndsOfBuffers) {
  device_.guard_buffers(true);
  const size_t before = device_.broken_guards();
  {
    const DeviceBuffer buffer = device_.upload(numbers(64), "numbers");
    device_.run(scale, {4, 1, 16, 1}, {buffer, 2.0F, 64});
  }
  EXPECT_EQ(device_.broken_guards(), before);
  {
    const DeviceBuffer buffer = device_.upload(numbers(63), "numbers");
    device_.run(scale, {4, 1, 16, 1}, {buffer, 2.0F, 64});
  }
  EXPECT_EQ(device_.broken_guards(), before + 1);
  device_.guard_buffers(false);
}

// Whichever call fails, what was made is released, once, and the device works afterwards.
TEST_P(Devices, ReleaseTheirMemoryOnEveryWayOut) {
  device_.run(scale, {1, 1, 1, 1}, {device_.upload(numbers(1), "numbers"), 1.0F, 1});  // compiled before calls fail
  for (const bool has_guards : {false, true}) {
    device_.guard_buffers(has_guards);
    int failed = 0;
    for (bool is_done = false; !is_done;) {
      FaultyApi api;
      api.failing = failed;
      const std::string error = error_of([&] {
        DeviceBuffer buffer = device_.upload(numbers(64), "numbers");
        device_.run(scale, {4, 1, 16, 1}, {buffer, 2.0F, 64});
        device_.finish();
        buffer = device_.upload(numbers(32), "numbers");
        std::vector<float> values(32);
        device_.read(buffer, values.data(), buffer.bytes());
      });
      is_done = api.calls <= failed;
      EXPECT_TRUE(has_guards || (error == "no error") == is_done) << error;  // a guard that cannot be read is no error
      EXPECT_TRUE(api.held.empty()) << "after the failure of call " << failed;
      EXPECT_FALSE(api.was_released_twice);
      EXPECT_EQ(device_.use().buffers, 0u);
      EXPECT_EQ(device_.use().bytes_held, 0u);
      ++failed;
    }
    EXPECT_GE(failed, 7) << "two buffers, two writes, a kernel, a wait and a read can fail";
  }
  device_.guard_buffers(false);
}

TEST_P(Devices, SayInOneSentenceWhatFailed) {
  const std::string name = device_.info().name;
  const auto error_at = [&](int call) {
    FaultyApi api;
    api.failing = call;
    return error_of([&] {
      const DeviceBuffer buffer = device_.upload(numbers(64), "the waves");
      device_.run(scale, {4, 1, 16, 1}, {buffer, 2.0F, 64});
      device_.finish();
    });
  };
  EXPECT_EQ(error_at(0),
            "expected 256 B of memory for the waves on the device " + name +
                ", got CL_MEM_OBJECT_ALLOCATION_FAILURE; use a smaller panel or fewer waves, or the device cpu");
  const std::string end = "; it may have been reset or be out of memory; run again, or use the device cpu";
  EXPECT_EQ(error_at(1), "the device " + name + " stopped during a transfer: CL_DEVICE_NOT_AVAILABLE" + end);
  EXPECT_EQ(error_at(2), "the device " + name + " stopped during scale: error -9999 of OpenCL" + end);
  EXPECT_EQ(error_at(3), "the device " + name + " stopped during its kernels: CL_OUT_OF_RESOURCES" + end);
}

TEST_P(Devices, RefuseMoreMemoryThanIsFree) {
  device_.limit_memory(1000);  // of which 80 % may be used
  EXPECT_EQ(error_of([&] { device_.make_buffer(801, "a field"); }),
            "expected 801 B of memory for a field on the device " + device_.info().name +
                ", got 800 B that are free; use a smaller panel or fewer waves, or the device cpu");
  const DeviceBuffer buffer = device_.make_buffer(300, "a field");
  EXPECT_EQ(device_.free_memory(), 500);
  device_.limit_memory(0);
}

TEST_P(Devices, RefuseABufferAboveTheLargestOfTheDevice) {
  device_.limit_memory(4 * device_.info().largest_buffer);  // memory enough
  EXPECT_EQ(device_.free_memory(), device_.info().largest_buffer);
  device_.limit_memory(0);
}

TEST_P(Devices, KeepTheMessagesOfACompilerThatRefusesAKernel) {
  std::string log;
  set_program_store({{}, {}, [&](const std::string& text) {
                       log = text;
                       return std::string("the.log");
                     }});
  const Kernel broken{"broken",
                      {"__kernel void broken(__global float* x) {\n  x[0] = unknown_name;\n  x[1] = other_name;\n}\n"}};
  const std::string error = error_of([&] { device_.run(broken, {}, {}); });
  set_program_store({});
  EXPECT_EQ(error.rfind("expected the driver of the device " + device_.info().name +
                            " to compile the kernel broken, got CL_BUILD_PROGRAM_FAILURE: \"",
                        0),
            0u)
      << error;
  EXPECT_NE(error.find("(all messages are in the.log); update the driver, or use the device cpu"), std::string::npos)
      << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  EXPECT_NE(log.find("unknown_name"), std::string::npos) << log;
  EXPECT_NE(log.find("other_name"), std::string::npos) << log;
}

TEST_P(Devices, TakeCompiledProgramsFromTheStoreAndCompileDamagedOnesAgain) {
  std::map<std::string, std::string> kept;
  int loads = 0;
  set_program_store({[&](const std::string& key) -> std::optional<std::string> {
                       ++loads;
                       const auto found = kept.find(key);
                       return found == kept.end() ? std::nullopt : std::optional(found->second);
                     },
                     [&](const std::string& key, const std::string& binary) { kept[key] = binary; },
                     {}});
  const auto doubled = [&](Device& device) {
    std::vector<float> values = numbers(16);
    const DeviceBuffer buffer = device.upload(values, "numbers");
    device.run(scale, {1, 1, 16, 1}, {buffer, 1.0F, 16});
    device.read(buffer, values.data(), buffer.bytes());
    return values[15];
  };
  DeviceInfo info = device_.info();
  const auto fresh = [&] { return std::make_unique<Device>(info); };  // it has compiled nothing yet
  EXPECT_EQ(doubled(*fresh()), 30.0F);
  ASSERT_EQ(kept.size(), 1u);
  const std::string binary = kept.begin()->second;
  const OpenClApi true_api = opencl_api();
  opencl_api().clCreateProgramWithSource = [](auto...) -> cl_program { return nullptr; };  // it may not compile
  EXPECT_EQ(doubled(*fresh()), 30.0F);
  opencl_api() = true_api;
  EXPECT_EQ(loads, 2);
  kept.begin()->second = "damaged";
  EXPECT_EQ(doubled(*fresh()), 30.0F);
  EXPECT_EQ(kept.begin()->second, binary);
  for (std::string DeviceInfo::*part : {&DeviceInfo::driver, &DeviceInfo::name, &DeviceInfo::platform}) {
    const size_t before = kept.size();
    info.*part += " 2";
    EXPECT_EQ(doubled(*fresh()), 30.0F);
    EXPECT_EQ(kept.size(), before + 1) << "a program of another device or driver was taken";
  }
  set_program_store({});
}

TEST(DeviceList, SharesDevicesOfOneModelAmongRanks) {
  const auto device = [](int number, const char* name, const char* driver) {
    DeviceInfo info;
    info.number = number;
    info.name = name;
    info.driver = driver;
    return info;
  };
  const std::vector<DeviceInfo> devices{device(0, "A", "1"), device(1, "B", "1"), device(2, "A", "1"),
                                        device(3, "A", "2"), device(4, "A", "1")};
  const auto of_ranks = [&](int number) {
    std::vector<int> numbers;
    for (int rank = 0; rank < 4; ++rank) numbers.push_back(equal_device(devices, number, rank));
    return numbers;
  };
  EXPECT_EQ(of_ranks(0), (std::vector<int>{0, 2, 4, 0}));
  EXPECT_EQ(of_ranks(2), (std::vector<int>{2, 4, 0, 2}));
  EXPECT_EQ(of_ranks(1), (std::vector<int>{1, 1, 1, 1}));
  EXPECT_EQ(of_ranks(3), (std::vector<int>{3, 3, 3, 3}));
  EXPECT_EQ(equal_device(devices, 9, 1), 9);  // refused when it is opened
  EXPECT_EQ(equal_devices(devices, 2), (std::vector<int>{0, 2, 4}));
  EXPECT_EQ(equal_devices(devices, 3), std::vector<int>{3});
  // Parts of a card share its name; the slices of a sum, and so its bytes, depend on the compute units.
  std::vector<DeviceInfo> parts = devices;
  parts[2].compute_units = parts[0].compute_units + 1;
  EXPECT_EQ(equal_devices(parts, 0), (std::vector<int>{0, 4}));
  EXPECT_NE(error_of([&] { equal_devices(devices, 9); }).find("from 0 to 4, got 9"), std::string::npos);
}

TEST(DeviceList, RefusesNumbersOfNoDevice) {
  const size_t count = test::device_numbers().size();
  if (count == 0) GTEST_SKIP() << "no OpenCL device here";
  EXPECT_EQ(error_of([&] { open_device(int(count)); }),
            fmt::format("expected the number of a device from 0 to {}, got {}; holotrace info --devices lists them",
                        count - 1, count));
}

// Each of them leads to the advice to use less memory, or to bands.
TEST(OpenClStatus, FourMeanThatMemoryDoesNotSuffice) {
  for (const cl_int status :
       {CL_MEM_OBJECT_ALLOCATION_FAILURE, CL_OUT_OF_RESOURCES, CL_OUT_OF_HOST_MEMORY, CL_INVALID_BUFFER_SIZE})
    EXPECT_TRUE(is_out_of_memory(status)) << status_name(status);
  for (const cl_int status : {CL_SUCCESS, CL_INVALID_VALUE, CL_BUILD_PROGRAM_FAILURE, CL_DEVICE_NOT_AVAILABLE})
    EXPECT_FALSE(is_out_of_memory(status)) << status_name(status);
}

}  // namespace
}  // namespace holotrace
