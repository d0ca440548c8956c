#include "holotrace/io/mesh/obj_materials.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/units.h"
#include "holotrace/io/files/text.h"

namespace holotrace {
namespace {

std::optional<double> number_of(std::string_view word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

// A texture as written.
struct Map {
  std::string file;
  TextureCoordinates coordinates{};
  ImageEdge edge = ImageEdge::repeat;
  int channel = 0;  // of red, green, blue, for maps of one number
};

// One material as written.
struct Entry {
  std::string name;
  Vec3 diffuse{0.6, 0.6, 0.6}, specular{}, emission{};
  double exponent = 0, index = 1, opacity = 1;
  bool has_opacity = false;  // by "d", which counts more than "Tr": some programs write the latter the wrong way round
  int illumination = 1;
  std::optional<double> roughness, metallic;
  Vec3 filter{1, 1, 1};                                                          // Tf: colour of what is transmitted
  double sheen = 0, coat = 0, coat_roughness = 0, anisotropy = 0, rotation = 0;  // rotation: of a turn
  Map diffuse_map, emission_map, normal_map, roughness_map, metallic_map, opacity_map, transparency_map;
};

// What a key asks for that is not shown, and what happens instead.
struct NotShown {
  std::string_view key;
  const char* sentence;
};

constexpr std::array not_shown{
    NotShown{"bump", "has a bump map; it is ignored; give a normal map by \"norm\""},
    NotShown{"map_bump", "has a bump map; it is ignored; give a normal map by \"norm\""},
    NotShown{"map_ks", "has a map of its highlight (map_Ks); it is ignored"},
    NotShown{"map_ns", "has a map of its highlight (map_Ns); it is ignored; give a map of roughness by map_Pr"},
    NotShown{"map_ps", "has a map of sheen (map_Ps); it is ignored"},
    NotShown{"map_tf", "has a map of its transmission (map_Tf); it is ignored"},
    NotShown{"disp", "has a displacement map (disp); it is ignored"},
    NotShown{"map_disp", "has a displacement map (disp); it is ignored"},
    NotShown{"decal", "has a decal; it is ignored"},
    NotShown{"map_decal", "has a decal; it is ignored"},
    NotShown{"refl", "has a reflection map (refl); it is ignored; the scene's own surroundings are reflected"},
    NotShown{"map_refl", "has a reflection map (refl); it is ignored; the scene's own surroundings are reflected"}};

// Keys that path tracing has no use for: ambient light, and how other programs render.
constexpr std::array unneeded{"ka", "map_ka", "sharpness", "map_aat"};

// Reads the lines of an MTL file.
class Entries {
 public:
  Entries(ModelReader& reader, std::string path) : reader_(reader), path_(std::move(path)) {}

  std::vector<Entry> read() {
    const std::string text = read_lines(path_);
    for (std::string_view rest = text, line; next_line(rest, line);) {
      ++line_;
      read_line(line);
    }
    return std::move(entries_);
  }

 private:
  void read_line(std::string_view line) {
    const std::string key = lower_case(std::string(next_word(line)));
    if (key.empty() || key[0] == '#') return;
    if (key == "newmtl") {
      entries_.emplace_back().name = name_without_comment(line);
    } else if (entries_.empty()) {
      reader_.warn("before newmtl",
                   fmt::format("{}:{}: what comes before the first \"newmtl\" is ignored", path_, line_));
    } else if (!read_map(key, name_without_comment(line), entries_.back())) {
      read_value(key, without_comment(line), entries_.back());
    }
  }

  bool read_map(const std::string& key, std::string_view line, Entry& entry) {
    if (key == "map_kd")
      entry.diffuse_map = map(line);
    else if (key == "map_ke" || key == "map_emissive")
      entry.emission_map = map(line);
    else if (key == "norm" || key == "map_kn")
      entry.normal_map = map(line);
    else if (key == "map_pr")
      entry.roughness_map = map(line);
    else if (key == "map_pm")
      entry.metallic_map = map(line);
    else if (key == "map_d" || key == "map_opacity")
      entry.opacity_map = map(line);
    else if (key == "map_tr")
      entry.transparency_map = map(line);
    else
      return false;
    return true;
  }

  void read_value(const std::string& key, std::string_view line, Entry& entry) {
    const auto is_key = [&](const auto& item) { return item.key == key; };
    if (key == "kd") {
      entry.diffuse = colour(line);
    } else if (key == "ks") {
      entry.specular = colour(line);
    } else if (key == "ke") {
      entry.emission = colour(line);
    } else if (key == "ns") {
      entry.exponent = number(line);
    } else if (key == "ni") {
      entry.index = number(line);
    } else if (key == "d") {
      entry.opacity = number(line);
      entry.has_opacity = true;
      if (entry.opacity <= 0) warn(entry, key, "is fully transparent (d 0): its surfaces are not there");
    } else if (key == "tr") {
      const double transparency = number(line);
      if (!entry.has_opacity) entry.opacity = 1 - transparency;
      if (entry.opacity <= 0)
        warn(
            entry, key,
            "is fully transparent (Tr 1): its surfaces are not there; some programs write Tr the other way round, which d corrects");
    } else if (key == "illum") {
      entry.illumination = int(std::clamp(number(line), 0.0, 10.0));
    } else if (key == "pr") {
      entry.roughness = number(line);
    } else if (key == "pm") {
      entry.metallic = number(line);
    } else if (key == "tf") {
      entry.filter = colour(line);
    } else if (key == "ps") {
      entry.sheen = number(line);
    } else if (key == "pc") {
      entry.coat = number(line);
    } else if (key == "pcr") {
      entry.coat_roughness = number(line);
    } else if (key == "aniso") {
      entry.anisotropy = number(line);
    } else if (key == "anisor") {
      entry.rotation = number(line);
    } else if (const auto missed = std::find_if(not_shown.begin(), not_shown.end(), is_key);
               missed != not_shown.end()) {
      warn(entry, missed->key, missed->sentence);
    } else if (std::find(unneeded.begin(), unneeded.end(), key) == unneeded.end()) {
      reader_.warn("unknown key of materials", fmt::format("{}:{}: the unknown key \"{}\" is ignored", path_, line_,
                                                           printable(std::string_view(key).substr(0, 40))));
    }
  }

  void warn(const Entry& entry, std::string_view feature, const char* sentence) {
    reader_.warn(std::string(feature), fmt::format("material \"{}\" {}", printable(entry.name), sentence));
  }

  double number(std::string_view& line) const {
    std::string_view word = next_word(line);
    if (word == "-halo") word = next_word(line);
    const auto value = number_of(word);
    require(value && std::isfinite(*value), "{}:{}: expected a finite number, got \"{}\"", path_, line_, word);
    return *value;
  }

  Vec3 colour(std::string_view line) {
    const std::string_view first = trimmed(line);
    if (first.starts_with("spectral") || first.starts_with("xyz")) {
      reader_.warn("spectral", fmt::format("{}:{}: a spectral colour is shown grey", path_, line_));
      return {0.6, 0.6, 0.6};
    }
    const double red = number(line);
    if (trimmed(line).empty()) return {red, red, red};
    const double green = number(line), blue = number(line);
    return {red, green, blue};
  }

  // Takes up to `most` numbers off a line.
  static std::vector<double> numbers(std::string_view& line, size_t most) {
    std::vector<double> values;
    for (std::string_view rest = line; values.size() < most; line = rest) {
      const auto value = number_of(next_word(rest));
      if (!value || !std::isfinite(*value)) break;
      values.push_back(*value);
    }
    return values;
  }

  // A texture: options, then the name of its file: "-s 4 4 1 -o 0.5 0 0 bricks.png". The texture is read at
  // u' = s·u + o, v' = s·v + o, v up; TextureCoordinates has v down: 1 − v' = s·(1 − v) + (1 − s − o).
  Map map(std::string_view line) {
    Map result;
    double scale_v = 1, offset_v = 0;
    for (std::string_view rest = line;; line = rest) {
      const std::string_view option = next_word(rest);
      if (option == "-s" || option == "-o" || option == "-t") {
        const std::vector<double> values = numbers(rest, 3);
        if (values.empty()) break;  // the name of a file
        const double first = values[0], second = values.size() > 1 ? values[1] : option == "-s" ? 1 : 0;
        if (option == "-s") result.coordinates.scale_u = first, scale_v = second;
        if (option == "-o") result.coordinates.offset_u = first, offset_v = second;
        if (option == "-t" && values != std::vector<double>(values.size()))
          reader_.warn("-t", fmt::format("{}:{}: the turbulence of a texture (-t) is ignored", path_, line_));
      } else if (option == "-mm") {
        const std::vector<double> values = numbers(rest, 2);
        if (values.size() == 2 && (values[0] != 0 || values[1] != 1))
          reader_.warn("-mm", fmt::format("{}:{}: the range of a texture (-mm) is ignored", path_, line_));
      } else if (option == "-bm" || option == "-boost" || option == "-texres") {
        numbers(rest, 1);
      } else if (option == "-clamp") {
        result.edge = next_word(rest) == "on" ? ImageEdge::clamp : ImageEdge::repeat;
      } else if (option == "-imfchan") {
        const std::string_view channel = next_word(rest);
        result.channel = channel == "g" ? 1 : channel == "b" ? 2 : 0;
      } else if (option == "-blendu" || option == "-blendv" || option == "-cc" || option == "-type") {
        next_word(rest);
      } else {
        break;
      }
    }
    result.coordinates.scale_v = scale_v;
    result.coordinates.offset_v = 1 - scale_v - offset_v;
    result.file = trimmed(line);
    return result;
  }

  ModelReader& reader_;
  std::string path_;
  size_t line_ = 0;
  std::vector<Entry> entries_;
};

double clip(double value) { return value > 0 ? std::min(value, 1.0) : 0.0; }
Vec3 clip(Vec3 c) { return {clip(c.x), clip(c.y), clip(c.z)}; }
bool is_black(Vec3 c) { return c == Vec3{0, 0, 0}; }

// Converts Phong's exponent s to the roughness of a GGX lobe of similar width: α² = 2/(s + 2) (Walter et al.,
// Microfacet Models for Refraction through Rough Surfaces, EGSR 2007, section 5.2), and α = roughness².
double roughness_of_exponent(double exponent) { return std::pow(2 / (std::max(exponent, 0.0) + 2), 0.25); }

// One channel of a picture; 1 without a picture.
struct ChannelOf {
  std::shared_ptr<const Image> image;
  int channel = 0;

  float at(int row, int column, const Image& of) const {
    if (!image) return 1;
    return (*image)(int(int64_t(row) * image->ny / of.ny), int(int64_t(column) * image->nx / of.nx), channel);
  }
};

// Roughness in green, metallic in blue, as glTF has them, of two maps. The smaller one is enlarged.
std::shared_ptr<const Image> metallic_texture_of(const ChannelOf& roughness, const ChannelOf& metallic) {
  if (!roughness.image && !metallic.image) return nullptr;
  const auto larger = [&](int Image::*side) {
    return std::max(roughness.image ? (*roughness.image).*side : 0, metallic.image ? (*metallic.image).*side : 0);
  };
  auto texture = std::make_shared<Image>(larger(&Image::ny), larger(&Image::nx), 3);
  texture->sampling = (roughness.image ? roughness : metallic).image->sampling;
  for (int row = 0; row < texture->ny; ++row)
    for (int column = 0; column < texture->nx; ++column) {
      (*texture)(row, column, 1) = roughness.at(row, column, *texture);
      (*texture)(row, column, 2) = metallic.at(row, column, *texture);
    }
  return texture;
}

// The opacity that a picture says by its alpha or, if it has none, by one of its channels.
std::shared_ptr<const Image> opacity_of(const std::shared_ptr<const Image>& alpha,
                                        const std::shared_ptr<const Image>& data, int channel, bool is_transparency) {
  if (!alpha || !data) return nullptr;
  auto opacity = std::make_shared<Image>(is_alpha(*alpha) ? *alpha : channel_of(*data, channel));
  if (is_transparency && !is_alpha(*alpha))
    for (float& value : opacity->values) value = 1 - value;
  return opacity;
}

FileMaterial material_of(const Entry& entry, ModelReader& reader) {
  FileMaterial result;
  const auto warn = [&](const std::string& feature, const std::string& what) {
    reader.warn(feature, fmt::format("material \"{}\" {}", printable(entry.name), what));
  };
  if (!(clip(entry.diffuse) == entry.diffuse)) warn("colour", "has a colour outside [0, 1]; it is clipped");
  const auto texture = [&](const Map& map, ImageContent content) -> std::shared_ptr<const Image> {
    if (map.file.empty()) return nullptr;
    auto image = reader.load_texture(map.file, content);
    if (!image) return nullptr;
    if (!result.add_texture(map.coordinates))
      warn("coordinates", "has textures with different coordinates (-s, -o); those of the first are used for all");
    if (map.edge == ImageEdge::repeat) return image;
    Image clamped = *image;
    clamped.sampling = {map.edge, map.edge};
    return std::make_shared<Image>(std::move(clamped));
  };
  // A factor of 0 with a texture would be black. Exporters that write this mean the texture alone.
  const auto factor = [](const std::optional<double>& value, const std::shared_ptr<const Image>& image) {
    return image && value.value_or(0) == 0 ? 1 : clip(value.value_or(0));
  };
  const auto base_texture = texture(entry.diffuse_map, ImageContent::colour);
  const Vec3 base = base_texture && is_black(entry.diffuse) ? Vec3{1, 1, 1} : clip(entry.diffuse);
  const ChannelOf roughness{texture(entry.roughness_map, ImageContent::data), entry.roughness_map.channel},
      metallic{texture(entry.metallic_map, ImageContent::data), entry.metallic_map.channel};

  Material& material = result.material;
  const int illumination = entry.illumination;
  const bool is_glass = illumination == 4 || illumination == 6 || illumination == 7 || illumination == 9;
  const bool has_roughness = entry.roughness || roughness.image, has_metallic = entry.metallic || metallic.image;
  // Programs write a white or black filter for opaque materials, too.
  const bool is_filter = !(clip(entry.filter) == Vec3{1, 1, 1}) && !is_black(entry.filter);
  const bool is_solid = is_glass && (entry.opacity < 1 || is_filter) && entry.index > 1;
  const bool is_layered = entry.sheen > 0 || entry.coat > 0 || entry.anisotropy > 0;
  if (is_solid && !is_filter && !is_layered && entry.roughness.value_or(0) == 0) {
    material.surface = DielectricMaterial{constant_index(entry.index)};
  } else if (is_solid || is_layered) {
    PrincipledMaterial layers;
    layers.base_color = {is_solid ? is_filter ? clip(entry.filter) : Vec3{1, 1, 1} : base,
                         {is_solid ? nullptr : base_texture}};
    layers.transmission = {is_solid ? 1.0 : 0.0};
    if (entry.index > 1) layers.index = constant_index(entry.index);
    const auto of_map = [&](const std::optional<double>& value, const ChannelOf& map) -> TexturedNumber {
      return {factor(value, map.image),
              {map.image ? std::make_shared<const Image>(channel_of(*map.image, map.channel)) : nullptr}};
    };
    layers.metalness = of_map(entry.metallic, metallic);
    layers.roughness =
        of_map(has_roughness || is_solid ? entry.roughness : roughness_of_exponent(entry.exponent), roughness);
    layers.sheen_color.value = base * clip(entry.sheen);  // Ps has no colour
    layers.clearcoat = {clip(entry.coat)};
    layers.clearcoat_roughness = {clip(entry.coat_roughness)};
    layers.anisotropy = {clip(entry.anisotropy)};
    layers.anisotropy_rotation = 2 * pi * entry.rotation;
    material.surface = std::move(layers);
  } else if (has_roughness || has_metallic || (illumination >= 2 && !is_black(entry.specular))) {
    material.surface = MetallicRoughnessMaterial{
        base, base_texture, factor(entry.metallic, metallic.image),
        has_roughness ? factor(entry.roughness, roughness.image) : roughness_of_exponent(entry.exponent),
        metallic_texture_of(roughness, metallic)};
  } else {
    material.surface = DiffuseMaterial{base, base_texture};
  }
  if (!is_solid) {
    const bool is_transparency = entry.opacity_map.file.empty();
    const Map& map = is_transparency ? entry.transparency_map : entry.opacity_map;
    material.opacity_texture =
        opacity_of(texture(map, ImageContent::alpha), texture(map, ImageContent::data), map.channel, is_transparency);
    material.opacity = material.opacity_texture && clip(entry.opacity) == 0 ? 1 : clip(entry.opacity);
  }

  material.emission_texture = texture(entry.emission_map, ImageContent::colour);
  material.emission = {std::max(entry.emission.x, 0.0), std::max(entry.emission.y, 0.0),
                       std::max(entry.emission.z, 0.0)};
  if (material.emission_texture && is_black(entry.emission)) material.emission = {1, 1, 1};
  material.normal_map = texture(entry.normal_map, ImageContent::data);
  return result;
}

// The files that the words after "mtllib" name, and where they are: one name with spaces, or several names.
struct MaterialFile {
  std::string name, path;
};

std::vector<MaterialFile> files_of(const ModelReader& reader, const std::string& names) {
  const auto find = [&](std::string_view name) {
    return MaterialFile{std::string(name), find_beside(std::string(name), reader.path(), reader.outside())};
  };
  const MaterialFile whole = find(names);
  std::vector<MaterialFile> files;
  std::string_view rest = names;
  for (std::string_view word = next_word(rest); !word.empty() && whole.path.empty(); word = next_word(rest))
    files.push_back(find(word));
  const bool are_names = std::any_of(files.begin(), files.end(), [](const auto& f) { return !f.path.empty(); });
  return are_names ? files : std::vector{whole};
}

}  // namespace

void read_obj_materials(ModelReader& reader, const std::string& names, ObjMaterials& into) {
  if (names.empty()) return;
  for (const auto& [name, path] : files_of(reader, names)) {
    if (path.empty()) {
      into.is_incomplete = true;
      reader.warn("missing " + name,
                  fmt::format("the file of materials {} is missing; its materials are shown grey", name));
      continue;
    }
    for (const Entry& entry : Entries(reader, path).read()) {
      if (!into.numbers.emplace(entry.name, into.materials.size()).second) continue;
      into.materials.push_back(material_of(entry, reader));
    }
  }
}

}  // namespace holotrace
