#include "holotrace/viewer/http.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

constexpr std::string_view line_end = "\r\n", head_end = "\r\n\r\n";

const char* reason(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 204:
      return "No Content";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 408:
      return "Request Timeout";
    case 413:
      return "Content Too Large";
    case 431:
      return "Request Header Fields Too Large";
    case 503:
      return "Service Unavailable";
    default:
      return "Error";
  }
}

bool is_printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return (c >= ' ' && c <= '~') || c == '\t'; });
}

// A token of RFC 9110: the name of a method or a header.
bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
  });
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return out;
}

bool read_request_line(std::string_view line, HttpRequest& request) {
  const size_t first = line.find(' '), last = line.rfind(' ');
  if (first == std::string_view::npos || last == first) return false;
  const std::string_view method = line.substr(0, first), target = line.substr(first + 1, last - first - 1);
  const std::string_view version = line.substr(last + 1);
  if (!is_token(method) || (version != "HTTP/1.1" && version != "HTTP/1.0")) return false;
  if (target.empty() || target.front() != '/' || target.find(' ') != std::string_view::npos || !is_printable(target))
    return false;
  request.method = method;
  const size_t mark = std::min(target.find('?'), target.size());
  request.path = target.substr(0, mark);
  request.query = mark < target.size() ? target.substr(mark + 1) : "";
  return true;
}

bool read_header(std::string_view line, HttpRequest& request) {
  const size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon)) || !is_printable(line)) return false;
  const std::string name = lower(line.substr(0, colon));
  const bool is_new = request.headers.emplace(name, trimmed(line.substr(colon + 1))).second;
  return is_new || (name != "host" && name != "origin" && name != "content-length");
}

}  // namespace

std::string HttpRequest::header(const std::string& name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? "" : found->second;
}

std::optional<size_t> end_of_head(std::string_view received) {
  const size_t at = received.find(head_end);
  return at == std::string_view::npos ? std::nullopt : std::optional(at + head_end.size());
}

std::optional<HttpRequest> parse_head(std::string_view head) {
  HttpRequest request;
  bool is_first = true;
  for (size_t at = 0; at < head.size();) {
    const size_t end = head.find(line_end, at);
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view line = head.substr(at, end - at);
    at = end + line_end.size();
    if (line.empty()) return is_first || at != head.size() ? std::nullopt : std::optional(request);
    if (!(is_first ? read_request_line(line, request) : read_header(line, request))) return std::nullopt;
    is_first = false;
  }
  return std::nullopt;
}

std::string head_of(const HttpAnswer& answer) {
  std::string head = fmt::format("HTTP/1.1 {} {}\r\n", answer.status, reason(answer.status));
  if (answer.status != 204)
    head += fmt::format("Content-Type: {}\r\nContent-Length: {}\r\n", answer.type, answer.body.size());
  if (!answer.file_name.empty())
    head += fmt::format("Content-Disposition: attachment; filename=\"{}\"\r\n", answer.file_name);
  // A page that frames another one can lay something over it and catch clicks that are meant for it. So nobody frames this
  // page, unless its user has asked for that; then pages do that come from this machine: of a notebook server, or of an
  // editor that shows notebooks. Elsewhere on the network, a page can be anybody's.
  head += fmt::format(
      "Connection: close\r\n"
      "Cache-Control: no-store\r\n"
      "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
      "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors {}\r\n",
      answer.may_be_framed ? "http://localhost:* http://127.0.0.1:* vscode-webview: vscode-file:" : "'none'");
  head +=
      "Cross-Origin-Opener-Policy: same-origin\r\n"
      "Cross-Origin-Resource-Policy: same-origin\r\n"
      "Referrer-Policy: no-referrer\r\n"
      "X-Content-Type-Options: nosniff\r\n\r\n";
  return head;
}

namespace {

// "127.0.0.1:8080" and "[::1]:8080" without the port; "" if it is another port. Browsers leave out port 80.
std::string name_in_host(const std::string& host, int port) {
  const std::string ending = fmt::format(":{}", port);
  const bool has_port = host.ends_with(ending);
  if (!has_port && (port != 80 || (host.find(':') != std::string::npos && !host.ends_with(']')))) return "";
  std::string name = has_port ? host.substr(0, host.size() - ending.size()) : host;
  if (name.size() > 2 && name.front() == '[' && name.back() == ']') name = name.substr(1, name.size() - 2);
  return name;
}

bool is_in_digits(const std::string& name) {
  std::array<unsigned char, 16> bytes{};
  return inet_pton(AF_INET, name.c_str(), bytes.data()) == 1 || inet_pton(AF_INET6, name.c_str(), bytes.data()) == 1;
}

constexpr const char* of_another_page =
    "this server answers only to its own page; open the URL that holotrace view printed";

// Whether a browser opens a page in a tab, or in a frame where that is allowed, not a part of another page.
bool opens_a_page(const HttpRequest& request, bool allows_frames) {
  const std::string place = request.header("sec-fetch-dest");
  return request.method == "GET" && request.header("sec-fetch-mode") == "navigate" &&
         (place == "document" || (allows_frames && place == "iframe"));
}

}  // namespace

std::string make_token() {
  std::array<unsigned char, 32> bytes{};
  require(getrandom(bytes.data(), bytes.size(), 0) == ssize_t(bytes.size()),
          "expected random numbers of the system for the address of the page, got none");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool is_equal_in_constant_time(std::string_view secret, std::string_view given) {
  unsigned difference = secret.size() == given.size() ? 0 : 1;
  for (size_t i = 0; i < given.size(); ++i)
    difference |= static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(i < secret.size() ? secret[i] : 0);
  return difference == 0;
}

std::string canonical_address(const std::string& address) {
  std::array<unsigned char, 16> bytes{};
  std::array<char, INET6_ADDRSTRLEN> text{};
  for (const int family : {AF_INET, AF_INET6})
    if (inet_pton(family, address.c_str(), bytes.data()) == 1)
      return inet_ntop(family, bytes.data(), text.data(), text.size());
  return address;
}

bool is_loopback(const std::string& address) { return address.starts_with("127.") || address == "::1"; }

std::string Access::refusal(const HttpRequest& request) const {
  const std::string host = request.header("host"), name = canonical_address(name_in_host(host, port));
  const bool is_any = address == "0.0.0.0" || address == "::";
  if (name.empty() ||
      !(name == address || (is_loopback(address) && name == "localhost") || (is_any && is_in_digits(name))))
    return "this server answers only to its own address; open the URL that holotrace view printed";
  const std::string origin = request.header("origin"), site = request.header("sec-fetch-site");
  if (!origin.empty() && origin != "http://" + host) return of_another_page;
  const std::string& path = request.path;
  const size_t end = path.find('/', 1);
  const std::string_view given = std::string_view(path).substr(1, end == std::string::npos ? path.npos : end - 1);
  if (!is_equal_in_constant_time(token, given) || end == std::string::npos)
    return "the address lacks the right token; open the URL that holotrace view printed";
  const bool is_from_elsewhere = !site.empty() && site != "same-origin" && site != "none";
  if (is_from_elsewhere && !(opens_a_page(request, allows_frames) && inner_path(request).empty()))
    return of_another_page;
  return "";
}

}  // namespace holotrace
