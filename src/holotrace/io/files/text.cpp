#include "holotrace/io/files/text.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <string_view>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view blanks = " \t\r\n";

// The encoding of a text other than UTF-8, by its byte-order mark or by the zeros beside its first character; "" if none.
std::string_view other_encoding(std::string_view bytes) {
  const auto is_zero = [&](size_t i) { return i < bytes.size() && bytes[i] == 0; };
  if (bytes.starts_with("\xff\xfe\0\0"sv) || bytes.starts_with("\0\0\xfe\xff"sv)) return "UTF-32";
  if (bytes.starts_with("\xff\xfe"sv) || bytes.starts_with("\xfe\xff"sv)) return "UTF-16";
  const bool is_little = !is_zero(0) && is_zero(1) && !is_zero(2) && is_zero(3),
             is_big = is_zero(0) && !is_zero(1) && is_zero(2) && !is_zero(3);
  return bytes.size() >= 4 && (is_little || is_big) ? "UTF-16" : "";
}

}  // namespace

size_t begin_of_text(std::string_view bytes, const std::string& path) {
  const std::string_view other = other_encoding(bytes);
  if (!other.empty()) fail("{}: expected text in UTF-8, got {}; save it again as UTF-8", path, other);
  constexpr std::string_view mark = "\xef\xbb\xbf";
  return bytes.starts_with(mark) ? mark.size() : 0;
}

std::string as_lines(std::string bytes, const std::string& path) {
  bytes.erase(0, begin_of_text(bytes, path));
  size_t from = std::min(bytes.find('\r'), bytes.size()), to = from;
  for (; from < bytes.size(); ++from) {
    const bool is_return = bytes[from] == '\r';
    if (is_return && from + 1 < bytes.size() && bytes[from + 1] == '\n') continue;
    bytes[to++] = is_return ? '\n' : bytes[from];
  }
  bytes.resize(to);
  return bytes;
}

std::string read_lines(const std::string& path, uint64_t most) { return as_lines(read_text(path, most), path); }

bool next_line(std::string_view& text, std::string_view& line) {
  if (text.empty()) return false;
  const size_t end = std::min(text.find('\n'), text.size());
  line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return true;
}

std::string_view next_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  return word;
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string_view without_comment(std::string_view line) { return line.substr(0, line.find('#')); }

std::vector<TextRow> read_rows(const std::string& path) {
  const std::string text = read_lines(path);
  std::string_view rest = text, line;
  std::vector<TextRow> rows;
  for (size_t number = 1; next_line(rest, line); ++number) {
    std::string content(without_comment(line));
    std::replace(content.begin(), content.end(), ',', ' ');
    TextRow row{path + ":" + std::to_string(number) + ": ", std::string(line), {}};
    std::string_view left = content;
    for (std::string_view word = next_word(left); !word.empty(); word = next_word(left)) row.words.emplace_back(word);
    if (!row.words.empty()) rows.push_back(std::move(row));
  }
  return rows;
}

std::string_view name_without_comment(std::string_view line) {
  std::string_view rest = line;
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest))
    if (word == "#") return trimmed(line.substr(0, size_t(word.data() - line.data())));
  return trimmed(line);
}

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

namespace {

auto line_of(const std::string& text, size_t at) {
  return 1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(std::min(at, text.size())), '\n');
}

}  // namespace

nlohmann::json parse_json(const std::string& text, const std::string& path) {
  check_json_nesting(text, path);
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& e) {
    fail("{}:{}: expected valid JSON, but it is truncated or wrong at byte {}; write the file again", path,
         line_of(text, e.byte), e.byte);
  } catch (const nlohmann::json::out_of_range& e) {  // its message ends with the number in quotes
    const std::string_view message = e.what();
    const size_t begin = std::min(message.find('\''), message.size() - 1) + 1;
    const std::string_view number = message.substr(begin, message.find('\'', begin) - begin);
    fail("{}:{}: expected numbers below 1.8e308, got {}; write the file again", path, line_of(text, text.find(number)),
         number.substr(0, 40));
  }
}

nlohmann::ordered_json parse_json_if_sound(const std::string& text) {
  using Json = nlohmann::ordered_json;
  try {
    check_json_nesting(text, "");
  } catch (const Error&) {
    return Json(Json::value_t::discarded);
  }
  return Json::parse(text, nullptr, false);
}

}  // namespace holotrace
