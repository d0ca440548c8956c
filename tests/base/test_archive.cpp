#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "holotrace/base/archive.h"
#include "holotrace/base/error.h"
#include "support/error_of.h"

namespace holotrace {

// Of all kinds of members.
struct Archived {
  std::vector<std::string> texts;
  std::vector<double> numbers;
  Array2D<float> map;
  std::optional<std::string> text;
  std::optional<int> number;
  std::shared_ptr<const std::vector<int>> shared;
  std::variant<int, std::string> either;
  std::vector<std::pair<std::string, double>> pairs;
};

template <class Archive>
void members(Archive& archive, Archived& noun) {
  auto& [texts, numbers, map, text, number, shared, either, pairs] = noun;
  archive(texts, numbers, map, text, number, shared, either, pairs);
}

namespace {

Archived full() {
  Archived one{{"a", ""}, {1, 2.5}, Array2D<float>(2, 3, 4.F), "text", 7, {}, "either", {{"x", 1.5}}};
  one.shared = std::make_shared<const std::vector<int>>(std::vector<int>{3, 4, 5});
  return one;
}

TEST(Archive, ValuesComeBackAsWritten) {
  const Archived sent = full();
  Archived heard;
  int after = 0;
  from_message(to_message(sent, 9), heard, after);
  EXPECT_EQ(heard.texts, sent.texts);
  EXPECT_EQ(heard.numbers, sent.numbers);
  EXPECT_TRUE(heard.map.nx == 3 && heard.map.ny == 2 && heard.map.values == sent.map.values);
  EXPECT_EQ(heard.text, sent.text);
  EXPECT_EQ(heard.number, sent.number);
  EXPECT_EQ(*heard.shared, *sent.shared);
  EXPECT_EQ(heard.either, sent.either);
  EXPECT_EQ(heard.pairs, sent.pairs);
  EXPECT_EQ(after, 9);
  const Archived nothing;
  from_message(to_message(nothing), heard);  // what was there goes
  EXPECT_TRUE(heard.texts.empty() && !heard.text && !heard.number && !heard.shared && heard.pairs.empty());
}

TEST(Archive, BytesThatEndTooEarlyAreRefused) {
  const std::string bytes = to_message(full());
  for (size_t size = 0; size < bytes.size(); ++size) {
    Archived heard;
    EXPECT_EQ(error_of([&] { from_message(std::string_view(bytes).substr(0, size), heard); }),
              "expected the bytes of a message between processes of this version of holotrace, got others")
        << size;
  }
}

TEST(Archive, FingerprintsDifferWithEachValueAndItsPlace) {
  Archived other = full();
  const uint64_t one = fingerprint_of(other);
  EXPECT_EQ(fingerprint_of(full()), one);
  other.number.reset();
  EXPECT_NE(fingerprint_of(other), one);
  EXPECT_NE(fingerprint_of(std::string("ab"), std::string("c")), fingerprint_of(std::string("a"), std::string("bc")));
  EXPECT_NE(fingerprint_of(std::vector<int>{1}, std::vector<int>{}),
            fingerprint_of(std::vector<int>{}, std::vector<int>{1}));
}

}  // namespace
}  // namespace holotrace
