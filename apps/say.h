#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/printable.h"

namespace holotrace {

/// Prints on standard error. A message that cannot be written, because a disk is full or a terminal is gone, is lost: it
/// ends no work.
template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  std::fputs(fmt::format(format, std::forward<Args>(args)...).c_str(), stderr);
}

/// Prints warnings on standard error.
inline void say_warnings(const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) say("warning: {}\n", printable(sentence));
}

}  // namespace holotrace
