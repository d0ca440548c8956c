#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "holotrace/base/error.h"

// What all fuzz targets share: inputs become files, and an Error is the only exception that a reader may throw.

namespace holotrace::fuzz {

/// A folder of this process, in memory where the system has such a place.
inline const std::string& folder() {
  static const std::string path = [] {
    std::string name = std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : "/tmp";
    name += "/holotrace_fuzz_" + std::to_string(getpid());
    std::filesystem::create_directories(name);
    std::atexit([] { std::filesystem::remove_all(folder()); });
    return name;
  }();
  return path;
}

inline std::string write(const std::string& name, std::string_view bytes) {
  const std::string path = folder() + "/" + name;
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file || std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) std::abort();
  std::fclose(file);
  return path;
}

inline std::string_view text_of(const uint8_t* data, size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// The two files of an input, divided by the line "#####".
struct Two {
  std::string_view first, second;
};
inline Two two_of(std::string_view input) {
  constexpr std::string_view line = "\n#####\n";
  const size_t at = input.find(line);
  if (at == std::string_view::npos) return {input, ""};
  return {input.substr(0, at), input.substr(at + line.size())};
}

/// Whether a text has a number of so many digits. Scenes with large numbers are valid and slow.
inline bool has_long_number(std::string_view text, int digits) {
  int run = 0;
  for (const char c : text) {
    run = c >= '0' && c <= '9' ? run + 1 : 0;
    if (run >= digits) return true;
  }
  return false;
}

/// Calls a reader. Everything that it throws but an Error is a fault, and so is a sentence with a library's own text.
template <class Read>
void read(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    const std::string_view sentence = error.what();
    if (sentence.empty() || sentence.find("json.exception") != std::string_view::npos) std::abort();
  }
}

}  // namespace holotrace::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
