#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>

#include "holotrace/base/sanitizers.h"
#include "holotrace/denoise/denoise.h"

namespace holotrace::test {

/// An environment variable for the life of the object.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    setenv(name, value.c_str(), 1);
  }
  ~Environment() {
    if (before_)
      setenv(name_, before_->c_str(), 1);
    else
      unsetenv(name_);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

/// Why pictures cannot be denoised here; empty if they can.
inline std::string why_no_denoiser() {
#if HOLOTRACE_THREAD_SANITIZER
  return "the thread sanitizer sees none of the library's locks";
#else
  try {
    find_denoiser();
    return "";
  } catch (const NoDenoiser& none) {
    return none.what();
  }
#endif
}

}  // namespace holotrace::test

/// Skips a test, with the reason, where pictures cannot be denoised.
#define HOLOTRACE_NEEDS_DENOISER() \
  if (const std::string why = ::holotrace::test::why_no_denoiser(); !why.empty()) GTEST_SKIP() << why
