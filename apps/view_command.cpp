// holotrace view: holograms in a browser, live.

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "commands.h"
#include "console.h"
#include "flags.h"
#include "holotrace/base/aligned_memory.h"
#include "holotrace/base/error.h"
#include "holotrace/io/files/folders.h"
#include "holotrace/io/mesh/mesh_file.h"
#include "holotrace/viewer/answers.h"
#include "holotrace/viewer/listener.h"
#include "monitor.h"
#include "panel_image_flags.h"

namespace holotrace {
namespace {

/// HTML file, readable by this user alone, that redirects a browser to a URL. Other users see the arguments of programs,
/// and the URL holds the token of the viewer; so a browser is given the path of this file. It is removed with this object.
class PrivateLink {
 public:
  /// @throws Error  if there is no place for temporary files
  explicit PrivateLink(const std::string& url);

  const std::string& path() const { return path_; }

 private:
  TemporaryFolder folder_;
  std::string path_;
};

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

/// Opens a URL in the browser of the desktop. The browser is in a session of its own, so that Ctrl-C in this terminal
/// does not end it.
/// @return  the file that redirects, which must live until the browser has read it; none without a desktop or a browser
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

bool is_scene_file(const std::string& path) { return extension_of(path) == ".toml" || is_mesh_file(path); }

volatile std::sig_atomic_t is_stopped = 0;

// Ctrl-C ends the server, which is how it is meant to end, and so does closing the terminal; a second one ends the program
// at once.
void stop_on_interrupt() {
  struct sigaction action {};
  action.sa_handler = [](int) { is_stopped = 1; };
  action.sa_flags = int(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGHUP, &action, nullptr);
}

// Whether standard input is at its end. A pipe is when the process that holds its other side has ended, however that was.
bool has_input_ended() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char rest[256];
  return poll(&input, 1, 0) > 0 && read(STDIN_FILENO, rest, sizeof rest) <= 0;
}

// Seconds from a time with its unit: "30 min", "10 s", "2 h".
double parse_idle(const std::string& text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const std::string unit = text.substr(text.find_first_not_of(' ', size_t(end - text.data())) == std::string::npos
                                           ? text.size()
                                           : text.find_first_not_of(' ', size_t(end - text.data())));
  const double seconds = unit == "s" ? number : unit == "min" ? 60 * number : unit == "h" ? 3600 * number : 0;
  require(error == std::errc() && seconds >= 1 && seconds <= 1e7,
          "--idle: expected a time of 1 s or more with its unit (s, min or h), got \"{}\"", text);
  return seconds;
}

/// The holograms of a session on the monitor output of a panel, in a thread of its own, as long as this object lives.
class PanelMonitor {
 public:
  PanelMonitor(Session& session, int monitor) : session_(session) {
    renew_pictures();
    job_.monitor = monitor - 1;
    job_.is_over = [] { return is_stopped != 0; };
    job_.context = this;
    job_.renew = [](void* context, DisplayJob* job) {
      PanelMonitor& self = *static_cast<PanelMonitor*>(context);
      try {
        if (!self.renew_pictures()) return false;
      } catch (const Error&) {  // of more levels than a monitor has: the last ones stay
        return false;
      }
      job->pictures = self.job_.pictures;
      job->colours = self.job_.colours;
      return true;
    };
    thread_ = std::thread([this] {
      try {
        show_on_monitor(job_);
      } catch (const Error& error) {
        say("holotrace: {}\n", error.what());
      }
      is_stopped = 1;  // the panel was closed, or cannot be shown
    });
  }
  ~PanelMonitor() { thread_.join(); }

 private:
  // Takes the holograms of the last picture. @return whether there are others
  bool renew_pictures() {
    const auto shown = session_.shown();
    if (shown == shown_) return false;
    shown_ = shown;
    std::vector<Hologram> holograms;
    for (const ViewedItem& item : shown->items) holograms.push_back(item.hologram);
    pictures_ = MonitorPictures(PanelImageFlags().images(holograms, ""));
    pictures_.put_into(job_);
    return true;
  }

  Session& session_;
  std::shared_ptr<const Contents> shown_;
  MonitorPictures pictures_{{}};
  DisplayJob job_;
  std::thread thread_;
};

void check_port(int port) { check_flag("--port", port, range::from_to(0, 65535), Quantity::count); }

}  // namespace

