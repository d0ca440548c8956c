#include "holotrace/io/files/shipped_files.h"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "holotrace/io/files/file.h"

namespace holotrace {

namespace fs = std::filesystem;

std::vector<std::string> shipped_folders(const std::string& name) {
  std::vector<fs::path> wanted;
  std::error_code ignored;
  Dl_info library{};  // the program, or a shared library such as the module of the Python package
  if (dladdr(reinterpret_cast<const void*>(&shipped_folders), &library) != 0 && library.dli_fname)
    wanted.push_back(fs::path(library.dli_fname).parent_path());
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  if (!program.empty()) {
    const fs::path above = program.parent_path().parent_path();
    wanted.push_back(above / "share" / "holotrace");
    wanted.push_back(above / "holotrace");  // a program beside the Python package
  }
  wanted.emplace_back(HOLOTRACE_DATA_INSTALLED);
  wanted.emplace_back(HOLOTRACE_DATA_SOURCE);
  std::vector<std::string> folders;
  for (const fs::path& place : wanted)
    if (!place.empty() && is_folder(place / name)) folders.push_back((place / name).string());
  return folders;
}

}  // namespace holotrace
