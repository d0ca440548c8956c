#include "holotrace/io/scene/scene_materials.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/named_light.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/scene/measured_file.h"
#include "holotrace/io/scene/scene_images.h"
#include "holotrace/io/scene/scene_lights.h"
#include "holotrace/io/scene/toml_table.h"

namespace holotrace {
namespace {

void check_sample(const RefractiveIndex::Sample& sample, const std::string& where) {
  require(std::isfinite(sample.n) && sample.n > 0, "{}expected an index n above 0, got {}", where, sample.n);
  require(std::isfinite(sample.k) && sample.k >= 0, "{}expected an absorption k of 0 or more, got {}", where, sample.k);
}

// The index with its samples sorted by wavelength.
RefractiveIndex in_order(RefractiveIndex index, const std::string& where) {
  auto& samples = index.samples;
  std::sort(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.wavelength < b.wavelength; });
  const auto twice = std::adjacent_find(samples.begin(), samples.end(),
                                        [](const auto& a, const auto& b) { return a.wavelength == b.wavelength; });
  if (twice != samples.end())
    fail("{}expected each wavelength once, got {} twice", where, format_length(twice->wavelength));
  return index;
}

// An index from a list of [wavelength, n] or [wavelength, n, k].
RefractiveIndex from_list(TomlTable& table, const char* key, const toml::array& list, const char* expected) {
  RefractiveIndex index;
  require(!list.empty(), "{}expected one sample or more for \"{}\", got none", table.where(key), key);
  for (const toml::node& item : list) {
    const toml::array* row = item.as_array();
    if (!row || row->size() < 2 || row->size() > 3) table.fail_kind(key, expected, item);
    const auto wavelength = (*row)[0].value_exact<std::string>();
    if (!wavelength) table.fail_kind(key, expected, (*row)[0]);
    RefractiveIndex::Sample sample{0, 0, 0};
    try {
      sample.wavelength = parse_wavelength(*wavelength);
    } catch (const Error& e) {
      fail("{}{} for \"{}\"", table.place((*row)[0].source()), e.what(), key);
    }
    require(sample.wavelength > 0, "{}expected a wavelength above 0 m for \"{}\", got {}",
            table.place((*row)[0].source()), key, *wavelength);
    for (size_t i = 1; i < row->size(); ++i) {
      const auto number = to_number((*row)[i]);
      if (!number) table.fail_kind(key, expected, (*row)[i]);
      (i == 1 ? sample.n : sample.k) = *number;
    }
    check_sample(sample, table.place(item.source()));
    index.samples.push_back(sample);
  }
  return in_order(std::move(index), table.where(key));
}

RefractiveIndex from_file(TomlTable& table, const char* key, const std::string& name) {
  RefractiveIndex index;
  table.locate(key, [&] { index = load_index_table(table.beside(key, name)); });
  return index;
}

// An index from a list in the scene, or from a file beside it.
RefractiveIndex from_table(TomlTable& table, const char* key, const toml::node& node, const char* expected) {
  if (const toml::array* list = node.as_array()) return from_list(table, key, *list, expected);
  const auto name = node.value_exact<std::string>();
  if (!name) table.fail_kind(key, expected, node);
  return from_file(table, key, *name);
}

double parse_number(const std::string& word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  require(error == std::errc() && end == word.data() + word.size(), "no number");
  return value;
}

void check_transparent(const RefractiveIndex& index, const std::string& where) {
  for (const auto& sample : index.samples)
    require(sample.k == 0, "{}expected a glass without absorption (k = 0), got k = {}; a metal is a \"conductor\"",
            where, sample.k);
}

}  // namespace

void read_metal_index(TomlTable& table, const char* key, RefractiveIndex& index) {
  const toml::node* node = table.find(key);
  if (!node) return;
  constexpr const char* expected = "{ n = 0.05, k = 3.4 }, a list [[\"450 nm\", 0.04, 2.6], …] or a table file";
  if (node->is_table()) {
    auto inner = *table.table(key);
    double n = 0, k = 0;
    inner.know("k");
    inner.require_key("n");
    inner.number("n", n, range::positive);
    inner.number("k", k, range::not_negative);
    inner.refuse_unknown_keys();
    index = constant_index(n);
    index.samples.front().k = k;
    check_sample(index.samples.front(), inner.where("n"));
  } else {
    index = from_table(table, key, *node, expected);
  }
}

