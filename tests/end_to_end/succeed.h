#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/program.h"

namespace holotrace::test {

// Runs a command that must succeed without output on stderr, and returns its output.
inline std::string succeed(const Workplace& work, const std::vector<std::string>& arguments) {
  const Outcome outcome = work.run(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "") << "expected no progress bar and no warning in a pipe";
  return outcome.out;
}

}  // namespace holotrace::test
