#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "holotrace/io/files/file.h"

// Texts of other programs: their first bytes, line ends and comments.

namespace holotrace {

/// The place where the text of a file begins: after its byte-order mark, if it has one.
/// @throws Error for UTF-16 and UTF-32, naming the file and the encoding
size_t begin_of_text(std::string_view bytes, const std::string& path);

/// The text of a file in UTF-8, without a byte-order mark and with "\n" at the end of each line, whether the file has
/// "\n", "\r\n" or "\r". @throws Error as begin_of_text
std::string as_lines(std::string bytes, const std::string& path);

/// The same of a file on a disk. @throws Error also as read_text
std::string read_lines(const std::string& path, uint64_t most = most_text);

/// Takes the next line off a text of as_lines, without its end. @return false at the end of the text
bool next_line(std::string_view& text, std::string_view& line);

/// Takes the next word off a line; "" at its end. Words are separated by blanks and tabs.
std::string_view next_word(std::string_view& line);

/// A text without blanks, tabs and line ends at its ends.
std::string_view trimmed(std::string_view text);

/// A text with the letters A to Z as a to z.
std::string lower_case(std::string text);

/// A line up to its first "#", which begins a comment.
std::string_view without_comment(std::string_view line);

/// A line of a table that is not empty.
struct TextRow {
  std::string where;               ///< "file:line: ", for messages
  std::string line;                ///< as it stands in the file
  std::vector<std::string> words;  ///< separated by blanks, tabs or commas, without the comment
};

/// The lines of a table. @throws Error  as read_lines does
std::vector<TextRow> read_rows(const std::string& path);

/// A name up to a "#" that stands alone, without blanks at its ends: "wood # of the floor" → "wood". Names may hold the
/// sign: "wood #2".
std::string_view name_without_comment(std::string_view line);

// Parsers of JSON and TOML call themselves for each level of nesting, and so do the functions that copy or free what
// they read. A short text of brackets would end the program by a stack overflow. So its depth is limited before.

/// Levels of brackets in a file, and parts of a dotted TOML key: many times those of any real file.
constexpr int most_nesting = 64;

/// @throws Error naming file and line if brackets outside texts are nested deeper than most_nesting
void check_json_nesting(std::string_view text, const std::string& path);

/// The same for TOML: brackets outside texts and comments, and the parts of a dotted key or heading.
void check_toml_nesting(std::string_view text, const std::string& path);

/// Parses JSON of limited nesting.
/// @param path  file that the text is from, for messages
/// @throws Error with file and line for broken JSON, for deep nesting and for numbers beyond those of a double
nlohmann::json parse_json(const std::string& text, const std::string& path);

/// JSON that may be half written or not ours: is_discarded() where it is broken or nested too deep.
nlohmann::ordered_json parse_json_if_sound(const std::string& text);

}  // namespace holotrace
