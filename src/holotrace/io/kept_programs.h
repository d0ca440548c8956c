#pragma once

#include <optional>
#include <string>

namespace holotrace {

// What drivers of OpenCL compiled (opencl/program_store.h), in the folder opencl/ of the user's cache. Without a cache
// folder nothing is kept.

/// The program that was kept for that key; none if there is none, its file is damaged, or another user could have
/// written it.
std::optional<std::string> load_kept_program(const std::string& key);

void keep_program(const std::string& key, const std::string& binary);

/// Keeps the messages of a compiler that refused a kernel, in place of earlier ones.
/// @return  the path of their file; "" if they could not be written
std::string keep_compiler_log(const std::string& log);

}  // namespace holotrace