void read_glass_index(TomlTable& table, const char* key, RefractiveIndex& index) {
  const toml::node* node = table.find(key);
  if (!node) return;
  constexpr const char* expected = "a number such as 1.5, a list [[\"450 nm\", 1.526], …] or a table file";
  if (const auto number = to_number(*node)) {
    check_sample({0, *number, 0}, table.where(key));
    index = constant_index(*number);
  } else {
    index = from_table(table, key, *node, expected);
  }
  check_transparent(index, table.where(key));
}

RefractiveIndex load_index_table(const std::string& path) {
  check_file_exists(path, "a table of refractive indices");
  RefractiveIndex index;
  for (const auto& [where, line, words] : read_rows(path)) {
    try {
      require(words.size() == 3 || words.size() == 4, "too few or many words");
      RefractiveIndex::Sample sample{parse_length(words[0] + " " + words[1]), parse_number(words[2]), 0};
      if (words.size() == 4) sample.k = parse_number(words[3]);
      require(sample.wavelength > 0, "no wavelength");
      index.samples.push_back(sample);
    } catch (const Error&) {
      fail("{}expected a wavelength with its unit, n and k, such as \"450 nm 0.04 2.6\", got \"{}\"", where, line);
    }
    check_sample(index.samples.back(), where);
  }
  require(!index.samples.empty(), "{}: expected lines such as \"450 nm 0.04 2.6\", got none", path);
  return in_order(std::move(index), path + ": ");
}

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

Texture read_opacity(TomlTable& table) {
  if (!table.has("opacity_texture")) return nullptr;
  const Image alpha = read_image(table, "opacity_texture", ImageContent::alpha);
  if (is_alpha(alpha)) return std::make_shared<Image>(alpha);
  return std::make_shared<Image>(channel_of(read_image(table, "opacity_texture", ImageContent::data), 0));
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

// A texture of one channel: the red one of a colour picture.
PlacedTexture read_number_texture(TomlTable& table, const char* key) {
  if (!table.has(key)) return {};
  Image image = channel_of(read_image(table, key, ImageContent::data), 0);
  const auto dark = std::find_if(image.values.begin(), image.values.end(), [](float value) { return value < 0; });
  require(dark == image.values.end(), "{}expected a texture of values of 0 or more for \"{}\", got {}",
          table.where(key), key, dark == image.values.end() ? 0 : *dark);
  return {std::make_shared<Image>(std::move(image))};
}

// A number from 0 to 1 at `key`, and the texture at "key_texture" that multiplies it.
void read_textured(TomlTable& table, const std::string& key, TexturedNumber& into) {
  into.texture = read_number_texture(table, (key + "_texture").c_str());
  if (into.texture.image) into.value = 1;  // the texture alone, unless the file has a number
  table.number(key.c_str(), into.value, range::fraction);
}

void read_textured(TomlTable& table, const std::string& key, TexturedColour& into, double most = 1) {
  into.texture.image = read_texture(table, (key + "_texture").c_str());
  if (into.texture.image) into.value = {1, 1, 1};
  table.colour(key.c_str(), into.value, most);
}

PrincipledMaterial read_principled(TomlTable& table) {
  PrincipledMaterial surface;
  read_textured(table, "base_color", surface.base_color);
  read_textured(table, "metalness", surface.metalness);
  read_textured(table, "roughness", surface.roughness);
  read_index_or_name(table, "glass", surface.index, glass_index, read_glass_index);
  read_textured(table, "specular", surface.specular);
  read_textured(table, "specular_color", surface.specular_color, std::numeric_limits<double>::infinity());
  read_textured(table, "anisotropy", surface.anisotropy);
  table.angle("anisotropy_rotation", surface.anisotropy_rotation, range::any);
  read_textured(table, "transmission", surface.transmission);
  table.flag("thin", surface.is_thin);
  table.colour("attenuation_color", surface.attenuation_color, 1);
  table.length("attenuation_distance", surface.attenuation_distance, range::positive);
  read_textured(table, "diffuse_transmission", surface.diffuse_transmission);
  read_textured(table, "diffuse_transmission_color", surface.diffuse_transmission_color);
  read_textured(table, "clearcoat", surface.clearcoat);
  read_textured(table, "clearcoat_roughness", surface.clearcoat_roughness);
  table.number("clearcoat_index", surface.clearcoat_index, range::at_least(1));
  read_textured(table, "sheen_color", surface.sheen_color);
  read_textured(table, "sheen_roughness", surface.sheen_roughness);
  read_textured(table, "iridescence", surface.iridescence);
  table.number("iridescence_index", surface.iridescence_index, range::at_least(1));
  table.length("iridescence_thickness", surface.film_thickness, range::not_negative);
  table.length("iridescence_least_thickness", surface.least_thickness, range::not_negative);
  surface.thickness_texture = read_number_texture(table, "iridescence_thickness_texture");
  return surface;
}

// The medium inside closed meshes of the material: of glass, or of an interface that rays pass unchanged.
int read_medium_inside(TomlTable& table, const Material& material, const std::map<std::string, int>& media) {
  std::string name;
  table.text("medium", name);
  if (name.empty()) return -1;
  const auto* glass = std::get_if<DielectricMaterial>(&material.surface);
  const auto* layers = std::get_if<PrincipledMaterial>(&material.surface);
  const bool is_solid = (glass && !glass->is_thin) || (layers && !layers->is_thin && layers->transmission.value > 0);
  require(
      is_solid || material.opacity == 0,
      "{}expected a medium in a solid that light enters, such as a \"dielectric\" or an \"interface\", got an opaque or "
      "thin material",
      table.where("medium"));
  require(!layers || !std::isfinite(layers->attenuation_distance),
          "{}expected either \"medium\" or \"attenuation_distance\", got both", table.where("medium"));
  const auto found = media.find(name);
  if (found != media.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, index] : media) names.push_back(known);
  throw Error(table.where("medium") + unknown_name_message("medium", name, names));
}

