#include <gtest/gtest.h>

#include "holotrace/base/message_text.h"

namespace holotrace {
namespace {

TEST(Printable, TextOfAnyLanguageStaysAsItIs) {
  const std::string text = "\"Würfel\" 8 × 8 µm, 立方体 🙂";
  EXPECT_EQ(printable(text), text);
}

TEST(Printable, ControlCharactersAreEscaped) {
  EXPECT_EQ(printable("\x1b[31mred\x07"), "\\x1b[31mred\\x07");
  EXPECT_EQ(printable("one\ntwo\r\t\x7f"), "one\\ntwo\\x0d\\x09\\x7f");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(printable("\xc2\x9b"), "\\x9b");              // U+009B, one character for ESC [
  EXPECT_EQ(printable("\xe2\x80\xaegpj"), "\\u202egpj");  // writes from right to left
}

TEST(Printable, BytesThatAreNotUtf8AreEscaped) {
  EXPECT_EQ(printable("\xff\xc3"), "\\xff\\xc3");
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");                    // a slash in two bytes, which UTF-8 forbids
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // half of a UTF-16 pair
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond U+10FFFF
}

TEST(Printable, LongTextsAreCut) {
  const std::string cut = printable(std::string(10000, 'a'), 100);
  EXPECT_LT(cut.size(), 110u);  // 100 and the mark of the cut
  EXPECT_TRUE(cut.ends_with(" …"));
}

}  // namespace
}  // namespace holotrace
