#include "holotrace/opencl/api.h"

#include <dlfcn.h>

#include <array>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

OpenClApi load() {
  void* library = dlopen("libOpenCL.so.1", RTLD_NOW | RTLD_LOCAL);
  require(library != nullptr,
          "expected the loader of OpenCL, libOpenCL.so.1, got \"{}\"; install it (ocl-icd-libopencl1) and the "
          "driver of your card, or use the device cpu",
          dlerror());
  OpenClApi api;
  const auto find = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
    require(function != nullptr,
            "expected OpenCL 1.2 or later in libOpenCL.so.1, got one without {}; install a newer one", name);
  };
#define HOLOTRACE_FIND(name) find(api.name, #name);
  HOLOTRACE_OPENCL_FUNCTIONS(HOLOTRACE_FIND)
#undef HOLOTRACE_FIND
  return api;
}

struct Status {
  cl_int value;
  const char* name;
};

constexpr std::array statuses{
    Status{CL_DEVICE_NOT_FOUND, "CL_DEVICE_NOT_FOUND"},
    Status{CL_DEVICE_NOT_AVAILABLE, "CL_DEVICE_NOT_AVAILABLE"},
    Status{CL_COMPILER_NOT_AVAILABLE, "CL_COMPILER_NOT_AVAILABLE"},
    Status{CL_MEM_OBJECT_ALLOCATION_FAILURE, "CL_MEM_OBJECT_ALLOCATION_FAILURE"},
    Status{CL_OUT_OF_RESOURCES, "CL_OUT_OF_RESOURCES"},
    Status{CL_OUT_OF_HOST_MEMORY, "CL_OUT_OF_HOST_MEMORY"},
    Status{CL_BUILD_PROGRAM_FAILURE, "CL_BUILD_PROGRAM_FAILURE"},
    Status{CL_INVALID_BUFFER_SIZE, "CL_INVALID_BUFFER_SIZE"},
    Status{CL_INVALID_KERNEL_NAME, "CL_INVALID_KERNEL_NAME"},
    Status{CL_INVALID_KERNEL_ARGS, "CL_INVALID_KERNEL_ARGS"},
    Status{CL_INVALID_ARG_SIZE, "CL_INVALID_ARG_SIZE"},
    Status{CL_INVALID_WORK_GROUP_SIZE, "CL_INVALID_WORK_GROUP_SIZE"},
    Status{CL_INVALID_COMMAND_QUEUE, "CL_INVALID_COMMAND_QUEUE"},
};

}  // namespace

OpenClApi& opencl_api() {
  static OpenClApi api = load();
  return api;
}

std::string status_name(cl_int status) {
  for (const Status& known : statuses)
    if (known.value == status) return known.name;
  return fmt::format("error {} of OpenCL", status);
}

bool is_out_of_memory(cl_int status) {
  return status == CL_MEM_OBJECT_ALLOCATION_FAILURE || status == CL_OUT_OF_RESOURCES ||
         status == CL_OUT_OF_HOST_MEMORY || status == CL_INVALID_BUFFER_SIZE;
}

}  // namespace holotrace