MeasuredMaterial read_measured(TomlTable& table) {
  std::string file;
  table.require_key("file");
  table.text("file", file);
  MeasuredMaterial surface;
  table.locate("file",
               [&] { surface.brdf = std::make_shared<MeasuredBrdf>(load_measured(table.beside("file", file))); });
  return surface;
}

// The axis of a sheet: an angle from x toward y, as the viewer sees the scene, or a direction.
Vec3 read_filter_axis(TomlTable& table) {
  Vec3 axis{1, 0, 0};
  if (!table.has("axis")) return axis;
  if (table.find("axis")->is_array()) {
    table.direction("axis", axis);
  } else {
    double angle = 0;
    table.angle("axis", angle, range::any);
    axis = {std::cos(angle), std::sin(angle), 0};
  }
  return axis;
}

FilterMaterial read_filter(TomlTable& table, bool is_retarder) {
  FilterMaterial surface;
  surface.axis = read_filter_axis(table);
  table.number("transmittance", surface.transmittance, range::fraction);
  if (!is_retarder) {
    table.number("leakage", surface.leakage, range::fraction);
    return surface;
  }
  table.angle("delay", surface.delay, range::any);
  table.length("path_difference", surface.path_difference, range::any);
  surface.leakage = surface.transmittance;
  return surface;
}

}  // namespace

Material read_material(TomlTable table, const std::map<std::string, int>& media) {
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
  else if (type == "principled")
    material.surface = read_principled(table);
  else if (type == "measured")
    material.surface = read_measured(table);
  else if (type == "polariser" || type == "retarder")
    material.surface = read_filter(table, type == "retarder");
  else if (type == "interface")
    material.opacity = 0;
  else
    throw Error(table.where("type") +
                unknown_name_message("material type", type,
                                     {"diffuse", "conductor", "dielectric", "metallic-roughness", "principled",
                                      "measured", "polariser", "retarder", "interface"}));
  if (type == "interface") {
    table.require_key("medium");
    material.medium = read_medium_inside(table, material, media);
    table.refuse_unknown_keys();
    return material;
  }
  material.emission_texture = read_texture(table, "emission_texture");
  if (material.emission_texture) material.emission = {1, 1, 1};  // the texture alone, unless the file has an emission
  table.colour("emission", material.emission, std::numeric_limits<double>::infinity());
  material.emission_spectrum = read_spectrum(table, "emission_spectrum");
  material.normal_map = read_texture(table, "normal_map", ImageContent::data);
  table.number("normal_scale", material.normal_scale, range::not_negative);
  table.number("opacity", material.opacity, range::fraction);
  material.opacity_texture = read_opacity(table);
  table.number("opacity_cutoff", material.opacity_cutoff, range::fraction);
  table.flag("two_sided", material.two_sided);
  material.medium = read_medium_inside(table, material, media);
  table.refuse_unknown_keys();
  return material;
}

}  // namespace holotrace
