#include "holotrace/viewer/listener.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <list>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

using Clock = std::chrono::steady_clock;

Clock::time_point after(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

// Waits until a socket can be read or written. @return false at the deadline
bool wait_for(int socket, short event, Clock::time_point deadline) {
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return false;
    pollfd wanted{socket, event, 0};
    const int ready = poll(&wanted, 1, int(std::min<int64_t>(left, 60000)));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
}

bool send_all(int socket, std::string_view bytes, Clock::time_point deadline) {
  while (!bytes.empty()) {
    if (!wait_for(socket, POLLOUT, deadline)) return false;
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (sent <= 0) return false;
    bytes.remove_prefix(size_t(sent));
  }
  return true;
}

// Ends a connection so that the other side gets the whole answer: what it still sends is read for a moment.
void close_gently(int socket) {
  shutdown(socket, SHUT_WR);
  char rest[4096];
  const Clock::time_point deadline = after(0.2);
  for (size_t bytes = 0; bytes < 256 * sizeof rest;) {
    if (!wait_for(socket, POLLIN, deadline)) break;
    const ssize_t got = recv(socket, rest, sizeof rest, MSG_DONTWAIT);
    if (got <= 0) break;
    bytes += size_t(got);
  }
  close(socket);
}

struct Received {
  std::string head;
  int status = 200;  // otherwise why there is no head; 0: the other side is gone
};

Received receive_head(int socket, double seconds) {
  Received received;
  const Clock::time_point deadline = after(seconds);
  char bytes[4096];
  for (;;) {
    if (!wait_for(socket, POLLIN, deadline)) return {"", 408};
    const ssize_t got = recv(socket, bytes, sizeof bytes, MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (got <= 0) return {"", 0};
    received.head.append(bytes, size_t(got));
    if (const auto end = end_of_head(received.head)) {
      if (*end > most_head_bytes) return {"", 431};
      received.head.resize(*end);
      return received;
    }
    if (received.head.size() > most_head_bytes) return {"", 431};
  }
}

bool has_body(const HttpRequest& request) {
  const std::string length = request.header("content-length");
  return (!length.empty() && length != "0") || !request.header("transfer-encoding").empty();
}

struct Address {
  sockaddr_storage bytes{};
  socklen_t size = 0;
};

Address address_of(const ListenerParams& params) {
  Address out;
  auto& v4 = reinterpret_cast<sockaddr_in&>(out.bytes);
  auto& v6 = reinterpret_cast<sockaddr_in6&>(out.bytes);
  if (inet_pton(AF_INET, params.address.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(uint16_t(params.port));
    out.size = sizeof v4;
  } else if (inet_pton(AF_INET6, params.address.c_str(), &v6.sin6_addr) == 1) {
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(uint16_t(params.port));
    out.size = sizeof v6;
  } else {
    fail("expected an address in digits, such as 127.0.0.1 or ::1, got \"{}\"", params.address);
  }
  return out;
}

}  // namespace

struct Listener::State : std::enable_shared_from_this<State> {
  ListenerParams params;
  std::function<HttpAnswer(const HttpRequest&)> answer;
  int socket = -1, port = 0;

  struct Connection {
    int socket;
    bool is_waiting = true;  // for its request
    size_t sending = 0;      // bytes of its answer's body
  };
  std::mutex mutex;
  std::condition_variable is_less;
  std::list<Connection> open;  // oldest first
  int threads = 0;
  std::atomic<bool> is_ending{false};

  // Waits for a free place; closes the connection that waited longest for its request, if all are taken.
  void make_room() {
    std::unique_lock lock(mutex);
    if (int(open.size()) >= params.most_connections) {
      const auto idle = std::find_if(open.begin(), open.end(), [](const Connection& c) { return c.is_waiting; });
      if (idle != open.end()) ::shutdown(idle->socket, SHUT_RDWR);
    }
    is_less.wait_for(lock, std::chrono::seconds(1), [&] { return threads < 2 * params.most_connections; });
  }

  void start(int accepted) {
    std::list<Connection>::iterator place;
    bool is_full = false;
    {
      const std::lock_guard lock(mutex);
      is_full = threads >= 2 * params.most_connections;
      if (!is_full) {
        open.push_back({accepted});
        place = std::prev(open.end());
        ++threads;
      }
    }
    if (is_full) {
      close(accepted);
      return;
    }
    try {
      std::thread([self = shared_from_this(), accepted, place] {
        self->serve(accepted, place);
        const std::lock_guard lock(self->mutex);
        --self->threads;
        self->is_less.notify_all();
      }).detach();
    } catch (const std::exception&) {  // no more threads
      const std::lock_guard lock(mutex);
      open.erase(place);
      --threads;
      close(accepted);
    }
  }

  HttpAnswer answer_to(const std::string& head) {
    const std::optional<HttpRequest> request = parse_head(head);
    if (!request) return {400, "text/plain; charset=utf-8", "expected a request of HTTP/1.1\n"};
    if (has_body(*request)) return {413, "text/plain; charset=utf-8", "expected a request without a body\n"};
    if (is_ending) return {503, "text/plain; charset=utf-8", "the server ends\n"};
    try {
      return answer(*request);
    } catch (const std::exception&) {  // out of memory, or a mistake; its text may be a library's
      return {503, "text/plain; charset=utf-8", "this request could not be answered\n"};
    }
  }

  // Counts the body of an answer that is now sent. If there is too much of them, cuts off the connections that have been
  // sending longest; a small answer cuts off none.
  void begin_sending(std::list<Connection>::iterator place, size_t bytes) {
    const std::lock_guard lock(mutex);
    open.splice(open.end(), open, place);  // the newest answer
    place->sending = bytes;
    constexpr size_t small = 1 << 20;
    if (bytes < small) return;
    size_t all = 0;
    for (const Connection& connection : open) all += connection.sending;
    for (Connection& connection : open) {
      if (all <= params.most_sending || &connection == &*place) break;
      if (connection.sending == 0) continue;
      ::shutdown(connection.socket, SHUT_RDWR);
      all -= connection.sending;
      connection.sending = 0;
    }
  }

  void exchange(int accepted, std::list<Connection>::iterator place) {
    const Received received = receive_head(accepted, params.request_seconds);
    {
      const std::lock_guard lock(mutex);
      place->is_waiting = false;
    }
    if (received.status != 0) {
      const HttpAnswer made = received.status == 200 ? answer_to(received.head)
                                                     : HttpAnswer{received.status, "text/plain; charset=utf-8", "\n"};
      begin_sending(place, made.body.size());
      const Clock::time_point deadline = after(params.answer_seconds);
      const bool is_head_only = received.head.starts_with("HEAD ");
      if (send_all(accepted, head_of(made), deadline) && !is_head_only && made.status != 204)
        send_all(accepted, made.body, deadline);
    }
  }

  void serve(int accepted, std::list<Connection>::iterator place) {
    try {
      exchange(accepted, place);
    } catch (const std::exception&) {  // out of memory: the connection ends, the server does not
    }
    {
      const std::lock_guard lock(mutex);
      open.erase(place);  // before the number of the socket is free for another connection
    }
    close_gently(accepted);
  }
};

Listener::Listener(const ListenerParams& params, std::function<HttpAnswer(const HttpRequest&)> answer)
    : state_(std::make_shared<State>()) {
  State& s = *state_;
  s.params = params;
  s.answer = std::move(answer);
  const Address address = address_of(params);
  s.socket = socket(address.bytes.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  if (s.socket >= 0) setsockopt(s.socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (s.socket < 0 || bind(s.socket, reinterpret_cast<const sockaddr*>(&address.bytes), address.size) != 0 ||
      listen(s.socket, 128) != 0) {
    const std::string why = std::strerror(errno);
    if (s.socket >= 0) close(s.socket);
    fail("expected to listen on {} port {}, got \"{}\"; give another --port or --address", params.address, params.port,
         why);
  }
  Address bound;
  bound.size = sizeof bound.bytes;
  getsockname(s.socket, reinterpret_cast<sockaddr*>(&bound.bytes), &bound.size);
  s.port = ntohs(bound.bytes.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(bound.bytes).sin6_port
                                                   : reinterpret_cast<const sockaddr_in&>(bound.bytes).sin_port);
}

Listener::~Listener() {
  State& s = *state_;
  s.is_ending = true;
  close(s.socket);
  std::unique_lock lock(s.mutex);
  for (const State::Connection& connection : s.open) ::shutdown(connection.socket, SHUT_RDWR);
  s.is_less.wait(lock, [&] { return s.threads == 0; });
}

int Listener::port() const { return state_->port; }

void Listener::run(const std::function<bool()>& is_over) {
  while (!is_over()) {
    pollfd wanted{state_->socket, POLLIN, 0};
    if (poll(&wanted, 1, 100) <= 0) continue;
    const int accepted = accept4(state_->socket, nullptr, nullptr, SOCK_CLOEXEC);
    if (accepted < 0) {
      if (errno == EMFILE || errno == ENFILE) std::this_thread::sleep_for(std::chrono::milliseconds(20));
      continue;
    }
    const int yes = 1;
    setsockopt(accepted, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    state_->make_room();
    state_->start(accepted);
  }
}

}  // namespace holotrace
