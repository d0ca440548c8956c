#pragma once

#include <memory>
#include <string>

#include "holotrace/io/files/temporary_folder.h"

namespace holotrace {

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

/// Opens a URL in the browser of the desktop. The browser is in a session of its own, so that Ctrl-C in this terminal
/// does not end it.
/// @return  the file that redirects, which must live until the browser has read it; none without a desktop or a browser
std::unique_ptr<PrivateLink> open_browser(const std::string& url);

}  // namespace holotrace