void add_view_command(CLI::App& app, const GlobalFlags& global) {
  CLI::App* command = app.add_subcommand("view", "page in the browser that shows holograms live: focus, eye, effects");
  struct Options {
    std::vector<std::string> paths;
    std::string slm, address = "127.0.0.1", idle = "30 min";
    int port = 0, monitor = 0;
    bool has_no_browser = false, is_embedded = false, is_live = false;
    Flags flags;
  };
  auto o = std::make_shared<Options>();
  command
      ->add_option(
          "paths", o->paths,
          "folder that holotrace run writes or has written; or holograms (.png, .bmp, .tif, .npy, .csv); or a field (.npy, .h5, .exr), "
          "sources (.ply) or a scene (.toml)")
      ->required()
      ->type_name("PATH");
  add_slm(*command, o->slm, "the hologram's, or pluto");
  command->add_flag(
      "--live", o->is_live,
      "let places, lights, colours and all other numbers of a scene or a model be changed in the page; its "
      "hologram follows: a draft while something moves, then all waves, then optimised frames");
  command
      ->add_option("--monitor", o->monitor,
                   "with --live: monitor to which the panel is connected, from 1; it shows the holograms of the page")
      ->type_name("N");
  command->add_option("--port", o->port, "port of the server; 0: one that is free [0]")->type_name("N");
  command->add_flag("--no-browser", o->has_no_browser, "only print the address of the page, open no browser");
  command->add_flag(
      "--embed", o->is_embedded,
      "allow pages of this machine, such as notebooks, to show the page in a frame; end the server when standard "
      "input ends, as it does with the program that started it");
  command
      ->add_option("--address", o->address,
                   "address in digits on which the server listens; one that other machines reach lets everybody who "
                   "knows the printed URL see these files [127.0.0.1]")
      ->type_name("ADDRESS");
  command->add_option("--idle", o->idle, "time without use after which the server ends [30 min]")->type_name("TIME");
  add_hologram_flags(*command, o->flags);
  command->callback([o, &global] {
    check_port(o->port);
    const double idle_seconds = parse_idle(o->idle);
    Console console(global.is_quiet);
    if (o->monitor != 0) check_flag("--monitor", o->monitor, range::at_least(1), Quantity::count);
    require(o->monitor == 0 || o->is_live,
            "expected --live beside --monitor; to show files on a panel, use holotrace display");
    require(!o->is_live || (o->paths.size() == 1 && is_scene_file(o->paths.front())),
            "expected one scene .toml or model to view live, got {}; leave out --live", o->paths.front());
    Session session(o->paths, {o->slm, global.outside(), o->is_live, console.stages(), o->flags.texts()});
    console.finish();
    if (const std::string why = session.why_empty(); !why.empty()) fail("{}", why);
    std::unique_ptr<Answers> answers;
    ListenerParams params;
    const std::string address = canonical_address(o->address);
    params.address = address;
    params.port = o->port;
    std::atomic<bool> is_ready = false;
    Listener listener(params, [&](const HttpRequest& request) {
      return is_ready ? (*answers)(request) : HttpAnswer{503, "text/plain; charset=utf-8", "not yet ready\n"};
    });
    const Access access{make_token(), address, listener.port(), o->is_embedded};
    answers = std::make_unique<Answers>(session, access);
    is_ready = true;
    if (!is_loopback(address))
      say("warning: the server listens on {}: everybody on that network who knows the URL sees these files, and the URL "
          "travels without encryption; prefer an SSH tunnel (ssh -L) to the default address\n",
          address);
    stop_on_interrupt();
    const std::string host = address.find(':') == std::string::npos ? address : "[" + address + "]";
    const std::string url = fmt::format("http://{}:{}/{}/", host, listener.port(), access.token);
    fmt::print("{}\n", url);
    std::fflush(stdout);
    if (!global.is_quiet) say("holotrace: {}; Ctrl-C ends the server\n", session.memory_text());
    std::unique_ptr<PrivateLink> link = o->has_no_browser ? nullptr : open_browser(url);
    std::optional<PanelMonitor> monitor;
    if (o->monitor > 0) monitor.emplace(session, o->monitor);
    // Each picture needs arrays of the same sizes as the last one: memory that is kept is ready, new memory must be cleared.
    keep_freed_memory(std::max(most_kept_memory(), size_t(256) << 20));
    listener.run([&] {
      return is_stopped != 0 || answers->idle_seconds() > idle_seconds || (o->is_embedded && has_input_ended());
    });
    is_stopped = 1;
    monitor.reset();
    link.reset();
    std::_Exit(0);  // at once: nobody waits for the pictures that are being computed
  });
}

}  // namespace holotrace
