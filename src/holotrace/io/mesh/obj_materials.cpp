#include "holotrace/io/mesh/obj_materials.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view blanks = " \t\r";

// Takes the next word off a line; "" at its end.
std::string_view next_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  return word;
}

std::string trimmed(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  return std::string(line.substr(0, line.find_last_not_of(blanks) + 1));
}

std::optional<double> number_of(std::string_view word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

// One material as written.
struct Entry {
  std::string name;
  Vec3 diffuse{0.6, 0.6, 0.6}, specular{}, emission{};
  double exponent = 0, index = 1, opacity = 1;
  int illumination = 1;
  std::optional<double> roughness, metallic;
  std::string diffuse_map, emission_map, normal_map;
  bool has_bump = false;
};

// Reads the lines of an MTL file.
class Entries {
 public:
  Entries(ModelReader& reader, std::string path) : reader_(reader), path_(std::move(path)) {}

  std::vector<Entry> read() {
    const std::string text = read_text(path_, most_text);
    for (size_t at = 0, end = 0; at < text.size(); at = end + 1) {
      end = std::min(text.find('\n', at), text.size());
      ++line_;
      read_line(std::string_view(text).substr(at, end - at));
    }
    return std::move(entries_);
  }

 private:
  void read_line(std::string_view line) {
    std::string key(next_word(line));
    std::transform(key.begin(), key.end(), key.begin(), [](unsigned char c) { return std::tolower(c); });
    if (key.empty() || key[0] == '#') return;
    if (key == "newmtl") {
      entries_.emplace_back().name = trimmed(line);
    } else if (entries_.empty()) {
      reader_.warn("before newmtl",
                   fmt::format("{}:{}: what comes before the first \"newmtl\" is ignored", path_, line_));
    } else {
      read_value(key, line, entries_.back());
    }
  }

  void read_value(const std::string& key, std::string_view line, Entry& entry) {
    if (key == "kd") entry.diffuse = colour(line);
    if (key == "ks") entry.specular = colour(line);
    if (key == "ke") entry.emission = colour(line);
    if (key == "ns") entry.exponent = number(line);
    if (key == "ni") entry.index = number(line);
    if (key == "d") entry.opacity = number(line);
    if (key == "tr") entry.opacity = 1 - number(line);
    if (key == "illum") entry.illumination = int(std::clamp(number(line), 0.0, 10.0));
    if (key == "pr") entry.roughness = number(line);
    if (key == "pm") entry.metallic = number(line);
    if (key == "map_kd") entry.diffuse_map = file_name(line);
    if (key == "map_ke" || key == "map_emissive") entry.emission_map = file_name(line);
    if (key == "norm" || key == "map_kn") entry.normal_map = file_name(line);
    if (key == "bump" || key == "map_bump") entry.has_bump = true;
  }

  double number(std::string_view& line) const {
    std::string_view word = next_word(line);
    if (word == "-halo") word = next_word(line);
    const auto value = number_of(word);
    require(value && std::isfinite(*value), "{}:{}: expected a finite number, got \"{}\"", path_, line_, word);
    return *value;
  }

  Vec3 colour(std::string_view line) {
    const std::string_view first = std::string_view(line).substr(std::min(line.find_first_not_of(blanks), line.size()));
    if (first.starts_with("spectral") || first.starts_with("xyz")) {
      reader_.warn("spectral", fmt::format("{}:{}: a spectral colour is shown grey", path_, line_));
      return {0.6, 0.6, 0.6};
    }
    const double red = number(line);
    if (trimmed(line).empty()) return {red, red, red};
    const double green = number(line), blue = number(line);
    return {red, green, blue};
  }

  // The name after the options: "-s 1 1 1 -bm 0.5 bricks.png". Options have one word, some of them up to three numbers.
  static std::string file_name(std::string_view line) {
    for (std::string_view rest = line;;) {
      const std::string_view option = next_word(rest);
      if (option.size() < 2 || option[0] != '-' || number_of(option)) return trimmed(line);
      if (option != "-o" && option != "-s" && option != "-t" && option != "-mm") next_word(rest);
      line = rest;
      while (number_of(next_word(rest))) line = rest;
      rest = line;
    }
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

FileMaterial material_of(const Entry& entry, ModelReader& reader) {
  FileMaterial result;
  if (!(clip(entry.diffuse) == entry.diffuse))
    reader.warn("colour", fmt::format("material \"{}\" has a colour outside [0, 1]; it is clipped", entry.name));
  const auto texture = [&](const std::string& file, ImageContent content) -> std::shared_ptr<const Image> {
    if (file.empty()) return nullptr;
    auto image = reader.load_texture(file, content);
    result.has_textures = result.has_textures || image;
    return image;
  };
  // Kd 0 with a texture would be black. Exporters that write this mean the texture alone.
  const auto base_texture = texture(entry.diffuse_map, ImageContent::colour);
  const Vec3 base = base_texture && is_black(entry.diffuse) ? Vec3{1, 1, 1} : clip(entry.diffuse);

  Material& material = result.material;
  const int illumination = entry.illumination;
  const bool is_glass = illumination == 4 || illumination == 6 || illumination == 7 || illumination == 9;
  if (is_glass && entry.opacity < 1 && entry.index > 1) {
    material.surface = DielectricMaterial{constant_index(entry.index)};
  } else if (entry.roughness || entry.metallic || (illumination >= 2 && !is_black(entry.specular))) {
    material.surface =
        MetallicRoughnessMaterial{base, base_texture, clip(entry.metallic.value_or(0)),
                                  entry.roughness ? clip(*entry.roughness) : roughness_of_exponent(entry.exponent)};
  } else {
    material.surface = DiffuseMaterial{base, base_texture};
  }
  if (entry.opacity < 1 && !std::holds_alternative<DielectricMaterial>(material.surface))
    reader.warn("see-through", fmt::format("material \"{}\" is transparent; it is shown opaque", entry.name));

  material.emission_texture = texture(entry.emission_map, ImageContent::colour);
  material.emission = {std::max(entry.emission.x, 0.0), std::max(entry.emission.y, 0.0),
                       std::max(entry.emission.z, 0.0)};
  if (material.emission_texture && is_black(entry.emission)) material.emission = {1, 1, 1};
  material.normal_map = texture(entry.normal_map, ImageContent::data);
  if (entry.has_bump)
    reader.warn("bump", fmt::format("material \"{}\" has a bump map; it is ignored; give a normal map by \"norm\"",
                                    entry.name));
  return result;
}

// The files that the words after "mtllib" name: one name with spaces, or several names.
std::vector<std::string> files_of(const fs::path& folder, const std::string& name) {
  std::error_code ignored;
  const std::string whole = (folder / name).string();
  if (fs::exists(whole, ignored) || name.find_first_of(blanks) == std::string::npos) return {whole};
  std::vector<std::string> files;
  std::string_view rest = name;
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest))
    files.push_back((folder / word).string());
  return files;
}

}  // namespace

void read_obj_materials(ModelReader& reader, const std::string& name, ObjMaterials& into) {
  std::string relative = trimmed(name);
  std::replace(relative.begin(), relative.end(), '\\', '/');
  if (relative.empty()) return;
  for (const std::string& file : files_of(fs::path(reader.path()).parent_path(), relative)) {
    std::error_code ignored;
    if (!fs::exists(file, ignored)) {
      reader.warn("missing " + file,
                  fmt::format("the file of materials {} is missing; its materials are shown grey", file));
      continue;
    }
    require_inside(file, reader.path(), reader.outside());
    for (const Entry& entry : Entries(reader, file).read()) {
      if (!into.numbers.emplace(entry.name, into.materials.size()).second) continue;
      into.materials.push_back(material_of(entry, reader));
    }
  }
}

}  // namespace holotrace
