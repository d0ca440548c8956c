#pragma once

/// Marks an inline function of physics that a CPU loop and a CUDA kernel both call.
#ifdef __CUDACC__
#define HOLOTRACE_HOST_DEVICE __host__ __device__
#else
#define HOLOTRACE_HOST_DEVICE
#endif
