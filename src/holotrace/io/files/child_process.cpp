#include "holotrace/io/files/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/sanitizers.h"

extern "C" char** environ;

namespace holotrace {
namespace {

constexpr double granted_seconds = 2, granted_bytes = double(1 << 30);  // before the child asks for more
constexpr int longest_silence = 120;  // seconds without a byte from the child: it waits for something

// The sanitizers reserve terabytes of addresses, which a limit would forbid.
constexpr bool can_limit_memory = !HOLOTRACE_ADDRESS_SANITIZER && !HOLOTRACE_THREAD_SANITIZER;

struct ChildEnded {};

class Descriptor {
 public:
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  operator int() const { return descriptor_; }
  void close() {
    if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  }

 private:
  int descriptor_;
};

struct Pipe {
  Pipe() : Pipe(make()) {}
  Descriptor read, write;

 private:
  explicit Pipe(std::array<int, 2> ends) : read(ends[0]), write(ends[1]) {}
  static std::array<int, 2> make() {
    std::array<int, 2> ends{-1, -1};
    const bool is_made = pipe2(ends.data(), O_CLOEXEC) == 0;
    require(is_made, "expected a pipe to a child process, got \"{}\"; close other programs", std::strerror(errno));
    fcntl(ends[1], F_SETPIPE_SZ, 1 << 20);  // faster; if it is refused, the pipe stays as it is
    return ends;
  }
};

void set_limit(decltype(RLIMIT_CPU) kind, double value) {
  rlimit limit{};
  getrlimit(kind, &limit);
  const auto most = limit.rlim_max == RLIM_INFINITY ? 1e18 : double(limit.rlim_max);
  limit.rlim_cur = rlim_t(std::min(value, most));
  setrlimit(kind, &limit);
}

double addresses_in_use() {
  size_t pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%zu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages > 0 ? double(pages) * double(sysconf(_SC_PAGE_SIZE)) : physical_memory();
}

// Runs in the child. Only the thread that called fork lives on there.
[[noreturn]] void run_child(pid_t parent, int data, int errors, const std::function<void(ToParent&)>& read) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it ended before
  for (const int number : {SIGINT, SIGTERM, SIGPIPE, SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU})
    std::signal(number, SIG_DFL);
  const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  dup2(nowhere, STDOUT_FILENO);  // damaged files make libraries print
  dup2(nowhere, STDERR_FILENO);
  set_limit(RLIMIT_CORE, 0);
  ToParent out(data);
  out.allow(granted_seconds, granted_bytes);
  std::string sentence;
  try {
    read(out);
    _exit(0);
  } catch (const Error& e) {
    sentence = e.what();
  } catch (...) {
    _exit(2);
  }
  sentence.resize(std::min<size_t>(sentence.size(), 4096));  // fits into the pipe without a reader
  const auto written = write(errors, sentence.data(), sentence.size());
  _exit(written < 0 ? 2 : 1);
}

std::string read_all(int pipe) {
  std::string text;
  std::array<char, 4096> block;
  for (ssize_t got; (got = read(pipe, block.data(), block.size())) != 0;) {
    if (got < 0 && errno != EINTR) break;
    if (got > 0) text.append(block.data(), size_t(got));
  }
  return text;
}

// A child that is killed, if it lives, and waited for.
class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  ~Child() {
    if (id_ <= 0) return;
    kill(id_, SIGKILL);
    wait();
  }
  Child(const Child&) = delete;
  int wait() {
    int status = 0;
    while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = -1;
    return status;
  }
  void stop() const { kill(id_, SIGKILL); }

 private:
  pid_t id_;
};

}  // namespace

void ToParent::bytes(const void* data, size_t size) {
  const char* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t written = write(pipe_, at, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) _exit(1);  // the parent has ended, or it wants no more
    at += written;
    size -= size_t(written);
  }
}

void ToParent::text(std::string_view text) {
  value(uint64_t(text.size()));
  bytes(text.data(), text.size());
}

