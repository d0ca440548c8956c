#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "holotrace/io/files/text.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

std::string repeated(const std::string& text, size_t n) {
  std::string out;
  for (size_t i = 0; i < n; ++i) out += text;
  return out;
}

TEST(Nesting, JsonIsLimitedInDepth) {
  const auto array = [](size_t n) { return repeated("[", n) + repeated("]", n); };
  EXPECT_EQ(error_of([&] { check_json_nesting(array(most_nesting), "f"); }), "no error");
  EXPECT_EQ(error_of([&] { check_json_nesting("\n" + array(most_nesting + 1), "f"); }),
            "f:2: expected at most 64 levels of nesting, got more; write the file with fewer levels");
  EXPECT_NE(error_of([&] { check_json_nesting(repeated("{\"a\":", 100000), "f"); }), "no error");
}

TEST(Nesting, BracketsInTextsAndListsSideBySideDoNotCount) {
  EXPECT_EQ(error_of([&] { check_json_nesting("\"" + repeated("[\\\"", 1000) + "\"", "f"); }), "no error");
  EXPECT_EQ(error_of([&] { check_json_nesting("[" + repeated("[],", 1000) + "[]]", "f"); }), "no error");
  for (const char* quote : {"\"", "'", "\"\"\"", "'''"})
    EXPECT_EQ(error_of([&] { check_toml_nesting("a = " + (quote + repeated("[.", 1000)) + quote, "f"); }), "no error")
        << quote;
  EXPECT_EQ(error_of([&] { check_toml_nesting("# " + repeated("[.", 1000) + "\na = 1", "f"); }), "no error");
  EXPECT_EQ(error_of([&] { check_toml_nesting(repeated("a.b = 1.5\n", 1000), "f"); }), "no error");
  EXPECT_EQ(error_of([&] { check_toml_nesting("a = [" + repeated("1.5, ", 1000) + "]", "f"); }), "no error");
}

TEST(Nesting, TomlIsLimitedInBracketsAndDottedKeys) {
  const std::string deep = "f:1: expected at most 64 levels";
  EXPECT_TRUE(error_of([&] { check_toml_nesting("a = " + repeated("[", 65), "f"); }).starts_with(deep));
  EXPECT_TRUE(error_of([&] { check_toml_nesting("a = " + repeated("{a=", 65), "f"); }).starts_with(deep));
  EXPECT_TRUE(error_of([&] { check_toml_nesting("a" + repeated(".a", 64) + " = 1", "f"); }).starts_with(deep));
  EXPECT_TRUE(error_of([&] { check_toml_nesting("[a" + repeated(" . \"a\"", 64) + "]", "f"); }).starts_with(deep));
  // A text that ends with its line hides nothing behind it.
  EXPECT_TRUE(error_of([&] { check_toml_nesting("a = 'b\nc = " + repeated("[", 65), "f"); }).starts_with("f:2:"));
}

TEST(Json, ErrorsAreInOurWordsWithTheirLine) {
  EXPECT_EQ(error_of([&] { parse_json("{\n\"a\": }", "f"); }),
            "f:2: expected valid JSON, but it is truncated or wrong at byte 8; write the file again");
  EXPECT_EQ(error_of([&] { parse_json("{\n\"a\":\n1e400}", "f"); }),
            "f:3: expected numbers below 1.8e308, got 1e400; write the file again");
}

}  // namespace
}  // namespace holotrace
