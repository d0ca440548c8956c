#pragma once

#include <string>

#include "holotrace/io/scene/scene_file.h"
#include "support/temporary.h"

namespace holotrace::test {

/// An object that every scene may have.
inline const std::string cube =
    "[[object]]\ntype = \"wireframe_cube\"\nsize = \"20 mm\"\npoints_per_edge = 3\nposition = \"0 0 -300 mm\"\n";

inline Job load(const std::string& text) { return load_job(make_file("scene.toml", text)); }

/// The error text without the folder: "3:9: expected …".
inline std::string scene_error(const std::string& text) {
  const std::string path = make_file("scene.toml", text);
  const std::string error = error_of([&] { load_job(path); });
  return error.starts_with(path + ":") ? error.substr(path.size() + 1) : error;
}

inline std::string error_with(const std::string& rest) { return scene_error("wavelength = \"532 nm\"\n" + rest); }

}  // namespace holotrace::test
