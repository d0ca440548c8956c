#include "holotrace/io/field/sources_file.h"

#include <charconv>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/data/grid.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/io/files/ply.h"

namespace holotrace {
namespace {

// The text of a comment "key …"; nothing if there is none.
std::optional<std::string_view> comment_of(const PlyVertices& vertices, std::string_view key) {
  for (const std::string& comment : vertices.comments)
    if (comment.starts_with(key) && comment.size() > key.size() && comment[key.size()] == ' ')
      return std::string_view(comment).substr(key.size() + 1);
  return std::nullopt;
}

// Numbers separated by single spaces.
template <class Number>
void parse_comment(const PlyVertices& vertices, const char* key, const char* expected, std::string_view text,
                   std::initializer_list<Number*> values) {
  const char *at = text.data(), *end = at + text.size();
  for (Number* value : values) {
    const auto [next, error] = std::from_chars(at, end, *value);
    const bool is_last = value == *(values.end() - 1);
    require(error == std::errc() && (is_last ? next == end : next < end && *next == ' '),
            "{}: expected {} in \"comment {}\", got \"{}\"", vertices.path, expected, key, text);
    at = next + 1;
  }
}

// The phase keys, from two halves: columns are read as doubles, which hold 32 bits exactly but not 64.
std::vector<uint64_t> phase_keys_of(const PlyVertices& vertices) {
  const auto *low = vertices.find("phase_key_low"), *high = vertices.find("phase_key_high");
  if (!low && !high) return {};
  require(low && high, "{}: expected both properties \"phase_key_low\" and \"phase_key_high\", got one of them",
          vertices.path);
  std::vector<uint64_t> keys(vertices.count);
  for (size_t i = 0; i < keys.size(); ++i) {
    for (const double half : {(*low)[i], (*high)[i]})
      require(half >= 0 && half < 0x1p32 && half == std::floor(half),
              "{}: expected halves of phase keys in 0 … 4294967295, got {} at source {}", vertices.path, half, i);
    keys[i] = uint64_t((*high)[i]) << 32 | uint64_t((*low)[i]);
  }
  return keys;
}

constexpr const char* focus_columns[] = {"second_focus_x", "second_focus_y", "second_focus_z",
                                         "focal_line_x",   "focal_line_y",   "focal_line_z"};

std::vector<SecondFocus> second_foci_of(const PlyVertices& vertices) {
  if (!vertices.find(focus_columns[0])) return {};
  std::vector<SecondFocus> foci(vertices.count);
  const auto read = [&](int column, double Vec3::*part, Vec3 SecondFocus::*of) {
    const auto& values = vertices.column(focus_columns[column]);
    for (size_t i = 0; i < foci.size(); ++i) foci[i].*of.*part = values[i];
  };
  double Vec3::*const parts[] = {&Vec3::x, &Vec3::y, &Vec3::z};
  for (int i = 0; i < 3; ++i) {
    read(i, parts[i], &SecondFocus::place);
    read(3 + i, parts[i], &SecondFocus::line);
  }
  return foci;
}

TileAmplitudes tiles_of(const PlyVertices& vertices) {
  TileAmplitudes tiles;
  const auto text = comment_of(vertices, "tiles");
  if (!text) return tiles;
  parse_comment<int>(vertices, "tiles", "columns and rows", *text, {&tiles.columns, &tiles.rows});
  constexpr int most = 1 << 12;
  require(tiles.columns >= 1 && tiles.rows >= 1 && tiles.columns <= most && tiles.rows <= most,
          "{}: expected 1 to {} columns and rows of tiles, got {} × {}", vertices.path, most, tiles.columns,
          tiles.rows);
  for (int tile = 0; tile < tiles.columns * tiles.rows; ++tile)
    for (const double amplitude : vertices.column(fmt::format("amplitude_{}", tile))) {
      require(std::isfinite(amplitude), "{}: expected finite amplitudes of tile {}, got {}", vertices.path, tile,
              amplitude);
      tiles.values.push_back(float(amplitude));
    }
  return tiles;
}

// Checks that the name fits into one line of the header.
void check_name(const std::string& path, const Sources& sources) {
  require(sources.label.name.find_first_of("\r\n") == std::string::npos,
          "expected a name of one line for the sources to save as {}, got \"{}\"", path, sources.label.name);
}

std::string header_of(const Sources& sources) {
  std::string text =
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment wavelength_m {:.17g}\n", sources.wavelength);
  const TileAmplitudes& tiles = sources.tiles;
  if (sources.label.cone_wavelength > 0)
    text += fmt::format("comment cone_wavelength_m {:.17g}\n", sources.label.cone_wavelength);
  if (!sources.label.name.empty()) text += fmt::format("comment name {}\n", sources.label.name);
  if (!sources.phase_keys.empty()) text += fmt::format("comment seed {}\n", sources.seed);
  if (!sources.phase_keys.empty() || sources.label.frame > 0)
    text += fmt::format("comment frame {}\n", sources.label.frame);
  if (tiles.columns > 0) text += fmt::format("comment tiles {} {}\n", tiles.columns, tiles.rows);
  text += fmt::format(
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\nproperty float amplitude\n"
      "property float phase\n",
      sources.waves.size());
  if (!sources.phase_keys.empty()) text += "property uint phase_key_low\nproperty uint phase_key_high\n";
  if (!sources.second_foci.empty())
    for (const char* column : focus_columns) text += fmt::format("property double {}\n", column);
  for (int tile = 0; tile < tiles.columns * tiles.rows; ++tile)
    text += fmt::format("property float amplitude_{}\n", tile);
  return text + "end_header\n";
}

}  // namespace

void save_sources(const std::string& path, const Sources& sources, const FileRecord& record) {
  require(extension_of(path) == ".ply", "expected a file of sources .ply, got {}; change its extension", path);
  check_sources(sources);
  check_name(path, sources);
  std::string bytes = header_of(sources);
  if (!record.empty())
    bytes.insert(bytes.find("element vertex"), fmt::format("comment {}\n", record_line(path, record)));
  const auto put = [&bytes](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  const size_t count = sources.waves.size(), tiles = size_t(sources.tiles.columns) * size_t(sources.tiles.rows);
  bytes.reserve(bytes.size() + count * (88 + 4 * tiles));
  for (size_t i = 0; i < count; ++i) {
    const Source& s = sources.waves[i];
    for (const double x : {s.origin.x, s.origin.y, s.origin.z}) put(x);
    put(s.amplitude);
    put(s.phase);
    if (!sources.phase_keys.empty()) {
      put(uint32_t(sources.phase_keys[i]));
      put(uint32_t(sources.phase_keys[i] >> 32));
    }
    if (!sources.second_foci.empty()) {
      const auto& [place, line] = sources.second_foci[i];
      for (const double x : {place.x, place.y, place.z, line.x, line.y, line.z}) put(x);
    }
    for (size_t tile = 0; tile < tiles; ++tile) put(sources.tiles.values[tile * count + i]);
  }
  write_text(path, bytes);
}

Sources load_sources(const std::string& path, double default_wavelength) {
  const PlyVertices vertices = read_ply(path);
  Sources sources;
  if (const auto text = comment_of(vertices, "wavelength_m"))
    parse_comment<double>(vertices, "wavelength_m", "a number of metres", *text, {&sources.wavelength});
  if (sources.wavelength == 0) sources.wavelength = default_wavelength;
  if (sources.wavelength == 0)
    fail(
        "{}: expected a line \"comment wavelength_m …\", got none; pass the wavelength, such as --wavelength \"532 "
        "nm\"",
        path);
  if (const auto text = comment_of(vertices, "cone_wavelength_m"))
    parse_comment<double>(vertices, "cone_wavelength_m", "a number of metres", *text, {&sources.label.cone_wavelength});
  if (const auto text = comment_of(vertices, "name")) sources.label.name = printable(*text);
  if (const auto text = comment_of(vertices, "seed"))
    parse_comment<uint64_t>(vertices, "seed", "a whole number", *text, {&sources.seed});
  if (const auto text = comment_of(vertices, "frame"))
    parse_comment<uint32_t>(vertices, "frame", "a whole number", *text, {&sources.label.frame});
  const auto& x = vertices.column("x");
  const auto& y = vertices.column("y");
  const auto& z = vertices.column("z");
  const auto& amplitude = vertices.column("amplitude");
  const auto& phase = vertices.column("phase");
  sources.waves.resize(vertices.count);
  for (size_t i = 0; i < vertices.count; ++i)
    sources.waves[i] = {{x[i], y[i], z[i]}, float(amplitude[i]), float(phase[i])};
  sources.phase_keys = phase_keys_of(vertices);
  sources.second_foci = second_foci_of(vertices);
  sources.tiles = tiles_of(vertices);
  try {
    check_sources(sources);
  } catch (const Error& e) {
    fail("{}: {}", path, e.what());
  }
  return sources;
}

}  // namespace holotrace
