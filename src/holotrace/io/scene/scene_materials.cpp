#include "holotrace/io/scene/scene_materials.h"

#include <algorithm>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/io/scene/scene_images.h"
#include "holotrace/io/scene/scene_index.h"

namespace holotrace {
namespace {

using Texture = std::shared_ptr<const Image>;

Texture read_texture(TomlTable& table, const char* key, ImageContent content = ImageContent::colour) {
  if (!table.has(key)) return nullptr;
  Image image = read_image(table, key, content);
  std::string name = "the array";
  if (!table.array_index(key)) table.text(key, name);
  const std::string where = table.where(key) + table.beside(key, name);
  const auto dark = std::find_if(image.values.begin(), image.values.end(), [](float value) { return value < 0; });
  require(dark == image.values.end(), "{}: expected a texture of values of 0 or more, got {}", where,
          dark == image.values.end() ? 0 : *dark);
  if (content == ImageContent::data) {
    require(image.channels == 3, "{}expected an image of red, green and blue for \"{}\", got the grey one {}",
            table.where(key), key, table.beside(key, name));
  }
  return std::make_shared<Image>(std::move(image));
}

DiffuseMaterial read_diffuse(TomlTable& table) {
  DiffuseMaterial surface;
  table.colour("reflectance", surface.reflectance, 1);
  table.colour("transmittance", surface.transmittance, 1);
  surface.texture = read_texture(table, "texture");
  // Without `reflectance`, a texture is the reflectance, and it is limited to 1 − transmittance.
  if (!table.has("reflectance")) {
    if (surface.texture) surface.reflectance = {1, 1, 1};
    const Vec3 rest = Vec3{1, 1, 1} - surface.transmittance;
    surface.reflectance = {std::min(surface.reflectance.x, rest.x), std::min(surface.reflectance.y, rest.y),
                           std::min(surface.reflectance.z, rest.z)};
  }
  const double most = max_component(surface.reflectance + surface.transmittance);
  constexpr double rounding = 1e-12;  // 0.9 + 0.1 may be slightly more than 1
  require(most <= 1 + rounding, "{}expected a reflectance and a transmittance of at most 1 together, got {}",
          table.where("transmittance"), most);
  return surface;
}

// Reads a refractive index, from the name of its substance (the key `kind`) or from the key "index".
template <class Index, class ByName, class Read>
void read_index_or_name(TomlTable& table, const char* kind, Index& index, const ByName& by_name, const Read& read) {
  std::string name;
  table.text(kind, name);
  require(!(table.has(kind) && table.has("index")), "{}expected either \"{}\" or \"index\", got both",
          table.where("index"), kind);
  if (!name.empty()) table.locate(kind, [&] { index = by_name(name); });
  read(table, "index", index);
}

ConductorMaterial read_conductor(TomlTable& table) {
  ConductorMaterial surface;
  read_index_or_name(table, "metal", surface.index, metal_index, read_metal_index);
  table.number("roughness", surface.roughness, range::fraction);
  return surface;
}

DielectricMaterial read_dielectric(TomlTable& table) {
  DielectricMaterial surface;
  read_index_or_name(table, "glass", surface.index, glass_index, read_glass_index);
  table.number("roughness", surface.roughness, range::fraction);
  table.flag("thin", surface.is_thin);
  return surface;
}

MetallicRoughnessMaterial read_metallic_roughness(TomlTable& table) {
  MetallicRoughnessMaterial surface;
  table.colour("base_color", surface.base_color, 1);
  surface.base_texture = read_texture(table, "base_texture");
  table.number("metallic", surface.metallic, range::fraction);
  table.number("roughness", surface.roughness, range::fraction);
  surface.metallic_texture = read_texture(table, "metallic_texture", ImageContent::data);
  return surface;
}

}  // namespace

Material read_material(TomlTable table) {
  std::string type = "diffuse";
  table.text("type", type);
  Material material;
  if (type == "diffuse")
    material.surface = read_diffuse(table);
  else if (type == "conductor")
    material.surface = read_conductor(table);
  else if (type == "dielectric")
    material.surface = read_dielectric(table);
  else if (type == "metallic-roughness")
    material.surface = read_metallic_roughness(table);
  else
    throw Error(
        table.where("type") +
        unknown_name_message("material type", type, {"diffuse", "conductor", "dielectric", "metallic-roughness"}));
  material.emission_texture = read_texture(table, "emission_texture");
  if (material.emission_texture) material.emission = {1, 1, 1};  // the texture alone, unless the file has an emission
  table.colour("emission", material.emission, std::numeric_limits<double>::infinity());
  material.normal_map = read_texture(table, "normal_map", ImageContent::data);
  table.number("normal_scale", material.normal_scale, range::not_negative);
  table.flag("two_sided", material.two_sided);
  table.refuse_unknown_keys();
  return material;
}

}  // namespace holotrace
