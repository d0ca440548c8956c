#include "program_module.h"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

namespace {

namespace fs = std::filesystem;

// The folders in which modules may be: that of a build, of an installation, and of the Python package, beside a wheel's
// holotrace.scripts/holotrace or in the packages of an environment's bin/holotrace.
std::vector<fs::path> module_folders() {
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path(), above = program.parent_path();
  std::vector<fs::path> folders{program, program / HOLOTRACE_MODULES, above / "holotrace"};
  std::error_code ignored;
  for (fs::directory_iterator i(above / "lib", ignored), end; !ignored && i != end; i.increment(ignored))
    folders.push_back(i->path() / "site-packages" / "holotrace");
  return folders;
}

}  // namespace

void* load(const ProgramModule& module, const std::string& advice) {
  const std::string file = fmt::format("holotrace_{}.so", module.name);
  for (const fs::path& folder : module_folders()) {
    const fs::path path = folder / file;
    if (!is_there(path)) continue;
    void* library = dlopen(path.c_str(), module.flags);
    require(library != nullptr, "expected to load {}, got \"{}\"; {}", path.string(), dlerror(), advice);
    if (void* function = dlsym(library, module.function)) return function;
  }
  return nullptr;
}

}  // namespace holotrace
