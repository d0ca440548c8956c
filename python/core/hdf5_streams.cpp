#include <cstdio>

// The static library of HDF5 is compiled for programs, whose code reaches stdout and stderr of the C library directly. A module
// cannot, so its copy of HDF5 uses these (cmake/hdf5.cmake).

extern "C" {
[[gnu::visibility("hidden")]] std::FILE* holotrace_hdf5_stdout = stdout;
[[gnu::visibility("hidden")]] std::FILE* holotrace_hdf5_stderr = stderr;
}
