#include "holotrace/io/files/text_lines.h"

#include <algorithm>
#include <cctype>

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

std::string_view name_without_comment(std::string_view line) {
  std::string_view rest = line;
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest))
    if (word == "#") return trimmed(line.substr(0, size_t(word.data() - line.data())));
  return trimmed(line);
}

}  // namespace holotrace
