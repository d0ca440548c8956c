#pragma once

#include <string>
#include <string_view>

namespace holotrace {

/// A parameter that has a new name. Its old key in a scene file and its old flag are still read, with a warning.
struct RenamedParameter {
  const char* section;  ///< of the scene file
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

/// The old name of the parameter of that name, nullptr where it always had this one.
constexpr const char* name_before(std::string_view now) {
  for (const RenamedParameter& one : renamed_parameters)
    if (now == one.now) return one.before;
  return nullptr;
}

/// The warning that an old name was used, of a key or of a flag.
inline std::string renamed_message(const std::string& before, const std::string& now) {
  return "`" + before + "` is now called `" + now + "`; the old name is still read";
}

}  // namespace holotrace
