/* A library with the functions of Open Image Denoise, for tests: of the version that FAKE_OIDN_VERSION names, or without a device for
 * version 0. */
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

static int version(void) {
  const char* given = getenv("FAKE_OIDN_VERSION");
  return given ? atoi(given) : 0;
}

void* oidnNewDevice(int type) {
  (void)type;
  return version() ? (void*)&version : NULL;
}
void oidnSetDeviceBool(void* device, const char* name, bool value) { (void)device, (void)name, (void)value; }
void oidnSetDeviceInt(void* device, const char* name, int value) { (void)device, (void)name, (void)value; }
int oidnGetDeviceInt(void* device, const char* name) {
  (void)device, (void)name;
  return version();
}
int oidnGetDeviceError(void* device, const char** message) {
  (void)device;
  *message = "the filter is a fake";
  return 5;
}
void oidnCommitDevice(void* device) { (void)device; }
void oidnReleaseDevice(void* device) { (void)device; }
void* oidnNewFilter(void* device, const char* type) {
  (void)type;
  return device;
}
void oidnSetSharedFilterImage(void* filter, const char* name, void* values, int format, size_t width, size_t height,
                              size_t offset, size_t pixel_stride, size_t row_stride) {
  (void)filter, (void)name, (void)values, (void)format, (void)width, (void)height, (void)offset, (void)pixel_stride;
  (void)row_stride;
}
void oidnSetFilterBool(void* filter, const char* name, bool value) { (void)filter, (void)name, (void)value; }
void oidnSetFilterInt(void* filter, const char* name, int value) { (void)filter, (void)name, (void)value; }
void oidnSetFilterProgressMonitorFunction(void* filter, bool (*goes_on)(void*, double), void* user) {
  (void)filter, (void)goes_on, (void)user;
}
void oidnCommitFilter(void* filter) { (void)filter; }
void oidnExecuteFilter(void* filter) { (void)filter; }
void oidnReleaseFilter(void* filter) { (void)filter; }
