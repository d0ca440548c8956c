#pragma once

#include <string_view>
#include <vector>

namespace holotrace {

/// A file of the page, as it is in page/ (embedded at build by cmake/embed_page.cmake).
struct PageFile {
  std::string_view name, type, content;
};

/// All files of the page.
const std::vector<PageFile>& page_files();

}  // namespace holotrace
