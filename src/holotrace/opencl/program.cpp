#include "holotrace/opencl/program.h"

#include "holotrace/base/error.h"
#include "holotrace/opencl/device.h"

namespace holotrace {
namespace {

ProgramStore& store() {
  static ProgramStore the_store;
  return the_store;
}

std::string text_of(const Kernel& kernel) {
  std::string text;
  for (const char* source : kernel.sources) text += source;
  return text;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::string binary_of(cl_program program) {
  const OpenClApi& api = opencl_api();
  size_t size = 0;
  if (api.clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, nullptr) != CL_SUCCESS) return "";
  std::string binary(size, '\0');
  unsigned char* to = reinterpret_cast<unsigned char*>(binary.data());
  if (api.clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof to, static_cast<void*>(&to), nullptr) != CL_SUCCESS)
    return "";
  return binary;
}

}  // namespace

Programs::Programs(const DeviceInfo& info, cl_device_id device, cl_context context)
    : info_(info), device_(device), context_(context) {}

Programs::~Programs() {
  for (const auto& [key, kernel] : kernels_) opencl_api().clReleaseKernel(kernel);
  for (const auto& [key, program] : programs_) opencl_api().clReleaseProgram(program);
}

cl_kernel Programs::find(const Kernel& kernel) {
  const std::string source = text_of(kernel), program_key = kernel.options + "\n" + source;
  const auto known = kernels_.find(kernel.name + ("\n" + program_key));
  if (known != kernels_.end()) return known->second;
  auto program = programs_.find(program_key);
  if (program == programs_.end()) program = programs_.emplace(program_key, compile(kernel, source)).first;
  cl_int status = CL_SUCCESS;
  const cl_kernel made = opencl_api().clCreateKernel(program->second, kernel.name, &status);
  require(status == CL_SUCCESS, "expected the kernel {} in its source for the device {}, got {}; please report it",
          kernel.name, info_.name, status_name(status));
  kernels_.emplace(kernel.name + ("\n" + program_key), made);
  return made;
}

// The program as an earlier run compiled it; none if there is none, or the driver does not want it any more.
cl_program Programs::load(const std::string& key, const std::string& options) {
  if (!program_store().load) return nullptr;
  const std::optional<std::string> binary = program_store().load(key);
  if (!binary) return nullptr;
  const OpenClApi& api = opencl_api();
  const size_t size = binary->size();
  const auto* bytes = reinterpret_cast<const unsigned char*>(binary->data());
  cl_int of_device = CL_SUCCESS, status = CL_SUCCESS;
  const cl_program program = api.clCreateProgramWithBinary(context_, 1, &device_, &size, &bytes, &of_device, &status);
  if (status != CL_SUCCESS || of_device != CL_SUCCESS) return nullptr;
  if (api.clBuildProgram(program, 1, &device_, options.c_str(), nullptr, nullptr) == CL_SUCCESS) return program;
  api.clReleaseProgram(program);
  return nullptr;
}

cl_program Programs::compile(const Kernel& kernel, const std::string& source) {
  const std::string key =
      fmt::format("{}\n{}\n{}\n{}\n{}", info_.name, info_.platform, info_.driver, kernel.options, source);
  if (const cl_program kept = load(key, kernel.options)) return kept;
  const OpenClApi& api = opencl_api();
  const char* text = source.c_str();
  cl_int status = CL_SUCCESS;
  const cl_program program = api.clCreateProgramWithSource(context_, 1, &text, nullptr, &status);
  if (status == CL_SUCCESS) status = api.clBuildProgram(program, 1, &device_, kernel.options.c_str(), nullptr, nullptr);
  if (status == CL_SUCCESS) {
    if (const std::string binary = binary_of(program); program_store().save && !binary.empty())
      program_store().save(key, binary);
    return program;
  }
  const std::string log = program ? text_from(api.clGetProgramBuildInfo, CL_PROGRAM_BUILD_LOG, program, device_) : "";
  if (program) api.clReleaseProgram(program);
  const std::string path = program_store().save_log ? program_store().save_log(log) : "";
  fail(
      "expected the driver of the device {} to compile the kernel {}, got {}: \"{}\"{}; update the driver, or use the "
      "device cpu",
      info_.name, kernel.name, status_name(status), first_line(log),
      path.empty() ? "" : fmt::format(" (all messages are in {})", path));
}

void set_program_store(ProgramStore new_store) { store() = std::move(new_store); }

const ProgramStore& program_store() { return store(); }

}  // namespace holotrace
