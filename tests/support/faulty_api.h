#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <string>

#include "holotrace/base/error.h"
#include "holotrace/opencl/api.h"

namespace holotrace::test {

/// Functions of OpenCL that count what they make and release, and fail when they are told to. One at a time.
class FaultyApi {
 public:
  FaultyApi() : true_api_(opencl_api()) {
    self = this;
    OpenClApi& api = opencl_api();
    api.clCreateBuffer = [](cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* status) -> cl_mem {
      if (self->fails(*status, CL_MEM_OBJECT_ALLOCATION_FAILURE)) return nullptr;
      return self->made(self->true_api_.clCreateBuffer(context, flags, size, host, status));
    };
    api.clCreateSubBuffer = [](cl_mem buffer, cl_mem_flags flags, cl_buffer_create_type type, const void* region,
                               cl_int* status) -> cl_mem {
      if (self->fails(*status, CL_OUT_OF_RESOURCES)) return nullptr;
      return self->made(self->true_api_.clCreateSubBuffer(buffer, flags, type, region, status));
    };
    api.clReleaseMemObject = [](cl_mem memory) {
      self->was_released_twice = self->was_released_twice || self->held.erase(memory) == 0;
      return self->true_api_.clReleaseMemObject(memory);
    };
    api.clEnqueueWriteBuffer = [](auto... arguments) {
      cl_int status = CL_SUCCESS;
      return self->fails(status, CL_DEVICE_NOT_AVAILABLE) ? status : self->true_api_.clEnqueueWriteBuffer(arguments...);
    };
    api.clEnqueueReadBuffer = [](auto... arguments) {
      cl_int status = CL_SUCCESS;
      return self->fails(status, CL_DEVICE_NOT_AVAILABLE) ? status : self->true_api_.clEnqueueReadBuffer(arguments...);
    };
    api.clEnqueueNDRangeKernel = [](auto... arguments) {
      cl_int status = CL_SUCCESS;
      return self->fails(status, -9999) ? status : self->true_api_.clEnqueueNDRangeKernel(arguments...);
    };
    api.clFinish = [](cl_command_queue queue) {
      cl_int status = CL_SUCCESS;
      return self->fails(status, CL_OUT_OF_RESOURCES) ? status : self->true_api_.clFinish(queue);
    };
  }
  ~FaultyApi() {
    opencl_api() = true_api_;
    self = nullptr;
  }
  FaultyApi(const FaultyApi&) = delete;

  int calls = 0;          ///< of the functions above
  int failing = -1;       ///< the call that fails, from 0
  std::set<cl_mem> held;  ///< memory that was made and not released
  bool was_released_twice = false;

 private:
  bool fails(cl_int& status, cl_int error) {
    if (calls++ != failing) return false;
    status = error;
    return true;
  }
  cl_mem made(cl_mem memory) {
    if (memory) held.insert(memory);
    return memory;
  }

  OpenClApi true_api_;
  inline static FaultyApi* self = nullptr;
};

/// Runs `job` again and again, with call 0 of OpenCL failing, then call `step`, 2·step, …, until a run has fewer calls. A
/// failure must be an Error of one sentence, and what was made must have been released, once. `after(error)` runs after each
/// failure, with the same call failing again. Returns how many runs failed.
template <class Job, class After>
int fail_every(int step, const Job& job, const After& after) {
  int faults = 0;
  for (int failing = 0;; failing += step) {
    SCOPED_TRACE("call " + std::to_string(failing) + " fails");
    FaultyApi api;
    api.failing = failing;
    std::optional<std::string> error;
    try {
      job();
    } catch (const Error& thrown) {
      error = thrown.what();
    }
    EXPECT_TRUE(api.held.empty());
    EXPECT_FALSE(api.was_released_twice);
    EXPECT_EQ(error.has_value(), api.calls > failing) << error.value_or("no error");
    if (!error) return faults;
    EXPECT_EQ(error->find('\n'), std::string::npos) << *error;
    ++faults;
    api.calls = 0;
    after(*error);
    EXPECT_TRUE(api.held.empty());
    EXPECT_FALSE(api.was_released_twice);
    if (::testing::Test::HasFatalFailure()) return faults;
  }
}

template <class Job>
int fail_every(int step, const Job& job) {
  return fail_every(step, job, [](const std::string&) {});
}

/// The warning of `auto` after a failure.
inline std::string warning_after(const std::string& error) {
  return "the device auto: the processor took over, because " + error;
}

}  // namespace holotrace::test
