#pragma once

// Whether this is a build under a sanitizer of GCC or Clang: 0 or 1.

#if defined(__has_feature)
#define HOLOTRACE_CLANG_HAS(feature) __has_feature(feature)
#else
#define HOLOTRACE_CLANG_HAS(feature) 0
#endif

#if defined(__SANITIZE_ADDRESS__) || HOLOTRACE_CLANG_HAS(address_sanitizer)
#define HOLOTRACE_ADDRESS_SANITIZER 1
#else
#define HOLOTRACE_ADDRESS_SANITIZER 0
#endif

#if defined(__SANITIZE_THREAD__) || HOLOTRACE_CLANG_HAS(thread_sanitizer)
#define HOLOTRACE_THREAD_SANITIZER 1
#else
#define HOLOTRACE_THREAD_SANITIZER 0
#endif
