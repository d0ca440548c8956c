#include "program_module.h"

#include <dlfcn.h>

#include <filesystem>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

void* load(const ProgramModule& module, const std::string& advice) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  const std::string file = fmt::format("holotrace_{}.so", module.name);
  for (const fs::path& path : {folder / file, folder / HOLOTRACE_MODULES / file}) {
    if (!is_there(path)) continue;
    void* library = dlopen(path.c_str(), module.flags);
    require(library != nullptr, "expected to load {}, got \"{}\"; {}", path.string(), dlerror(), advice);
    if (void* function = dlsym(library, module.function)) return function;
  }
  return nullptr;
}

}  // namespace holotrace
