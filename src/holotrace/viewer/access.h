#pragma once

#include <string>
#include <string_view>

#include "holotrace/viewer/http.h"

namespace holotrace {

/// 32 random bytes of the system in hexadecimal digits. @throws Error if the system gives none
std::string make_token();

/// Whether two texts are equal, in a time that depends on the length of the second alone.
bool is_equal_in_constant_time(std::string_view secret, std::string_view given);

/// Who may ask: pages of this server, by its own name, that know the token.
struct Access {
  std::string token;
  std::string address;  ///< on which the server listens, canonical
  int port = 0;

  /// Why a request is refused; "" if it is not. It is, unless
  /// - its Host is the address with the port, or "localhost" for a loopback address; for the addresses of all
  ///   interfaces, any address in digits. A name of another site that was made to lead here (DNS rebinding) is none;
  /// - its Origin and Sec-Fetch-Site, if a browser sends them, are those of this page or of a new tab. Only the page
  ///   itself may also be opened from elsewhere, as by a link;
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
