#include "holotrace/io/scene/scene_media.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/medium_checks.h"
#include "holotrace/data/named_medium.h"
#include "holotrace/data/params/parameter.h"
#include "holotrace/io/scene/cells_file.h"
#include "holotrace/io/scene/scene_lights.h"
#include "holotrace/io/scene/scene_tables.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {
namespace {

double ratio(double part, double whole) { return whole > 0 ? part / whole : 0; }

// The cells of a key: a file, or an array of Python. No value is above `most`, of which `range` tells.
Cells read_cells(TomlTable& table, const char* key, const Medium& medium, const char* range, float most) {
  Cells cells;
  if (!table.has(key)) return cells;
  require(medium.box.has_value(), "{}expected a \"box\" for the cells of the {}", table.where(key), key);
  if (const auto index = table.array_index(key)) {
    cells.values = std::make_shared<Image>(table.arrays()->images.at(*index));
    table.count((std::string(key) + "_planes").c_str(), cells.planes, range::at_least(1));
  } else {
    std::string file;
    table.text(key, file);
    table.locate(key, [&] { cells = load_cells(table.beside(key, file), key); });
  }
  const Image& grid = *cells.values;
  require(grid.ny >= cells.planes && grid.ny % cells.planes == 0, "{}expected planes of whole rows, got {} rows in {}",
          table.where(key), grid.ny, cells.planes);
  const auto bad = std::find_if_not(grid.values.begin(), grid.values.end(),
                                    [&](float value) { return value >= 0 && value <= most; });
  if (bad == grid.values.end()) return cells;
  const auto place = size_t(bad - grid.values.begin()), row = place / size_t(grid.nx),
             rows = size_t(grid.ny / cells.planes);
  fail("{}expected {}, got {} in plane {}, row {}, column {}", table.where(key), range, *bad, row / rows, row % rows,
       place % size_t(grid.nx));
}

// The temperature of all particles [K], or a grid. Such particles absorb, if nothing else is said.
void read_temperature(TomlTable& table, Medium& medium, ScatteringMaterial& particles) {
  constexpr float hottest = 1e5F;
  const toml::node* node = table.find("temperature");
  require(node || !table.has("blackbody"), "{}expected a \"temperature\" for the light of a black body",
          table.where("blackbody"));
  if (!node) return;
  if (!table.has("albedo") && !table.has("substance")) particles.albedo = {};
  require(!(particles.albedo == Vec3{1, 1, 1}),
          "{}expected an \"albedo\" below 1 of a medium with a temperature, got 1: what does not absorb does not shine",
          table.where("temperature"));
  const std::optional<double> with_unit = kelvins_in(node->value_or(std::string()));
  if (with_unit || (node->is_number() && !table.has("temperature_planes"))) {  // else the number of an array
    double kelvin = with_unit.value_or(0);
    if (with_unit) {
      std::string text;
      table.text("temperature", text);
      table.locate("temperature", [&] {
        require(kelvin > 0 && kelvin <= double(hottest), "expected a temperature above 0 K and up to {} K, got {} K",
                hottest, kelvin);
      });
    } else {
      table.number("temperature", kelvin, range::above_to(0, double(hottest)));
    }
    Image even(1, 1, 1);
    even.values[0] = float(kelvin);
    medium.temperature = {std::make_shared<Image>(std::move(even)), 1};
  } else {
    medium.temperature = read_cells(table, "temperature", medium, "temperatures from 0 to 100000 K", hottest);
  }
  particles.blackbody = 1;
  table.number("blackbody", particles.blackbody, range::not_negative);
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
  medium.density =
      read_cells(table, "density", medium, "finite densities of 0 or more", std::numeric_limits<float>::max());
  read_temperature(table, medium, particles);
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
