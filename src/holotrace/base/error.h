#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace holotrace {

/// The one exception of the library. Its text is one sentence: what was expected, what came,
/// where (file, line, key) and what to do.
class Error : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws an Error with a formatted sentence.
template <class... Args>
[[noreturn]] void fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(fmt::format(format, std::forward<Args>(args)...));
}

/// Throws an Error with a formatted sentence unless `holds`.
template <class... Args>
void require(bool holds, fmt::format_string<Args...> format, Args&&... args) {
  if (!holds) fail(format, std::forward<Args>(args)...);
}

}  // namespace holotrace
