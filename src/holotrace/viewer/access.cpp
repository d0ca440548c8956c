#include "holotrace/viewer/access.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/random.h>

#include <array>

#include "holotrace/base/error.h"

namespace holotrace {
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

// Whether a browser opens a page in a tab, not a part of another page.
bool opens_a_page(const HttpRequest& request) {
  return request.method == "GET" && request.header("sec-fetch-mode") == "navigate" &&
         request.header("sec-fetch-dest") == "document";
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
  if (is_from_elsewhere && !(opens_a_page(request) && inner_path(request).empty())) return of_another_page;
  return "";
}

}  // namespace holotrace
