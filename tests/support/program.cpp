#include "support/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "support/build_paths.h"

namespace holotrace::test {
namespace {

namespace fs = std::filesystem;

fs::path make_folder(const char* name) {
  std::string pattern = (fs::temp_directory_path() / (std::string(name) + "-XXXXXX")).string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder can be made");
  return pattern;
}

// For the child process: starts the program in `folder`, after the words of a launcher, with these descriptors
// for its output. Never returns.
[[noreturn]] void become_program(const std::vector<std::string>& launcher, const std::vector<std::string>& arguments,
                                 const fs::path& folder, const fs::path& cache, int out, int err) {
  std::vector<char*> argv;
  for (const std::string& word : launcher) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(const_cast<char*>(HOLOTRACE_PROGRAM));
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const int in = open("/dev/null", O_RDONLY);
  signal(SIGINT, SIG_DFL);  // the tests' own shell may ignore it, and a child would too
  if (chdir(folder.c_str()) == 0 && setenv("XDG_CACHE_HOME", cache.c_str(), 1) == 0 && dup2(in, STDIN_FILENO) >= 0 &&
      dup2(out, STDOUT_FILENO) >= 0 && dup2(err, STDERR_FILENO) >= 0)
    execvp(argv.front(), argv.data());
  _exit(127);
}

// Reads both pipes to their ends, so that neither fills up and blocks the program.
void drain(int out, int err, Outcome& outcome) {
  std::array<pollfd, 2> pipes{{{out, POLLIN, 0}, {err, POLLIN, 0}}};
  const std::array<std::string*, 2> texts{&outcome.out, &outcome.err};
  for (int open_pipes = 2; open_pipes > 0;) {
    if (poll(pipes.data(), pipes.size(), -1) < 0 && errno != EINTR) break;
    for (size_t i = 0; i < pipes.size(); ++i) {
      if (pipes[i].fd < 0 || pipes[i].revents == 0) continue;
      std::array<char, 4096> block;
      const ssize_t count = ::read(pipes[i].fd, block.data(), block.size());
      if (count > 0) {
        texts[i]->append(block.data(), size_t(count));
        continue;
      }
      close(pipes[i].fd);
      pipes[i].fd = -1;
      --open_pipes;
    }
  }
}

// PoCL takes seconds to compile a kernel, and keeps it in a cache of its own. All tests share that of the user.
void share_cache_of_pocl() {
  const char *cache = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
  const fs::path folder = cache && *cache ? fs::path(cache) : home && *home ? fs::path(home) / ".cache" : fs::path();
  if (!folder.empty()) setenv("POCL_CACHE_DIR", (folder / "pocl" / "kcache").c_str(), 0);
}

}  // namespace

Workplace::Workplace() : folder_(make_folder("holotrace")), cache_(make_folder("holotrace-cache")) {
  share_cache_of_pocl();
  // Two launchers of Open MPI that start at the same time may both make, and one fail on, the folder of their sessions.
  setenv("OMPI_MCA_orte_tmpdir_base", cache_.c_str(), 1);
}

Workplace::~Workplace() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
  fs::remove_all(cache_, ignored);
}

std::string Workplace::read(const std::string& name) const { return bytes_of(path(name)); }

std::string Workplace::write(const std::string& name, const std::string& bytes) const {
  fs::create_directories((folder_ / name).parent_path());
  std::ofstream(folder_ / name, std::ios::binary) << bytes;
  return path(name);
}

std::set<std::string> Workplace::names() const {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder_))
    names.insert(fs::relative(entry.path(), folder_).string());
  return names;
}

void Workplace::clear_cache() const {
  fs::remove_all(cache_);
  fs::create_directories(cache_);
}

Outcome Workplace::run(const std::vector<std::string>& arguments) const { return run_under({}, arguments); }

Outcome Workplace::run_under(const std::vector<std::string>& launcher,
                             const std::vector<std::string>& arguments) const {
  int out[2], err[2];
  if (pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0) throw std::runtime_error("no pipe can be made");
  const pid_t child = fork();
  if (child == 0) become_program(launcher, arguments, folder_, cache_, out[1], err[1]);
  close(out[1]);
  close(err[1]);
  Outcome outcome;
  drain(out[0], err[0], outcome);
  int status = 0;
  waitpid(child, &status, 0);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

pid_t Workplace::start(const std::vector<std::string>& arguments) const { return start_under({}, arguments); }

pid_t Workplace::start_under(const std::vector<std::string>& launcher,
                             const std::vector<std::string>& arguments) const {
  const pid_t child = fork();
  if (child == 0) {
    const int nowhere = open("/dev/null", O_WRONLY);
    become_program(launcher, arguments, folder_, cache_, nowhere, nowhere);
  }
  return child;
}

void expect_success(const Workplace& work, const std::vector<std::string>& arguments) {
  const Outcome outcome = work.run(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

void expect_quiet_success(const Workplace& work, const std::vector<std::string>& arguments) {
  const Outcome outcome = work.run(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << "expected a file at " << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace holotrace::test
