#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/grid.h"

namespace holotrace::test {

/// A panel small enough for a test: 2.048 mm × 1.536 mm at 8 µm, 49152 pixels. At 532 nm a point 30 mm
/// behind it lights 2·30 mm·tan(asin(λ/2p)) = 2.0 mm of it: nearly the whole panel.
inline constexpr Grid small_panel{256, 192, 8e-6};
inline constexpr double test_wavelength = 532e-9;

/// The head of a scene file with the wavelength and that panel; `more` has further keys of the top level.
inline std::string scene_head(const Grid& panel = small_panel, const std::string& more = "") {
  return fmt::format("wavelength = \"532 nm\"\n{}[slm]\ncolumns = {}\nrows = {}\npitch = \"{} um\"\n", more, panel.nx,
                     panel.ny, panel.pitch * 1e6);
}

/// A luminous point of a PLY file.
struct Luminous {
  Vec3 at;
  double amplitude = 1;
};

inline std::string point_file(const std::vector<Luminous>& points) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
      "property float amplitude\nend_header\n",
      points.size());
  for (const Luminous& p : points) text += fmt::format("{} {} {} {}\n", p.at.x, p.at.y, p.at.z, p.amplitude);
  return text;
}

/// An object with the points of a file beside the scene, with the phases that the key `phase` gives them.
inline std::string points_object(const std::string& file = "points.ply") {
  return "[trace]\nphase = \"constant\"\n[[object]]\ntype = \"points\"\nfile = \"" + file + "\"\n";
}

/// A scene of meshes and a wireframe with lights and shadows, 30 mm behind the small panel; few samples, to be quick.
inline std::string mesh_scene() {
  return scene_head(small_panel, "background = 0.1\n") +
         "[trace]\ncolumns = 48\nrows = 48\npaths = 4\n"
         "[render]\nrows = 64\npaths = 4\n"
         "[camera]\ndistances = \"30 mm\"\n"
         "[[light]]\ntype = \"point\"\nposition = \"1 2 -20 mm\"\nintensity = 1e-3\n"
         "[[object]]\ntype = \"sphere\"\nsize = \"0.8 mm\"\nsegments = 16\nposition = \"0.3 0.1 -30 mm\"\n"
         "[[object]]\ntype = \"quad\"\nwidth = \"2 mm\"\nheight = \"2 mm\"\nposition = \"0 0 -32 mm\"\n"
         "[[object]]\ntype = \"wireframe_cube\"\nsize = \"0.6 mm\"\npoints_per_edge = 4\n"
         "position = \"-0.5 0 -29 mm\"\n";
}

}  // namespace holotrace::test
