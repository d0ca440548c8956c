#include "holotrace/denoise/oidn.h"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <optional>
#include <vector>

#include "holotrace/denoise/denoise.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

constexpr const char* library_name = "libOpenImageDenoise.so.2";

constexpr const char* how_to_install =
    "install libopenimagedenoise2 or the Python package pyoidn, name the library by HOLOTRACE_OIDN, or use denoise = none";

// The folder that look_for_denoiser_in names.
class NamedFolder {
 public:
  void set(const std::string& folder) {
    const std::lock_guard lock(mutex_);
    folder_ = folder;
  }
  std::string get() const {
    const std::lock_guard lock(mutex_);
    return folder_;
  }

 private:
  mutable std::mutex mutex_;
  std::string folder_;
};

NamedFolder& named_folder() {
  static NamedFolder folder;
  return folder;
}

// Places of the library of the package pyoidn in a virtual environment, or in a folder of packages.
std::vector<std::string> libraries_in(const fs::path& folder) {
  const fs::path library = fs::path("pyoidn") / "oidn" / "lib" / library_name;
  std::vector<std::string> files{(folder / library).string()};
  std::error_code error;
  for (fs::directory_iterator i(folder / "lib", error), end; !error && i != end; i.increment(error))
    files.push_back((i->path() / "site-packages" / library).string());
  return files;
}

std::vector<std::string> places_of_library() {
  std::vector<std::string> places;
  if (const std::string folder = named_folder().get(); !folder.empty())
    places.push_back((fs::path(folder) / library_name).string());
  places.emplace_back(library_name);  // where the system's loader finds it
  std::error_code error;
  // bin/holotrace of an environment, or a wheel's holotrace.scripts/holotrace in a folder of packages
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  for (const fs::path& folder : {program.parent_path().parent_path(), fs::path(HOLOTRACE_PYTHON_ENVIRONMENT)})
    if (!folder.empty())
      for (std::string& file : libraries_in(folder)) places.push_back(std::move(file));
  return places;
}

// A library, and where it was found.
struct Found {
  void* library;
  std::string file;
};

Found open_library() {
  if (const char* given = std::getenv("HOLOTRACE_OIDN"); given && *given) {
    std::error_code ignored;
    const std::string file = fs::is_directory(given, ignored) ? (fs::path(given) / library_name).string() : given;
    if (void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) return {library, file};
    throw NoDenoiser(fmt::format("expected Open Image Denoise 2 in HOLOTRACE_OIDN, got \"{}\"; name the file {}",
                                 dlerror(), library_name),
                     true);
  }
  for (const std::string& file : places_of_library())
    if (void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) return {library, file};
  throw NoDenoiser(
      fmt::format("expected Open Image Denoise 2, {}, on this machine, found none; {}", library_name, how_to_install),
      false);
}

}  // namespace

OpenOidn open_oidn() {
  const Found found = open_library();
  const auto fail_with = [&](const std::string& got) {
    throw NoDenoiser(fmt::format("expected Open Image Denoise 2.3 or a later 2.x in {}, got {}; {}", found.file, got,
                                 how_to_install),
                     true);
  };
  OpenOidn oidn;
  Oidn& f = oidn.functions;
  const auto find = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(found.library, name));
    if (!function) fail_with(fmt::format("a library without {}", name));
  };
  find(f.oidnNewDevice, "oidnNewDevice");
  find(f.oidnSetDeviceBool, "oidnSetDeviceBool");
  find(f.oidnSetDeviceInt, "oidnSetDeviceInt");
  find(f.oidnGetDeviceInt, "oidnGetDeviceInt");
  find(f.oidnGetDeviceError, "oidnGetDeviceError");
  find(f.oidnCommitDevice, "oidnCommitDevice");
  find(f.oidnReleaseDevice, "oidnReleaseDevice");
  find(f.oidnNewFilter, "oidnNewFilter");
  find(f.oidnSetSharedFilterImage, "oidnSetSharedFilterImage");
  find(f.oidnSetFilterBool, "oidnSetFilterBool");
  find(f.oidnSetFilterInt, "oidnSetFilterInt");
  find(f.oidnSetFilterProgressMonitorFunction, "oidnSetFilterProgressMonitorFunction");
  find(f.oidnCommitFilter, "oidnCommitFilter");
  find(f.oidnExecuteFilter, "oidnExecuteFilter");
  find(f.oidnReleaseFilter, "oidnReleaseFilter");

  Oidn::Device device = f.oidnNewDevice(Oidn::cpu);
  if (!device) {
    const char* message = nullptr;
    f.oidnGetDeviceError(nullptr, &message);
    fail_with(fmt::format("one without a device for processors (\"{}\")", message ? message : ""));
  }
  const int version = f.oidnGetDeviceInt(device, "version");  // 10000·major + 100·minor + patch
  f.oidnReleaseDevice(device);
  oidn.version = fmt::format("{}.{}.{}", version / 10000, version / 100 % 100, version % 100);
  constexpr int first = 20300, first_of_next = 30000;  // 2.3: the fast quality
  if (version < first || version >= first_of_next) fail_with("version " + oidn.version);
  return oidn;
}

std::string find_denoiser() { return "Open Image Denoise " + open_oidn().version; }

void look_for_denoiser_in(const std::string& folder) { named_folder().set(folder); }

}  // namespace holotrace
