#pragma once

#include <string>
#include <string_view>

namespace holotrace {

/// A parameter that has a new name. Its old key in scene files and its old flag can still be used, with a warning.
struct RenamedParameter {
  const char* section;  ///< table of the scene file
  const char* before;
  const char* now;
};

/// All parameters that had another name in an earlier version.
inline constexpr RenamedParameter renamed_parameters[] = {
    {"show", "moments", "illumination_states"},
    {"trace", "layers", "path_expressions"},
    {"trace", "separate_layers", "separate_path_groups"},
    {"render", "layers", "path_expressions"},
};

/// The old name of a parameter; nullptr if it was never renamed.
constexpr const char* name_before(std::string_view now) {
  for (const RenamedParameter& one : renamed_parameters)
    if (now == one.now) return one.before;
  return nullptr;
}

/// The warning for the use of an old name, as a key or as a flag.
inline std::string renamed_message(const std::string& before, const std::string& now) {
  return "`" + before + "` is now called `" + now + "`; the old name is still read";
}

}  // namespace holotrace
