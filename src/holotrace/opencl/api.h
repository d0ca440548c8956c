#pragma once

#include <string>

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

// Only files of this room include this header.

namespace holotrace {

// The functions of OpenCL that this room calls.
#define HOLOTRACE_OPENCL_FUNCTIONS(call)                                                                           \
  call(clGetPlatformIDs) call(clGetPlatformInfo) call(clGetDeviceIDs) call(clGetDeviceInfo) call(clCreateContext)  \
      call(clReleaseContext) call(clCreateCommandQueue) call(clReleaseCommandQueue) call(clCreateBuffer)           \
          call(clCreateSubBuffer) call(clReleaseMemObject) call(clEnqueueWriteBuffer) call(clEnqueueReadBuffer)    \
              call(clEnqueueNDRangeKernel) call(clFinish) call(clCreateSubDevices) call(clCreateProgramWithSource) \
                  call(clCreateProgramWithBinary) call(clBuildProgram) call(clGetProgramInfo)                      \
                      call(clGetProgramBuildInfo) call(clReleaseProgram) call(clCreateKernel) call(clSetKernelArg) \
                          call(clReleaseKernel)

/// The functions of the loader, libOpenCL.so.1. It is opened at run time, so that other commands need not load it and
/// the program starts on machines without it.
struct OpenClApi {
#define HOLOTRACE_MEMBER(name) decltype(&::name) name = nullptr;  // NOLINT(bugprone-macro-parentheses): a declared name
  HOLOTRACE_OPENCL_FUNCTIONS(HOLOTRACE_MEMBER)
#undef HOLOTRACE_MEMBER
};

/// The functions, loaded at the first call. Tests replace some of them to make them fail.
/// @throws Error  if this machine has no loader
OpenClApi& opencl_api();

/// The name of an error: "CL_OUT_OF_RESOURCES", or its number.
std::string status_name(cl_int status);

/// Whether an error says that memory is used up.
bool is_out_of_memory(cl_int status);

/// Calls one of OpenCL's functions for information twice: for the size of a text, and for the text.
template <class Function, class... Object>
std::string text_from(Function function, cl_uint what, Object... object) {
  size_t size = 0;
  if (function(object..., what, 0, nullptr, &size) != CL_SUCCESS || size == 0) return "";
  std::string text(size, '\0');
  if (function(object..., what, size, text.data(), nullptr) != CL_SUCCESS) return "";
  text.resize(text.find_last_not_of(std::string("\0 \n", 3)) + 1);
  return text;
}

}  // namespace holotrace
