#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "support/program.h"

namespace holotrace::test {

using Words = std::vector<std::string>;

// The contract of every error: exit code 1, one line "holotrace: …" with these words, and the same files as before.
inline void expect_error(const Workplace& work, const std::vector<std::string>& arguments, const Words& words) {
  const auto before = work.names();
  const Outcome outcome = work.run(arguments);
  std::string command;
  for (const std::string& argument : arguments) command += " " + argument;
  SCOPED_TRACE("holotrace" + command + "\n" + outcome.err);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err.substr(0, 11), "holotrace: ");
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << "expected one line";
  EXPECT_GT(outcome.err.size(), 30U) << "expected a sentence";  // shorter than any sentence that says what to do
  for (const std::string& word : words) EXPECT_NE(outcome.err.find(word), std::string::npos) << word;
  EXPECT_EQ(work.names(), before);
}

}  // namespace holotrace::test
