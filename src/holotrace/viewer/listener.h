#pragma once

#include <functional>
#include <memory>
#include <string>

#include "holotrace/viewer/http.h"

namespace holotrace {

/// Bounds of a server.
struct ListenerParams {
  std::string address = "127.0.0.1";  ///< in digits
  int port = 0;                       ///< 0: one that is free
  int most_connections = 64;          ///< at once; beyond them, the one that waited longest for its request is closed
  double request_seconds = 5;         ///< time to send a request
  double answer_seconds = 60;         ///< time to receive the answer
  size_t most_sending =
      size_t(256) << 20;  ///< bytes of all bodies on their way; beyond them, the oldest one is cut off
};

/// Answers HTTP requests, each in a thread of its own, while run() runs. Memory is bounded: the head of a request has at
/// most most_head_bytes, there are at most most_connections of them, and a body is never read. The bodies of answers that clients
/// read slowly have at most most_sending bytes, and the newest one.
class Listener {
 public:
  /// @param answer  called from several threads
  /// @throws Error  if the address is none of this machine, or the port is in use
  Listener(const ListenerParams& params, std::function<HttpAnswer(const HttpRequest&)> answer);
  ~Listener();  ///< closes what is open, and waits for the threads
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  int port() const;

  /// Accepts connections until `is_over` returns true; it is asked ten times a second.
  void run(const std::function<bool()>& is_over);

 private:
  struct State;
  std::shared_ptr<State> state_;  // also of its threads
};

}  // namespace holotrace
