#include "holotrace/io/sources_file.h"

#include <charconv>
#include <cstring>

#include "holotrace/base/error.h"
#include "holotrace/data/grid.h"
#include "holotrace/io/file.h"
#include "holotrace/io/ply.h"

namespace holotrace {
namespace {

constexpr std::string_view wavelength_comment = "wavelength_m ";

// The wavelength that the file says, 0 where it says none.
double wavelength_of(const PlyVertices& vertices) {
  for (const std::string& comment : vertices.comments) {
    if (!comment.starts_with(wavelength_comment)) continue;
    const std::string_view text = std::string_view(comment).substr(wavelength_comment.size());
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    require(error == std::errc() && end == text.data() + text.size(),
            "{}: expected a number of metres in \"comment wavelength_m\", got \"{}\"", vertices.path, text);
    return value;
  }
  return 0;
}

}  // namespace

void save_sources(const std::string& path, const Sources& sources) {
  require(extension_of(path) == ".ply", "expected a file of sources .ply, got {}; change its extension", path);
  check_sources(sources);
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment wavelength_m {:.17g}\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\nproperty float amplitude\nproperty float phase\n"
      "end_header\n",
      sources.wavelength, sources.waves.size());
  constexpr size_t row = 3 * sizeof(double) + 2 * sizeof(float);
  size_t at = bytes.size();
  bytes.resize(at + row * sources.waves.size());
  for (const Source& s : sources.waves) {
    const double origin[] = {s.origin.x, s.origin.y, s.origin.z};
    const float wave[] = {s.amplitude, s.phase};
    std::memcpy(&bytes[at], origin, sizeof origin);
    std::memcpy(&bytes[at + sizeof origin], wave, sizeof wave);
    at += row;
  }
  write_atomically(path, [&](const std::string& temporary) { write_bytes(temporary, bytes.data(), bytes.size()); });
}

Sources load_sources(const std::string& path, double default_wavelength) {
  const PlyVertices vertices = read_ply(path);
  Sources sources;
  sources.wavelength = wavelength_of(vertices);
  if (sources.wavelength == 0) sources.wavelength = default_wavelength;
  if (sources.wavelength == 0)
    fail(
        "{}: expected a line \"comment wavelength_m …\", got none; pass the wavelength, such as --wavelength \"532 "
        "nm\"",
        path);
  const auto& x = vertices.column("x");
  const auto& y = vertices.column("y");
  const auto& z = vertices.column("z");
  const auto& amplitude = vertices.column("amplitude");
  const auto& phase = vertices.column("phase");
  sources.waves.resize(vertices.count);
  for (size_t i = 0; i < vertices.count; ++i)
    sources.waves[i] = {{x[i], y[i], z[i]}, float(amplitude[i]), float(phase[i])};
  try {
    check_sources(sources);
  } catch (const Error& e) {
    fail("{}: {}", path, e.what());
  }
  return sources;
}

}  // namespace holotrace
