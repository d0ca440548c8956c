#pragma once

#include <string>

#include "support/build_paths.h"

namespace holotrace::test {

/// The folder of models and pictures for the tests; its README describes each.
inline std::string data_folder() { return HOLOTRACE_SOURCE_DIR "/tests/data_files"; }

inline std::string data_file(const std::string& name) { return data_folder() + "/" + name; }

}  // namespace holotrace::test
