#include <algorithm>
#include <array>
#include <map>

#include "holotrace/base/error.h"
#include "holotrace/io/mesh/gltf.h"

namespace holotrace {
namespace {

using Json = nlohmann::json;
using Texture = std::shared_ptr<const Image>;

const Json& member(const Json& parent, const char* key) {
  static const Json none = Json::object();
  const auto found = parent.find(key);
  return found == parent.end() ? none : *found;
}

class Materials {
 public:
  Materials(const GltfFile& gltf, const WarnOnce& warn) : gltf_(gltf), warn_(warn) {}

  FileMaterial read(const Json& source, const std::string& name) {
    result_ = {};
    name_ = name;
    const Json& extensions = member(source, "extensions");
    const Json& core = member(source, "pbrMetallicRoughness");
    MetallicRoughnessMaterial surface;
    surface.base_color = colour(core, "baseColorFactor");
    surface.base_texture = texture(core, "baseColorTexture", ImageContent::colour);
    surface.metallic = clip(core.value("metallicFactor", 1.0));
    surface.roughness = clip(core.value("roughnessFactor", 1.0));
    surface.metallic_texture = texture(core, "metallicRoughnessTexture", ImageContent::data);
    if (extensions.contains("KHR_materials_pbrSpecularGlossiness"))
      surface = specular_glossiness(extensions["KHR_materials_pbrSpecularGlossiness"]);

    Material& material = result_.material;
    material.emission_texture = texture(source, "emissiveTexture", ImageContent::colour);
    material.emission = vector(source, "emissiveFactor", {0, 0, 0}) *
                        member(extensions, "KHR_materials_emissive_strength").value("emissiveStrength", 1.0);
    require(
        is_finite(material.emission) && std::min({material.emission.x, material.emission.y, material.emission.z}) >= 0,
        "{}: expected emissive factors of 0 or more in material \"{}\"", gltf_.path, name_);
    material.normal_map = texture(source, "normalTexture", ImageContent::data);
    material.normal_scale = member(source, "normalTexture").value("scale", 1.0);
    read_opacity(source, core, material);

    const double index = member(extensions, "KHR_materials_ior").value("ior", 1.5);
    const Json& transmission = member(extensions, "KHR_materials_transmission");
    const double transmitted = transmission.value("transmissionFactor", 0.0);
    if (extensions.contains("KHR_materials_unlit")) {
      material.surface = DiffuseMaterial{{0, 0, 0}};
      material.emission = surface.base_color;
      material.emission_texture = surface.base_texture;
    } else if (transmitted == 1 && !transmission.contains("transmissionTexture") && index > 0) {
      material.surface = glass(surface, index, member(extensions, "KHR_materials_volume"));
    } else {
      if (transmitted > 0) warn("partly see-through", "is partly transparent; it is shown opaque");
      if (index != 1.5) warn("index", "has a clear coat of an index other than 1.5; 1.5 is used");
      material.surface = surface;
    }
    warn_of_extensions(extensions);
    return std::move(result_);
  }

 private:
  static constexpr double least_cutoff = 1e-9;  // a cutoff of 0 shows all but is a mask, too

  void warn(const std::string& feature, const std::string& what) {
    warn_(feature, fmt::format("material \"{}\" {}", name_, what));
  }

  static double clip(double value) { return value > 0 ? std::min(value, 1.0) : 0.0; }

  static Vec3 vector(const Json& parent, const char* key, Vec3 otherwise) {
    if (!parent.contains(key)) return otherwise;
    const Json& v = parent[key];
    return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()};
  }

  Vec3 colour(const Json& parent, const char* key) {
    const Vec3 given = vector(parent, key, {1, 1, 1}), clipped{clip(given.x), clip(given.y), clip(given.z)};
    if (!(given == clipped)) warn("colour", "has a colour outside [0, 1]; it is clipped");
    return clipped;
  }

  // Index of a texture's image; -1 if its format is not supported.
  int image_of(const Json& texture) {
    const Json& webp = member(member(texture, "extensions"), "EXT_texture_webp");
    for (const Json* from : {&texture, &webp})
      if (from->contains("source")) return int(std::min<size_t>(gltf_count(gltf_, from->at("source")), 1 << 30));
    return -1;
  }

  Texture texture(const Json& parent, const char* key, ImageContent content) {
    if (!parent.contains(key)) return nullptr;
    const Json& info = parent[key];
    const Json& source = gltf_.document.at("textures").at(gltf_count(gltf_, info.at("index")));
    const Texture image = load(image_of(source), content);
    if (!image) return nullptr;
    if (!result_.add_texture(coordinates_of(info)))
      warn("coordinates", "has textures with different coordinates; those of the first are used for all");
    if (source.contains("sampler")) {
      const Json& sampler = gltf_.document.at("samplers").at(gltf_count(gltf_, source["sampler"]));
      constexpr size_t repeat = 10497;
      for (const char* axis : {"wrapS", "wrapT"})
        result_.repeats = result_.repeats && gltf_count(gltf_, sampler, axis, repeat) == repeat;
    }
    return image;
  }

