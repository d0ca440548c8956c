#pragma once

#include <string>

namespace holotrace {

/// A parameter that a job did not give, and what was chosen for it.
struct Chosen {
  std::string parameter;  ///< as in scene files, such as "encode.method"
  std::string value;      ///< as in scene files
  std::string why;        ///< half a sentence
};

}  // namespace holotrace
