#pragma once

#include <cstddef>
#include <string>

// Only files of this room include this header.

namespace holotrace {

/// The functions of Open Image Denoise 2 that this room calls, as its header oidn.h declares them (C, all values of
/// enumerations are int).
struct Oidn {
  using Device = struct OidnDevice*;
  using Filter = struct OidnFilter*;
  static constexpr int cpu = 1;                      // OIDN_DEVICE_TYPE_CPU
  static constexpr int one_float = 1, rgb = 3;       // OIDN_FORMAT_FLOAT, OIDN_FORMAT_FLOAT3
  static constexpr int none = 0, out_of_memory = 4;  // OIDNError
  static constexpr int fast = 4, high = 6;           // OIDNQuality

  Device (*oidnNewDevice)(int type) = nullptr;
  void (*oidnSetDeviceBool)(Device, const char* name, bool value) = nullptr;
  void (*oidnSetDeviceInt)(Device, const char* name, int value) = nullptr;
  int (*oidnGetDeviceInt)(Device, const char* name) = nullptr;
  int (*oidnGetDeviceError)(Device, const char** message) = nullptr;
  void (*oidnCommitDevice)(Device) = nullptr;
  void (*oidnReleaseDevice)(Device) = nullptr;
  Filter (*oidnNewFilter)(Device, const char* type) = nullptr;
  void (*oidnSetSharedFilterImage)(Filter, const char* name, void* values, int format, size_t width, size_t height,
                                   size_t offset, size_t pixel_stride, size_t row_stride) = nullptr;
  void (*oidnSetFilterBool)(Filter, const char* name, bool value) = nullptr;
  void (*oidnSetFilterInt)(Filter, const char* name, int value) = nullptr;
  void (*oidnSetFilterProgressMonitorFunction)(Filter, bool (*goes_on)(void* user, double fraction),
                                               void* user) = nullptr;
  void (*oidnCommitFilter)(Filter) = nullptr;
  void (*oidnExecuteFilter)(Filter) = nullptr;
  void (*oidnReleaseFilter)(Filter) = nullptr;
};

/// An open library.
struct OpenOidn {
  Oidn functions;
  std::string version;  ///< "2.5.1"
};

/// Opens the library where README.md says it is looked for.
/// @throws NoDenoiser  (denoise.h)
OpenOidn open_oidn();

}  // namespace holotrace