void ToParent::allow(double seconds_of_processor, double bytes_of_memory) {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  set_limit(RLIMIT_CPU, double(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + 1 + seconds_of_processor);
  if (can_limit_memory) set_limit(RLIMIT_AS, addresses_in_use() + bytes_of_memory);
}

void FromChild::bytes(void* data, size_t size) {
  char* at = static_cast<char*>(data);
  int silence = 0;
  while (size > 0) {
    pollfd wait{pipe_, POLLIN, 0};
    if (poll(&wait, 1, 1000) == 0 && ++silence < longest_silence) continue;
    if (silence >= longest_silence) throw ChildEnded{};
    const ssize_t got = read(pipe_, at, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw ChildEnded{};
    silence = 0;
    at += got;
    size -= size_t(got);
  }
}

size_t FromChild::size(size_t bytes_of_item) {
  const auto count = value<uint64_t>();
  // A child whose memory is damaged may send any number.
  require(double(count) * double(bytes_of_item) <= physical_memory(), "expected a list that fits in memory");
  return size_t(count);
}

std::string FromChild::text() {
  std::string text(size(1), '\0');
  bytes(text.data(), text.size());
  return text;
}

void read_in_child(const std::string& path, const std::function<void(ToParent&)>& read,
                   const std::function<void(FromChild&)>& receive) {
  Pipe data, errors;
  const pid_t parent = getpid(), id = fork();
  if (id == 0) run_child(parent, data.write, errors.write, read);
  require(id > 0, "{}: expected a child process to read it in, got \"{}\"; close other programs", path,
          std::strerror(errno));
  Child child(id);
  data.write.close();
  errors.write.close();
  FromChild from(data.read);
  try {
    receive(from);
  } catch (const ChildEnded&) {
    child.stop();  // if it waits for something
    const std::string sentence = read_all(errors.read);
    if (!sentence.empty()) throw Error(sentence);
    const int status = child.wait();
    const int number = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    const bool is_limit = number == SIGXCPU || number == SIGKILL || !WIFSIGNALED(status);
    fail("{}: expected a file that can be read, but the library that reads it {}; the file is damaged, write it again",
         path, is_limit ? "reached its limit of time or memory" : fmt::format("crashed (signal {})", number));
  }
}

ProgramRun run_program(std::vector<std::string> words, const std::function<std::string_view()>& input) {
  // A socket, because a program that ends early must not end this one by SIGPIPE.
  std::array<int, 2> ends{-1, -1};
  const bool is_made = socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) == 0;
  require(is_made, "expected a pipe to a child process, got \"{}\"; close other programs", std::strerror(errno));
  Descriptor in(ends[0]), in_child(ends[1]);
  Pipe out, err;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in_child, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out.write, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.write, STDERR_FILENO);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t id = -1;
  const int error = posix_spawnp(&id, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ProgramRun run;
  if (error != 0) {
    run.start_error = std::strerror(error);
    return run;
  }
  Child child(id);
  in_child.close();
  out.write.close();
  err.write.close();
  std::string_view left;
  std::array<char, 1 << 16> block;
  const auto receive = [&](Descriptor& from, std::string& text) {
    const ssize_t got = read(from, block.data(), block.size());
    if (got > 0) text.append(block.data(), size_t(got));
    if (got == 0 || (got < 0 && errno != EINTR)) from.close();
  };
  while (out.read >= 0 || err.read >= 0) {
    std::array<pollfd, 3> ready{{{in, POLLOUT, 0}, {out.read, POLLIN, 0}, {err.read, POLLIN, 0}}};  // −1: not asked for
    if (poll(ready.data(), ready.size(), -1) < 0) continue;
    if (ready[0].revents != 0) {
      if (left.empty()) left = input();
      const ssize_t sent = left.empty() ? 0 : send(in, left.data(), left.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
      if (sent > 0) left.remove_prefix(size_t(sent));
      if (sent == 0 || (sent < 0 && errno != EAGAIN && errno != EINTR)) in.close();  // all is sent, or it wants no more
    }
    if (ready[1].revents != 0) receive(out.read, run.output);
    if (ready[2].revents != 0) receive(err.read, run.messages);
  }
  in.close();
  run.has_succeeded = child.wait() == 0;
  return run;
}

}  // namespace holotrace