  TextureCoordinates coordinates_of(const Json& info) {
    const Json& transform = member(member(info, "extensions"), "KHR_texture_transform");
    TextureCoordinates t;
    t.set = int(
        std::min<size_t>(gltf_count(gltf_, transform, "texCoord", gltf_count(gltf_, info, "texCoord", 0)), 1 << 30));
    t.rotation = transform.value("rotation", 0.0);
    if (transform.contains("offset")) {
      t.offset_u = transform["offset"].at(0).get<double>();
      t.offset_v = transform["offset"].at(1).get<double>();
    }
    if (transform.contains("scale")) {
      t.scale_u = transform["scale"].at(0).get<double>();
      t.scale_v = transform["scale"].at(1).get<double>();
    }
    return t;
  }

  Texture load(int image, ImageContent content) {
    if (image < 0) {
      warn("texture", "has a texture in an unknown format; its plain colour is used");
      return nullptr;
    }
    Texture& loaded = images_[{image, content}];
    if (loaded) return loaded;
    std::string label;
    const std::string bytes = gltf_image(gltf_, image, label);
    if (bytes.empty()) {
      warn_("missing " + label, fmt::format("the texture {} is missing; the plain colour is used", label));
      return nullptr;
    }
    Image decoded = decode_image(bytes.data(), bytes.size(), label, content);
    if (content == ImageContent::data) decoded = with_three_channels(std::move(decoded));
    return loaded = std::make_shared<Image>(std::move(decoded));
  }

  DielectricMaterial glass(const MetallicRoughnessMaterial& surface, double index, const Json& volume) {
    if (!(surface.base_color == Vec3{1, 1, 1}) || surface.base_texture || volume.contains("attenuationColor"))
      warn("tint", "is tinted glass; it is shown clear");
    if (surface.metallic_texture)
      warn("rough glass", "is glass with a roughness texture; only its roughness factor is used");
    return {constant_index(index), surface.roughness, volume.value("thicknessFactor", 0.0) == 0};
  }

  MetallicRoughnessMaterial specular_glossiness(const Json& source) {
    warn("specular-glossiness", "uses specular-glossiness; its specular colour is ignored");
    MetallicRoughnessMaterial surface;
    surface.base_color = colour(source, "diffuseFactor");
    surface.base_texture = texture(source, "diffuseTexture", ImageContent::colour);
    surface.metallic = 0;
    surface.roughness = 1 - clip(source.value("glossinessFactor", 1.0));
    return surface;
  }

  // OPAQUE, MASK (with its cutoff) or BLEND: the alpha of the base colour.
  void read_opacity(const Json& source, const Json& core, Material& material) {
    const std::string mode = source.value("alphaMode", "OPAQUE");
    if (mode != "MASK" && mode != "BLEND") return;
    if (core.contains("baseColorFactor")) material.opacity = clip(core["baseColorFactor"].at(3).get<double>());
    const Texture alpha = texture(core, "baseColorTexture", ImageContent::alpha);
    if (alpha && is_alpha(*alpha)) material.opacity_texture = alpha;
    if (mode == "MASK") material.opacity_cutoff = std::max(clip(source.value("alphaCutoff", 0.5)), least_cutoff);
  }

  void warn_of_extensions(const Json& extensions) {
    constexpr std::array known{"KHR_materials_pbrSpecularGlossiness",
                               "KHR_materials_emissive_strength",
                               "KHR_materials_ior",
                               "KHR_materials_transmission",
                               "KHR_materials_volume",
                               "KHR_materials_unlit"};
    for (const auto& [name, content] : extensions.items())
      if (std::find(known.begin(), known.end(), name) == known.end())
        warn(name, fmt::format("has the extension {}; it is ignored", name));
  }

  const GltfFile& gltf_;
  const WarnOnce& warn_;
  std::string name_;
  FileMaterial result_;
  std::map<std::pair<int, ImageContent>, Texture> images_;
};

}  // namespace

std::vector<FileMaterial> gltf_materials(const GltfFile& gltf, const WarnOnce& warn) {
  std::vector<FileMaterial> materials;
  Materials reader(gltf, warn);
  try {
    for (const Json& source : gltf.document.value("materials", Json::array()))
      materials.push_back(reader.read(source, source.value("name", std::to_string(materials.size()))));
    materials.push_back(reader.read(Json::object(), "default"));
  } catch (const Json::exception& e) {
    fail("{}: expected a glTF model, but material {} is damaged ({}); export it again", gltf.path, materials.size(),
         reason(e));
  }
  return materials;
}

void warn_of_gltf_features(const GltfFile& gltf, const WarnOnce& warn) try {
  const Json& document = gltf.document;
  if (!member(document, "cameras").empty()) warn("cameras", "cameras are ignored");
  for (const Json& item : member(document, "extensionsUsed")) {
    const std::string name = item.get<std::string>();
    if (name == "KHR_lights_punctual")
      warn("lights", "the model's lights are ignored; place them in the scene");
    else if (!name.starts_with("KHR_materials_") && name != "KHR_texture_transform" && name != "EXT_texture_webp" &&
             name != "KHR_animation_pointer" && name != "KHR_node_visibility" && name != "KHR_mesh_quantization" &&
             name != "KHR_draco_mesh_compression" && name != "EXT_meshopt_compression")
      warn(name, fmt::format("the extension {} is ignored", name));
  }
} catch (const Json::exception& e) {
  fail("{}: expected a glTF model, but it is damaged ({}); export it again", gltf.path, reason(e));
}

}  // namespace holotrace
