// What every command loads before it does anything.

#include <gtest/gtest.h>

#include <algorithm>

#include "support/program.h"

namespace holotrace::test {
namespace {

// The dynamic linker lists the libraries of a program instead of running it if LD_TRACE_LOADED_OBJECTS is set.
TEST(Start, LoadsNoLibrariesThatMostCommandsDoNotNeed) {
  const Workplace work;
  const Outcome outcome = work.run_under({"env", "LD_TRACE_LOADED_OBJECTS=1"}, {});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  // MPI is for launchers, OpenCL for those who ask for a device; the other two load dozens of libraries more.
  for (const char* name : {"libmpi.", "libOpenCL.", "libcurl.", "libOpenImageIO."})
    EXPECT_EQ(outcome.out.find(name), std::string::npos) << name;
  // Each library that is named in src/holotrace/CMakeLists.txt, and what it needs itself: 33 on Debian 12. OpenImageIO
  // alone has 250.
  EXPECT_LE(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 45) << outcome.out;
}

}  // namespace
}  // namespace holotrace::test
