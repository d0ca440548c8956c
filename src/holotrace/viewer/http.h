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
  std::string file_name{};  ///< for a download
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

}  // namespace holotrace
