#include <gtest/gtest.h>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"

namespace holotrace {
namespace {

TEST(Memory, SizesThatFitPassAndLargerOnesAreNamed) {
  const double present = physical_memory();
  EXPECT_GT(present, 1e8);  // any machine that builds this has more than 100 MB
  EXPECT_NO_THROW(require_memory(present, "all of it"));
  EXPECT_THROW(require_memory(1.01 * present, "a little more"), Error);
  try {
    require_memory(1125899906842624.0 * 1024, "a huge panel");  // 2⁶⁰ bytes, an exbibyte
    FAIL() << "expected an Error";
  } catch (const Error& error) {
    const std::string sentence = error.what();
    EXPECT_NE(sentence.find("expected a huge panel to fit in memory, but it needs "), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("iB"), std::string::npos) << sentence;
  }
}

}  // namespace
}  // namespace holotrace
