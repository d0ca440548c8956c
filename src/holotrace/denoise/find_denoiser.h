#pragma once

#include <string>

#include "holotrace/base/error.h"

namespace holotrace {

/// Pictures cannot be denoised on this machine.
class NoDenoiser : public Error {
 public:
  NoDenoiser(const std::string& sentence, bool is_broken) : Error(sentence), is_broken(is_broken) {}
  bool is_broken;  ///< a library was found, or named by HOLOTRACE_OIDN, but cannot be used
};

/// Name and version of the library that denoises pictures: "Open Image Denoise 2.5.1".
/// @throws NoDenoiser  if there is none, or none of version 2.3 to 2.x
std::string find_denoiser();

/// Names a folder in which the library is looked for, before the system's.
void look_for_denoiser_in(const std::string& folder);

}  // namespace holotrace
