#include "holotrace/io/files/nesting.h"

#include <algorithm>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

[[noreturn]] void fail_deep(std::string_view text, size_t at, const std::string& path) {
  fail("{}:{}: expected at most {} levels of nesting, got more; write the file with fewer levels", path,
       1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n'), most_nesting);
}

// Index of the last character of the TOML text whose first quote is at `at`. A text of one line ends at the line's end.
size_t end_of_text(std::string_view toml, size_t at) {
  const char quote = toml[at];
  const std::string_view triple = quote == '"' ? "\"\"\"" : "'''";
  const bool has_lines = toml.substr(at, 3) == triple;
  for (size_t i = at + (has_lines ? 3 : 1); i < toml.size(); ++i) {
    if (toml[i] == '\\' && quote == '"') {
      ++i;
    } else if (has_lines) {
      if (toml.substr(i, 3) == triple) return i + 2;
    } else if (toml[i] == quote || toml[i] == '\n') {
      return i;
    }
  }
  return toml.size();
}

}  // namespace

void check_json_nesting(std::string_view text, const std::string& path) {
  int depth = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      for (++i; i < text.size() && text[i] != '"'; ++i) i += text[i] == '\\';
    } else if (c == '[' || c == '{') {
      if (++depth > most_nesting) fail_deep(text, i, path);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
}

void check_toml_nesting(std::string_view text, const std::string& path) {
  int depth = 0, parts = 1;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (c == '"' || c == '\'') {
      i = end_of_text(text, i);
    } else if (c == '[' || c == '{') {
      ++depth;
      parts = 1;
    } else if (c == ']' || c == '}') {
      --depth;
      parts = 1;
    } else if (c == '=' || c == ',' || c == '\n') {
      parts = 1;
    } else if (c == '.') {
      ++parts;
    }
    if (depth > most_nesting || parts > most_nesting) fail_deep(text, std::min(i, text.size()), path);
  }
}

}  // namespace holotrace
