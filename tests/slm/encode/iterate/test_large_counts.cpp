// The pixel loops of iterations count from 2³¹ samples on. A test machine has no such memory: functions of OpenCL are replaced
// that note what is asked of them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "holotrace/slm/encode/iterate/device_loops.h"
#include "support/build_paths.h"
#include "support/devices.h"
#if HOLOTRACE_HAS_OPENCL
#include "holotrace/opencl/api.h"
#endif

namespace holotrace {
namespace {

#if HOLOTRACE_HAS_OPENCL
// Makes small buffers for large ones, and starts no kernels.
class NotingApi {
 public:
  NotingApi() : true_api_(opencl_api()) {
    self = this;
    OpenClApi& api = opencl_api();
    api.clCreateBuffer = [](cl_context context, cl_mem_flags flags, size_t, void* host, cl_int* status) {
      return self->true_api_.clCreateBuffer(context, flags, 64, host, status);
    };
    api.clSetKernelArg = [](cl_kernel, cl_uint index, size_t bytes, const void* value) -> cl_int {
      if (index == 0) {
        self->count = 0;
        std::memcpy(&self->count, value, std::min(bytes, sizeof self->count));
      }
      return CL_SUCCESS;
    };
    api.clEnqueueNDRangeKernel = [](cl_command_queue, cl_kernel, cl_uint, const size_t*, const size_t* all,
                                    const size_t*, cl_uint, const cl_event*, cl_event*) -> cl_int {
      self->items = all[0];
      return CL_SUCCESS;
    };
  }
  ~NotingApi() { opencl_api() = true_api_; }
  NotingApi(const NotingApi&) = delete;

  uint64_t count = 0;  ///< of the kernel that was started last: its first argument
  size_t items = 0;    ///< and its work items

 private:
  OpenClApi true_api_;
  inline static NotingApi* self = nullptr;
};

class LargeCounts : public test::OnEveryDevice {};

HOLOTRACE_FOR_ALL_DEVICES(LargeCounts);

TEST_P(LargeCounts, ReachTheKernels) {
  DeviceInfo info = device_.info();
  info.memory = info.largest_buffer = 1e13;
  Device large(info);
  const auto lock = large.lock();
  {
    const DeviceBuffer compiled = large.make_buffer(64, "a test");  // before kernels are replaced
    clear(large, compiled);
    leave_phases(large, 1, compiled, compiled);
    add_part(large, compiled, 1, false, compiled);
    add_and_make_unit_modulus(large, compiled, compiled);
    multiply_by_real(large, compiled, compiled);
    large.finish();
  }
  NotingApi api;
  const size_t samples = (size_t(1) << 32) + 3;
  const DeviceBuffer floats = large.make_buffer(samples * 4, "a test"),
                     phasors = large.make_buffer(samples * 8, "a test");
  const auto expect = [&](size_t count) {
    EXPECT_EQ(api.count, count);
    EXPECT_EQ(api.items, (count + 63) / 64 * 64);
    api.items = 0;
  };
  clear(large, floats);
  expect(samples);
  leave_phases(large, 1, floats, phasors);
  expect(samples);
  multiply_by_real(large, floats, phasors);
  expect(samples);
  add_part(large, phasors, 1, true, phasors);
  expect(2 * samples);
  add_and_make_unit_modulus(large, phasors, phasors);
  expect(samples);
}
#endif

}  // namespace
}  // namespace holotrace
