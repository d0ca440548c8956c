// The server's sockets: half requests, large ones, many at once.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "holotrace/viewer/listener.h"
#include "support/temporary.h"

namespace holotrace::test {
namespace {

// A server on a free port that answers "hello" in a thread of its own.
class Server {
 public:
  explicit Server(ListenerParams params = {}, std::function<HttpAnswer(const HttpRequest&)> answer = hello)
      : listener_(std::make_unique<Listener>(params, std::move(answer))), port(listener_->port()) {
    thread_ = std::thread([this] { listener_->run([this] { return is_over_.load(); }); });
  }
  ~Server() {
    is_over_ = true;
    thread_.join();
    listener_.reset();
  }

  static HttpAnswer hello(const HttpRequest& request) { return {200, "text/plain", "hello " + request.path}; }

 private:
  std::unique_ptr<Listener> listener_;
  std::atomic<bool> is_over_ = false;
  std::thread thread_;

 public:
  const int port;
};

class Client {
 public:
  explicit Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(uint16_t(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_open = connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0;
  }
  ~Client() { close(socket_); }
  Client(const Client&) = delete;

  Client& send(const std::string& bytes) {
    size_t at = 0;
    while (at < bytes.size()) {
      const ssize_t sent = ::send(socket_, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
      if (sent <= 0) break;
      at += size_t(sent);
    }
    return *this;
  }

  // All that comes until the server ends the connection.
  std::string receive() {
    std::string all;
    char bytes[4096];
    for (ssize_t got; (got = recv(socket_, bytes, sizeof bytes, 0)) > 0;) all.append(bytes, size_t(got));
    return all;
  }

  // So many bytes, or fewer if the server ends the connection.
  std::string receive(size_t count) {
    std::string some(count, ' ');
    const ssize_t got = recv(socket_, some.data(), count, MSG_WAITALL);
    return some.substr(0, got > 0 ? size_t(got) : 0);
  }

  bool is_open = false;

 private:
  int socket_;
};

const std::string get = "GET /a HTTP/1.1\r\nHost: a\r\n\r\n";

std::string status_of(const std::string& answer) { return answer.substr(0, answer.find("\r\n")); }

TEST(Listener, Answers) {
  const Server server;
  const std::string answer = Client(server.port).send(get).receive();
  EXPECT_EQ(status_of(answer), "HTTP/1.1 200 OK");
  EXPECT_TRUE(answer.ends_with("\r\n\r\nhello /a")) << answer;
}

TEST(Listener, PutsPiecesTogether) {
  const Server server;
  Client client(server.port);
  for (const char byte : get) client.send(std::string(1, byte));
  EXPECT_EQ(status_of(client.receive()), "HTTP/1.1 200 OK");
}

TEST(Listener, SendsNoBodyAfterHead) {
  const Server server;
  const std::string answer = Client(server.port).send("HEAD /a HTTP/1.1\r\n\r\n").receive();
  EXPECT_NE(answer.find("Content-Length: 8\r\n"), std::string::npos);  // "hello /a"
  EXPECT_TRUE(answer.ends_with("\r\n\r\n"));
}

TEST(Listener, RefusesLargeHeads) {
  const Server server;
  const std::string line = "GET /a HTTP/1.1\r\nA: ", end = "\r\n\r\n";
  const size_t rest = most_head_bytes - line.size() - end.size();
  EXPECT_EQ(status_of(Client(server.port).send(line + std::string(rest, 'a') + end).receive()), "HTTP/1.1 200 OK");
  EXPECT_EQ(status_of(Client(server.port).send(line + std::string(rest + 1, 'a') + end).receive()),
            "HTTP/1.1 431 Request Header Fields Too Large");
  // A line without an end, 100 times as long as allowed, is not kept.
  EXPECT_EQ(status_of(Client(server.port).send(line + std::string(100 * most_head_bytes, 'a')).receive().substr(0, 44)),
            "HTTP/1.1 431 Request Header Fields Too Large");
}

TEST(Listener, ReadsNoBody) {
  const Server server;
  const std::string post = "POST /a HTTP/1.1\r\nContent-Length: 1000000\r\n\r\n" + std::string(1000, 'a');
  EXPECT_EQ(status_of(Client(server.port).send(post).receive()), "HTTP/1.1 413 Content Too Large");
  EXPECT_EQ(status_of(Client(server.port).send("POST /a HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n").receive()),
            "HTTP/1.1 413 Content Too Large");
}

TEST(Listener, RefusesWhatIsNoRequest) {
  const Server server;
  EXPECT_EQ(status_of(Client(server.port).send("\x16\x03\x01 hello\r\n\r\n").receive()), "HTTP/1.1 400 Bad Request");
}

TEST(Listener, EndsRequestsThatTakeTooLong) {
  const Server server({.request_seconds = 0.05});
  EXPECT_EQ(status_of(Client(server.port).send("GET / HT").receive()), "HTTP/1.1 408 Request Timeout");
}

TEST(Listener, ServesOthersBesideHalfOpenOnes) {
  const Server server({.most_connections = 8});
  std::vector<std::unique_ptr<Client>> idle;
  for (int i = 0; i < 40; ++i) {  // five times as many as may be open
    idle.push_back(std::make_unique<Client>(server.port));
    idle.back()->send("GET / HT");
  }
  EXPECT_EQ(status_of(Client(server.port).send(get).receive()), "HTTP/1.1 200 OK");
  EXPECT_EQ(idle.front()->receive(), "");  // the oldest one was closed
}

TEST(Listener, AnswersABurst) {
  std::atomic<int> now = 0, most = 0;
  const Server server({.most_connections = 8}, [&](const HttpRequest& request) {
    const int active = ++now;
    for (int before = most; before < active && !most.compare_exchange_weak(before, active);) {
    }
    HttpAnswer answer = Server::hello(request);
    --now;
    return answer;
  });
  std::atomic<int> good = 0;
  std::vector<std::thread> clients;
  for (int c = 0; c < 4; ++c)
    clients.emplace_back([&] {
      for (int i = 0; i < 250; ++i)
        if (Client(server.port).send(get).receive().ends_with("hello /a")) ++good;
    });
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(good, 1000);
  EXPECT_LE(most, 16);  // threads: twice the connections
}

// Bodies of 24 MB are larger than what sockets hold (some 6 MB), so they are sent as they are read.
TEST(Listener, CutsOffTheOldestOfManySlowReaders) {
  const std::string body(24'000'000, 'a');
  const Server server({.most_sending = 3 * body.size()}, [&](const HttpRequest&) {
    return HttpAnswer{200, "text/plain", body};
  });
  std::vector<std::unique_ptr<Client>> slow;
  for (int i = 0; i < 5; ++i) {
    slow.push_back(std::make_unique<Client>(server.port));
    slow.back()->send(get);
    EXPECT_EQ(slow.back()->receive(9), "HTTP/1.1 ");  // its answer has begun
  }
  EXPECT_LT(slow[0]->receive().size(), body.size());
  EXPECT_LT(slow[1]->receive().size(), body.size());
  for (size_t i = 2; i < slow.size(); ++i) EXPECT_GE(slow[i]->receive().size(), body.size()) << i;
}

// A page asks for small things while it downloads a large file, which alone is more than the limit.
TEST(Listener, ASmallAnswerCutsOffNoDownload) {
  const std::string body(24'000'000, 'a');
  const Server server({.most_sending = body.size() / 2}, [&](const HttpRequest& request) {
    return HttpAnswer{200, "text/plain", request.path == "/small" ? std::string(2000, 'b') : body};
  });
  Client download(server.port);
  download.send(get);
  EXPECT_EQ(download.receive(9), "HTTP/1.1 ");  // its answer has begun
  EXPECT_GE(Client(server.port).send("GET /small HTTP/1.1\r\nHost: h\r\n\r\n").receive().size(), 2000U);
  EXPECT_GE(download.receive().size(), body.size());
}

TEST(Listener, HidesTextsOfExceptions) {
  const Server server({}, [](const HttpRequest&) -> HttpAnswer { throw std::runtime_error("secret of a library"); });
  const std::string answer = Client(server.port).send(get).receive();
  EXPECT_EQ(status_of(answer), "HTTP/1.1 503 Service Unavailable");
  EXPECT_EQ(answer.find("secret"), std::string::npos);
}

TEST(Listener, NamesAPortInUse) {
  const Server server;
  const std::string port = std::to_string(server.port);
  EXPECT_EQ(error_of([&] { Listener({.port = server.port}, Server::hello); }),
            "expected to listen on 127.0.0.1 port " + port +
                ", got \"Address already in use\"; give another --port or --address");
  EXPECT_EQ(error_of([&] { Listener({.address = "example.org"}, Server::hello); }),
            "expected an address in digits, such as 127.0.0.1 or ::1, got \"example.org\"");
}

}  // namespace
}  // namespace holotrace::test
