#include <assimp/material.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {
namespace {

constexpr const char* illumination_key = "$mat.illum";  // Assimp's key for the number after "illum"

// A number or colour of the material, or `otherwise` if the file does not state it.
template <class T>
T get(const aiMaterial& source, const char* key, T otherwise) {
  T value;
  return source.Get(key, 0, 0, value) == aiReturn_SUCCESS ? value : otherwise;
}

double clip(double value) { return value > 0 ? std::min(value, 1.0) : 0.0; }

Vec3 clip(const aiColor3D& c) { return {clip(c.r), clip(c.g), clip(c.b)}; }

bool has_texture(const aiMaterial& source, aiTextureType type, aiString& name) {
  return source.GetTexture(type, 0, &name) == aiReturn_SUCCESS;
}

// Converts Phong's exponent s to the roughness of a GGX lobe of similar width: α² = 2/(s + 2) (Walter et al.,
// Microfacet Models for Refraction through Rough Surfaces, EGSR 2007, section 5.2), and α = roughness².
double roughness_of_exponent(double exponent) { return std::pow(2 / (std::max(exponent, 0.0) + 2), 0.25); }

}  // namespace

FileMaterial obj_material(const aiMaterial& source, const ObjTextures& load, const WarnOnce& warn) {
  const std::string name = source.GetName().C_Str();
  FileMaterial result;
  if (name == AI_DEFAULT_MATERIAL_NAME) return result;
  const aiColor3D diffuse = get(source, "$clr.diffuse", aiColor3D(0.8f)),
                  specular = get(source, "$clr.specular", aiColor3D());
  const float opacity = get(source, "$mat.opacity", 1.f), index = get(source, "$mat.refracti", 1.f);
  const int illumination = get(source, illumination_key, 1);
  for (float value : {diffuse.r, diffuse.g, diffuse.b})
    if (!(value >= 0 && value <= 1))
      warn("colour", fmt::format("material \"{}\" has a colour outside [0, 1]; it is clipped", name));

  const auto texture = [&](aiTextureType type, ImageContent content) -> std::shared_ptr<const Image> {
    aiString file;
    if (!has_texture(source, type, file)) return nullptr;
    auto image = load(file.C_Str(), content);
    result.has_textures = result.has_textures || image;
    return image;
  };
  // Kd 0 with a texture would be black. Exporters that write this mean the texture alone.
  const auto base_texture = texture(aiTextureType_DIFFUSE, ImageContent::colour);
  const Vec3 base = base_texture && diffuse.IsBlack() ? Vec3{1, 1, 1} : clip(diffuse);

  Material& material = result.material;
  float roughness = 0, metallic = 0;
  const bool has_roughness = source.Get(AI_MATKEY_ROUGHNESS_FACTOR, roughness) == aiReturn_SUCCESS;
  const bool has_metallic = source.Get(AI_MATKEY_METALLIC_FACTOR, metallic) == aiReturn_SUCCESS;
  const bool is_glass = illumination == 4 || illumination == 6 || illumination == 7 || illumination == 9;
  if (is_glass && opacity < 1 && index > 1) {
    material.surface = DielectricMaterial{constant_index(index)};
  } else if (has_roughness || has_metallic || (illumination >= 2 && !specular.IsBlack())) {
    const double exponent = get(source, "$mat.shininess", 0.f);
    material.surface = MetallicRoughnessMaterial{base, base_texture, clip(metallic),
                                                 has_roughness ? clip(roughness) : roughness_of_exponent(exponent)};
  } else {
    material.surface = DiffuseMaterial{base, base_texture};
  }
  if (opacity < 1 && !std::holds_alternative<DielectricMaterial>(material.surface))
    warn("see-through", fmt::format("material \"{}\" is transparent; it is shown opaque", name));

  const aiColor3D emission = get(source, "$clr.emissive", aiColor3D());
  const Vec3 emitted{emission.r, emission.g, emission.b};
  material.emission_texture = texture(aiTextureType_EMISSIVE, ImageContent::colour);
  if (is_finite(emitted))
    material.emission = {std::max(emitted.x, 0.0), std::max(emitted.y, 0.0), std::max(emitted.z, 0.0)};
  if (material.emission_texture && emission.IsBlack()) material.emission = {1, 1, 1};
  material.normal_map = texture(aiTextureType_NORMALS, ImageContent::data);
  if (source.GetTextureCount(aiTextureType_HEIGHT) > 0)
    warn("bump", fmt::format("material \"{}\" has a bump map; it is ignored; give a normal map by \"norm\"", name));
  return result;
}

// Assimp silently drops texture coordinates and normals whose indices are out of range, and reports bad vertex
// indices without their line. So the faces of an OBJ file are checked here first.
void check_obj_indices(const std::string& path) {
  struct Farthest {
    int64_t index = 0;
    size_t line = 0;
  };
  constexpr std::array kinds{"vertex", "texture coordinate", "normal"};
  std::array<int64_t, 3> counts{};
  std::array<Farthest, 3> farthest;
  const auto refuse = [&](size_t line, size_t kind, int64_t index) {
    fail("{}:{}: expected {} indices from 1 to {} or as far back, got {}; export the mesh again", path, line,
         kinds[kind], counts[kind], index);
  };
  const std::string text = read_text(path);
  size_t line = 0;
  for (size_t at = 0, end = 0; at < text.size(); at = end + 1) {
    ++line;
    end = std::min(text.find('\n', at), text.size());
    std::string_view words = std::string_view(text).substr(at, end - at);
    words.remove_prefix(std::min(words.find_first_not_of(" \t"), words.size()));
    const std::string_view keyword = words.substr(0, words.find_first_of(" \t"));
    if (keyword == "v") ++counts[0];
    if (keyword == "vt") ++counts[1];
    if (keyword == "vn") ++counts[2];
    if (keyword != "f") continue;
    size_t kind = 0;
    for (const char *c = words.data() + 1, *stop = words.data() + words.size(); c < stop;) {
      int64_t index = 0;
      const auto [next, error] = std::from_chars(c, stop, index);
      if (error == std::errc::invalid_argument) {
        kind = *c == '/' ? kind + 1 : 0;
        ++c;
        continue;
      }
      if (kind < 3) {
        if (error != std::errc() || index == 0 || index < -counts[kind]) refuse(line, kind, index);
        if (index > farthest[kind].index) farthest[kind] = {index, line};
      }
      c = next;
    }
  }
  for (size_t kind = 0; kind < 3; ++kind)
    if (farthest[kind].index > counts[kind]) refuse(farthest[kind].line, kind, farthest[kind].index);
}

}  // namespace holotrace
