#include "open_browser.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <unistd.h>

#include <cstdlib>

#include "holotrace/base/error.h"
#include "say.h"

namespace holotrace {

PrivateLink::PrivateLink(const std::string& url) : folder_("holotrace_view"), path_(folder_.path() + "/open.html") {
  const std::string text = fmt::format(
      "<!doctype html><meta charset=\"utf-8\"><title>Holotrace viewer</title>"
      "<meta name=\"referrer\" content=\"no-referrer\"><meta http-equiv=\"refresh\" content=\"0; url={0}\">"
      "<a href=\"{0}\">Holotrace viewer</a>\n",
      url);
  const int file = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  const bool is_written = file >= 0 && write(file, text.data(), text.size()) == ssize_t(text.size());
  if (file >= 0) close(file);
  require(is_written, "expected to write {}, but it cannot be written", path_);
}

std::unique_ptr<PrivateLink> open_browser(const std::string& url) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return nullptr;
  std::unique_ptr<PrivateLink> link;
  try {
    link = std::make_unique<PrivateLink>(url);
  } catch (const Error& error) {
    say("holotrace: {}; open the address by hand\n", error.what());
    return nullptr;
  }
  std::string program = "xdg-open", page = link->path();
  char* arguments[] = {program.data(), page.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  pid_t child = 0;
  if (posix_spawnp(&child, program.c_str(), &actions, &attributes, arguments, environ) != 0) {
    say("holotrace: no program xdg-open; open the address by hand\n");
    link.reset();
  }
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return link;
}

}  // namespace holotrace
