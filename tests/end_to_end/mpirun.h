#pragma once

#include <sys/types.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "support/program.h"

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

inline std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> children;
  const std::string tasks = "/proc/" + std::to_string(parent) + "/task";
  std::error_code gone;
  for (const auto& task : std::filesystem::directory_iterator(tasks, gone)) {
    std::ifstream list(task.path() / "children");
    for (pid_t child; list >> child;) children.push_back(child);
  }
  return children;
}

/// The process of a rank, from the environment set by its launcher; 0 if there is none yet.
inline pid_t process_of_rank(pid_t launcher, int rank) {
  for (const pid_t child : children_of(launcher)) {
    const std::string told = bytes_of("/proc/" + std::to_string(child) + "/environ");
    if (told.find("OMPI_COMM_WORLD_RANK=" + std::to_string(rank) + '\0') != std::string::npos) return child;
  }
  return 0;
}

}  // namespace holotrace::test
