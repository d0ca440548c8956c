#include "holotrace/io/scene/toml_file.h"

#include <string>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/nesting.h"
#include "holotrace/io/files/text_lines.h"

namespace holotrace {
namespace {

// What the parser expected, by words of its own message.
std::string expected_by(std::string_view message, const std::string& line) {
  struct Case {
    std::string_view word, expected;
  };
  constexpr std::string_view value = "a value: a number, a text in quotes, true, false, or a list in [ ]";
  constexpr Case cases[] = {
      {"utf-8", "text in UTF-8, got other bytes"},
      {"surrogate", "characters of Unicode, got half of a pair"},
      {"control character", "text, got a control character"},
      {"escape", "an escape sequence such as \\n or \\\\ in a text"},
      {"while parsing string", "a text that ends with the quote that it began with"},
      {"redefine", "each key and each table once, got one twice"},
      {"already", "each key and each table once, got one twice"},
      {"duplicate", "each key and each table once, got one twice"},
      {"while parsing table header", "a table such as [camera] or [[object]]"},
      {"while parsing inline table", "a table such as { a = 1, b = 2 }"},
      {"while parsing array", "a list such as [1, 2, 3]"},
      {"nesting", "less nesting"},
      {"while parsing boolean", "true or false"},
      {"while parsing comment", "a comment of text after #"},
      {"end-of-file", "KEY = VALUE, but the file ends"},
      {"expected value", value},
      {"determine value type", value},
      {"while parsing key", "KEY = VALUE"},
      {"while parsing", "a number that fits, or a text in quotes, such as 12, 0.5, 1e-3 or \"8 um\""},
  };
  if (message.find("while parsing key") != std::string_view::npos && line.starts_with('['))
    message = "while parsing table header";
  for (const Case& c : cases)
    if (message.find(c.word) != std::string_view::npos) return std::string(c.expected);
  return "KEY = VALUE, a [TABLE] or a # comment";
}

std::string line_of(const std::string& text, uint32_t number) {
  constexpr size_t most = 60;
  size_t begin = 0;
  for (uint32_t line = 1; line < number && begin != std::string::npos; ++line) {
    begin = text.find('\n', begin);
    if (begin != std::string::npos) ++begin;
  }
  if (begin == std::string::npos) return "";
  const std::string line = text.substr(begin, text.find('\n', begin) - begin);
  return line.size() <= most ? line : line.substr(0, most) + "…";
}

}  // namespace

toml::table parse_toml(const std::string& path, const char* kind) {
  check_file_exists(path, kind);
  const std::string text = read_lines(path);
  check_toml_nesting(text, path);
  try {
    return toml::parse(text, path);
  } catch (const toml::parse_error& e) {
    const auto at = e.source().begin;
    const std::string line = line_of(text, at.line);
    const std::string known = extension_of(path) == ".toml" ? "" : kind_by_bytes(path);
    if (!known.empty()) fail("{}: expected {}, got {}", path, kind, known);
    fail("{}:{}:{}: expected {}; the line is \"{}\"", path, at.line, at.column, expected_by(e.description(), line),
         line);
  }
}

}  // namespace holotrace
