#pragma once

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace holotrace::test {

inline bool has_mpirun() {
  std::stringstream folders(std::getenv("PATH") ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (std::filesystem::exists(std::filesystem::path(folder) / "mpirun")) return true;
  return false;
}

/// The launcher of ranks. Options that allow root, as in containers, and fewer cores than ranks. Leaks in the MPI library are ignored.
inline std::vector<std::string> mpirun(int ranks) {
  return {"env", "ASAN_OPTIONS=detect_leaks=0", "mpirun", "--allow-run-as-root", "--oversubscribe",
          "-n",  std::to_string(ranks)};
}

}  // namespace holotrace::test
