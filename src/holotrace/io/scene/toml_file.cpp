#include "holotrace/io/scene/toml_file.h"

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/nesting.h"

namespace holotrace {

toml::table parse_toml(const std::string& path, const char* kind) {
  check_file_exists(path, kind);
  const std::string text = read_text(path, most_text);
  check_toml_nesting(text, path);
  try {
    return toml::parse(text, path);
  } catch (const toml::parse_error& e) {
    const auto at = e.source().begin;
    fail("{}:{}:{}: expected valid TOML, but: {}", path, at.line, at.column, e.description());
  }
}

}  // namespace holotrace
