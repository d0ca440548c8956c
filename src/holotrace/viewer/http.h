#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace holotrace {

// The part of HTTP/1.1 (RFC 9112) that a page of our own needs: requests without a body, one for each connection.

/// Bytes that the head of a request may have: the request line and all headers.
inline constexpr size_t most_head_bytes = 16384;

/// A request. Names of headers are in lower case.
struct HttpRequest {
  std::string method, path, query;  ///< path: "/…", not decoded; query: the text after "?"
  std::map<std::string, std::string> headers;

  /// The value of a header; "" if there is none.
  std::string header(const std::string& name) const;
};

/// An answer: a status, the kind of its body, and the body.
struct HttpAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  std::string file_name{};     ///< for a download
  bool may_be_framed = false;  ///< by other pages of this machine, such as notebooks
};

/// The end of the head in what was received; nothing if it is not complete.
std::optional<size_t> end_of_head(std::string_view received);

/// Reads a head, with its empty line.
/// @return nothing if it is not well formed: a request line of three words, a path that begins with "/", lines that end
///         with CR LF, names and values of printable ASCII, no folded line, and no header twice that is used here
std::optional<HttpRequest> parse_head(std::string_view head);

/// The head of an answer: the status, the length of the body, and headers that keep the page to itself. Nothing is
/// cached; scripts, styles and pictures come from this server alone.
std::string head_of(const HttpAnswer& answer);

/// 32 random bytes of the system in hexadecimal digits. @throws Error if the system gives none
std::string make_token();

/// Whether two texts are equal, in a time that depends on the length of the second alone.
bool is_equal_in_constant_time(std::string_view secret, std::string_view given);

/// Who may ask: pages of this server, by its own name, that know the token.
struct Access {
  std::string token;
  std::string address;  ///< on which the server listens, canonical
  int port = 0;
  bool allows_frames = false;  ///< whether the page may also be opened in a frame (HttpAnswer::may_be_framed)

  /// Why a request is refused; "" if it is not. It is, unless
  /// - its Host is the address with the port, or "localhost" for a loopback address; for the addresses of all
  ///   interfaces, any address in digits. A name of another site that was made to lead here (DNS rebinding) is none;
  /// - its Origin and Sec-Fetch-Site, if a browser sends them, are those of this page or of a new tab. Only the page
  ///   itself may also be opened from elsewhere, as by a link or, where they are allowed, in a frame;
  /// - its path begins with "/TOKEN/".
  std::string refusal(const HttpRequest& request) const;

  /// The path after "/TOKEN/".
  std::string inner_path(const HttpRequest& request) const { return request.path.substr(token.size() + 2); }
};

/// An address in digits as the system writes it: "::1" for "0:0:0:0:0:0:0:1". Other texts are not changed.
std::string canonical_address(const std::string& address);

/// Whether an address in digits is one of this machine alone: 127.0.0.0/8 or ::1.
bool is_loopback(const std::string& address);

}  // namespace holotrace
