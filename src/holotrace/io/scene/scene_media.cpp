#include "holotrace/io/scene/scene_media.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/data/medium_checks.h"
#include "holotrace/data/named_medium.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/file_kind.h"
#include "holotrace/io/files/npy.h"
#include "holotrace/io/scene/scene_tables.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {
namespace {

double ratio(double part, double whole) { return whole > 0 ? part / whole : 0; }

// A grid of float32 or float64, of the shape (planes, rows, columns).
void read_density(const std::string& path, Medium& medium) {
  check_file_exists(path, "a grid of densities");
  require(extension_of(path) == ".npy", "{}: expected a grid of densities .npy, got {}", path, kind_of_file(path));
  const std::string bytes = read_text(path);
  const NpyHeader header = read_npy_header(bytes, path);
  const bool is_single = header.dtype == "<f4";
  require(is_single || header.dtype == "<f8",
          "{}: expected float32 or float64 ('<f4' or '<f8'), got '{}'; convert it with numpy.astype", path,
          header.dtype);
  require(!header.fortran_order, "{}: expected an array in C order; write it with numpy.ascontiguousarray", path);
  constexpr int64_t most = 1 << 15;
  require(header.shape.size() == 3 &&
              std::all_of(header.shape.begin(), header.shape.end(), [](int64_t n) { return n > 0 && n <= most; }) &&
              header.shape[0] * header.shape[1] <= std::numeric_limits<int>::max(),
          "{}: expected the shape (planes, rows, columns), each from 1 to {}, got {}", path, most,
          format_shape(header.shape));
  const auto [planes, rows, columns] = std::array{header.shape[0], header.shape[1], header.shape[2]};
  const size_t count = size_t(planes * rows) * size_t(columns), sample = is_single ? 4 : 8;
  require(bytes.size() - header.data_begin == count * sample,
          "{}: expected {} bytes of samples for shape {}, got {}; the file is truncated or damaged, write it again",
          path, count * sample, format_shape(header.shape), bytes.size() - header.data_begin);
  require_memory(double(bytes.size()) + double(count) * sizeof(float), path);
  Image grid(int(planes * rows), int(columns), 1);
  for (size_t i = 0; i < count; ++i) {
    const char* from = bytes.data() + header.data_begin + i * sample;
    double value = 0;
    if (is_single) {
      float single;
      std::memcpy(&single, from, sizeof single);
      value = double(single);
    } else {
      std::memcpy(&value, from, sizeof value);
    }
    grid.values[i] = float(value);
  }
  medium.density = std::make_shared<Image>(std::move(grid));
  medium.planes = int(planes);
}

void check_cells(const Medium& medium) {
  const Image& grid = *medium.density;
  const int rows = grid.ny / medium.planes;
  for (size_t i = 0; i < grid.values.size(); ++i)
    require(grid.values[i] >= 0 && std::isfinite(grid.values[i]),
            "expected finite densities of 0 or more, got {} in plane {}, row {}, column {}", grid.values[i],
            int(i) / grid.nx / rows, int(i) / grid.nx % rows, int(i) % grid.nx);
}

// Extinction and albedo.
void read_coefficients(TomlTable& table, Medium& medium, Vec3& albedo) {
  std::string substance;
  table.text("substance", substance);
  table.colour("albedo", albedo, 1);
  std::vector<double> paths;
  table.lengths("mean_free_path", paths, range::positive);
  if (!substance.empty()) {
    for (const char* key : {"mean_free_path", "albedo"})
      require(!table.has(key), "{}expected either \"substance\" or \"{}\", got both", table.where(key), key);
    const NamedMedium* named = nullptr;
    table.locate("substance", [&] { named = &medium_named(substance); });
    medium.extinction = named->scattering + named->absorption;
    albedo = {ratio(named->scattering.x, medium.extinction.x), ratio(named->scattering.y, medium.extinction.y),
              ratio(named->scattering.z, medium.extinction.z)};
  } else {
    table.require_key("mean_free_path");
    require(paths.size() == 1 || paths.size() == 3, "{}expected one length or three, for red, green and blue, got {}",
            table.where("mean_free_path"), paths.size());
    medium.extinction = {1 / paths[0], 1 / paths[paths.size() / 2], 1 / paths.back()};
  }
  double concentration = 1;
  table.number("concentration", concentration, range::not_negative);
  medium.extinction *= concentration;
}

Medium read_medium(TomlTable table, const std::string& name, Scene& scene) {
  Medium medium;
  medium.name = name;
  ScatteringMaterial particles;
  read_coefficients(table, medium, particles.albedo);
  require(!(table.has("anisotropy") && table.has("droplets")),
          "{}expected either \"anisotropy\" or \"droplets\", got both", table.where("droplets"));
  table.number("anisotropy", particles.anisotropy, range::from_to(-most_anisotropy, most_anisotropy));
  table.length("droplets", particles.droplet_radius, range::above_to(0, 200e-6));
  Vec3 emission;
  table.colour("emission", emission, most_number);
  if (table.has("box")) {
    std::vector<Vec3> corners;
    table.length_vectors("box", corners);
    require(corners.size() == 2, "{}expected two corners of a box, got {}", table.where("box"), corners.size());
    const Vec3 a = corners[0], b = corners[1];
    require(a.x != b.x && a.y != b.y && a.z != b.z, "{}expected two corners that span a volume, got a flat box",
            table.where("box"));
    medium.box = {{std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)},
                  {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}};
  }
  if (table.has("density")) {
    require(medium.box.has_value(), "{}expected a \"box\" for the cells of the density", table.where("density"));
    if (const auto index = table.array_index("density")) {
      medium.density = std::make_shared<Image>(table.arrays()->images.at(*index));
      table.count("density_planes", medium.planes, range::at_least(1));
    } else {
      std::string file;
      table.text("density", file);
      table.locate("density", [&] { read_density(table.beside("density", file), medium); });
    }
    table.locate("density", [&] { check_cells(medium); });
  }
  table.refuse_unknown_keys();
  Material material(particles, emission * (Vec3{1, 1, 1} - particles.albedo));
  medium.material = int(scene.materials.size());
  scene.materials.push_back(std::move(material));
  return medium;
}

}  // namespace

std::map<std::string, int> read_media(TomlTable& root, Scene& scene) {
  std::vector<std::string> names;
  const auto tables = root.named_tables("media", names);
  std::map<std::string, int> known;
  for (size_t i = 0; i < tables.size(); ++i) {
    known[names[i]] = int(i);
    scene.media.push_back(read_medium(tables[i], names[i], scene));
  }
  return known;
}

void open_media(TomlTable& root, Scene& scene) {
  const auto tables = root.table("media");
  for (size_t i = 0; i < scene.media.size(); ++i) {
    Medium& medium = scene.media[i];
    const bool is_named = std::any_of(scene.materials.begin(), scene.materials.end(),
                                      [&](const Material& material) { return material.medium == int(i); });
    require(!(is_named && medium.box),
            "{}expected a medium that fills its box or objects, got \"{}\" with a box and as the medium of a material",
            tables->where(medium.name.c_str()), medium.name);
    medium.is_open = !is_named;
    tables->locate(medium.name.c_str(), [&] {
      check_medium(medium);
      check_open_media(scene.media);
    });
  }
}

}  // namespace holotrace
