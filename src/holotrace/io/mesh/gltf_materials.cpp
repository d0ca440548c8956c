#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

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
    is_layered_ = false;
    const Json& extensions = member(source, "extensions");
    const Json& core = member(source, "pbrMetallicRoughness");
    Material& material = result_.material;
    const bool is_unlit = extensions.contains("KHR_materials_unlit");  // its base colour alone is shown
    // Textures of all surfaces are at the coordinates of the mesh, those of layers may be elsewhere.
    if (!is_unlit) material.emission_texture = texture_of_mesh(source, "emissiveTexture", ImageContent::colour);
    material.emission = vector(source, "emissiveFactor", {0, 0, 0}) *
                        member(extensions, "KHR_materials_emissive_strength").value("emissiveStrength", 1.0);
    require(
        is_finite(material.emission) && std::min({material.emission.x, material.emission.y, material.emission.z}) >= 0,
        "{}: expected emissive factors of 0 or more in material \"{}\"", gltf_.path, name_);
    if (!is_unlit) material.normal_map = texture_of_mesh(source, "normalTexture", ImageContent::data);
    material.normal_scale = member(source, "normalTexture").value("scale", 1.0);
    place_of_normals_ = coordinates_of(member(source, "normalTexture"));
    const Json& glossy = member(extensions, "KHR_materials_pbrSpecularGlossiness");
    const bool is_glossy = extensions.contains("KHR_materials_pbrSpecularGlossiness");
    if (is_glossy)  // the core's model is beside it for programs without the extension
      read_opacity(source, glossy, "diffuseFactor", "diffuseTexture", material);
    else
      read_opacity(source, core, "baseColorFactor", "baseColorTexture", material);

    PrincipledMaterial layers = is_glossy ? specular_glossiness(glossy) : base(core);
    const Texture base_texture = layers.base_color.texture.image;
    const PlacedTexture metallic =
        is_glossy ? PlacedTexture() : texture(core, "metallicRoughnessTexture", ImageContent::data);
    read_layers(extensions, layers, metallic.image != nullptr);
    if (is_unlit) {
      material.surface = DiffuseMaterial{{0, 0, 0}};
      material.emission = layers.base_color.value;
      material.emission_texture = base_texture;
    } else if (is_layered_) {
      if (!layers.roughness.texture.image) layers.roughness.texture = channel(metallic, 1);
      if (layers.metalness.value > 0) layers.metalness.texture = channel(metallic, 2);
      material.surface = std::move(layers);
    } else if (layers.transmission.value == 1) {
      material.surface = DielectricMaterial{std::move(layers.index), layers.roughness.value, layers.is_thin};
    } else {
      material.surface = MetallicRoughnessMaterial{layers.base_color.value, base_texture, layers.metalness.value,
                                                   layers.roughness.value, metallic.image};
    }
    warn_of_extensions(extensions);
    return std::move(result_);
  }

 private:
  static constexpr double least_cutoff = 1e-9;  // a cutoff of 0 shows all but is a mask, too
  static constexpr double most_index = 1e4;

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

  PlacedTexture texture(const Json& parent, const char* key, ImageContent content) {
    if (!parent.contains(key)) return {};
    const Json& info = parent[key];
    const Json& source = gltf_.document.at("textures").at(gltf_count(gltf_, info.at("index")));
    PlacedTexture found{load(image_of(source), content, sampling_of(source))};
    if (!found.image) return {};
    const TextureCoordinates at = coordinates_of(info);
    if (!result_.add_texture(at)) {
      if (at.set != result_.coordinates.set) {
        if (result_.second_set < 0) result_.second_set = at.set;
        if (at.set == result_.second_set) {
          found = affine(at, found.image);
          found.is_second = true;
        } else {
          warn("coordinates", "has textures at more than two sets of coordinates; the third is at those of the first");
        }
      }
      if (!found.is_second && !place(at, result_.coordinates, found))
        warn("transform", "has a texture that is scaled to 0; the others have its coordinates, too");
      is_layered_ = true;
    }
    return found;
  }

  ImageSampling sampling_of(const Json& texture) {
    ImageSampling sampling;
    if (!texture.contains("sampler")) return sampling;
    constexpr size_t repeat = 10497, mirror = 33648, nearest = 9728;
    const Json& sampler = gltf_.document.at("samplers").at(gltf_count(gltf_, texture["sampler"]));
    const auto edge = [&](const char* axis) {
      const size_t mode = gltf_count(gltf_, sampler, axis, repeat);
      return mode == repeat ? ImageEdge::repeat : mode == mirror ? ImageEdge::mirror : ImageEdge::clamp;
    };
    sampling.edge_u = edge("wrapS");
    sampling.edge_v = edge("wrapT");
    sampling.is_stepped = gltf_count(gltf_, sampler, "magFilter", 0) == nearest;
    return sampling;
  }

  // The same, for textures that only have the coordinates of the mesh.
  Texture texture_of_mesh(const Json& parent, const char* key, ImageContent content) {
    const bool was_layered = is_layered_;
    const PlacedTexture found = texture(parent, key, content);
    if (is_layered_ && !was_layered)
      warn(
          "coordinates of " + std::string(key),
          "has textures of emission, normals and opacity at different coordinates; those of the first are used for all "
          "three");
    is_layered_ = was_layered;
    return found.image;
  }

  // An image at the coordinates of the file.
  static PlacedTexture affine(const TextureCoordinates& t, Texture image = {}) {
    const Vec2 o = transform_coordinates(t, {0, 0}), u = transform_coordinates(t, {1, 0}),
               v = transform_coordinates(t, {0, 1});
    return {std::move(image), u.x - o.x, v.x - o.x, o.x, u.y - o.y, v.y - o.y, o.y};
  }

  // Where a texture is read, from the coordinates of another one; false if those are scaled to 0.
  static bool place(const TextureCoordinates& at, const TextureCoordinates& of_mesh, PlacedTexture& texture) {
    const PlacedTexture to = affine(at), from = affine(of_mesh);
    const double size = from.uu * from.vv - from.uv * from.vu;
    if (size == 0) return false;
    texture.uu = (to.uu * from.vv - to.uv * from.vu) / size;
    texture.uv = (to.uv * from.uu - to.uu * from.uv) / size;
    texture.vu = (to.vu * from.vv - to.vv * from.vu) / size;
    texture.vv = (to.vv * from.uu - to.vu * from.uv) / size;
    texture.u0 = to.u0 - texture.uu * from.u0 - texture.uv * from.v0;
    texture.v0 = to.v0 - texture.vu * from.u0 - texture.vv * from.v0;
    return true;
  }

  // One channel of a texture: red, green, blue or, 3, alpha.
  PlacedTexture channel(const Json& parent, const char* key, int of) {
    if (of < 3) return channel(texture(parent, key, ImageContent::data), of);
    PlacedTexture alpha = texture(parent, key, ImageContent::alpha);
    if (alpha.image && !is_alpha(*alpha.image)) alpha.image = nullptr;
    return alpha;
  }

  PlacedTexture channel(PlacedTexture of_colours, int of) {
    if (!of_colours.image) return of_colours;
    Texture& part = channels_[{of_colours.image, of}];
    if (!part) part = std::make_shared<Image>(channel_of(*of_colours.image, of));
    of_colours.image = part;
    return of_colours;
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

  Texture load(int image, ImageContent content, const ImageSampling& sampling) {
    if (image < 0) {
      warn("texture", "has a texture in an unknown format; its plain colour is used");
      return nullptr;
    }
    Texture& loaded = images_[{image, content, sampling}];
    if (loaded) return loaded;
    std::string label;
    const std::string bytes = gltf_image(gltf_, image, label);
    if (bytes.empty()) {
      warn_("missing " + label, fmt::format("the texture {} is missing; the plain colour is used", label));
      return nullptr;
    }
    Image decoded = decode_image(bytes.data(), bytes.size(), label, content);
    if (content == ImageContent::data) decoded = with_three_channels(std::move(decoded));
    decoded.sampling = sampling;
    return loaded = std::make_shared<Image>(std::move(decoded));
  }

  // The core's model, without its textures of roughness and metalness.
  PrincipledMaterial base(const Json& core) {
    PrincipledMaterial surface;
    surface.base_color = {colour(core, "baseColorFactor"), texture(core, "baseColorTexture", ImageContent::colour)};
    surface.metalness = {clip(core.value("metallicFactor", 1.0))};
    surface.roughness = {clip(core.value("roughnessFactor", 1.0))};
    return surface;
  }

  // Specular-glossiness: F₀ is its specular colour, which 0.04·specular_color is here, too.
  PrincipledMaterial specular_glossiness(const Json& source) {
    constexpr double f0_of_glass = 0.04;
    PrincipledMaterial surface;
    surface.base_color = {colour(source, "diffuseFactor"), texture(source, "diffuseTexture", ImageContent::colour)};
    surface.specular_color = {vector(source, "specularFactor", {1, 1, 1}) / f0_of_glass,
                              texture(source, "specularGlossinessTexture", ImageContent::colour)};
    const double glossiness = clip(source.value("glossinessFactor", 1.0));
    surface.roughness = {1 - glossiness};
    if (PlacedTexture gloss = channel(source, "specularGlossinessTexture", 3); gloss.image) {
      Image rough = *gloss.image;
      for (float& value : rough.values) value = float(1 - glossiness * double(value));
      gloss.image = std::make_shared<Image>(std::move(rough));
      surface.roughness = {1, gloss};
    }
    is_layered_ = true;
    return surface;
  }

  TexturedNumber number(const Json& extension, const char* factor, double otherwise, const char* texture_key,
                        int of_channel) {
    return {clip(extension.value(factor, otherwise)), channel(extension, texture_key, of_channel)};
  }

  // The extensions of materials that are layers.
  void read_layers(const Json& extensions, PrincipledMaterial& surface, bool has_roughness_texture) {
    const double ior = member(extensions, "KHR_materials_ior").value("ior", 1.5);
    require(std::isfinite(ior) && ior >= 0, "{}: expected an index of 0 or more in material \"{}\", got {:g}",
            gltf_.path, name_, ior);
    const double index = ior >= 1 ? ior : most_index;  // 0 asks for total reflection
    const double dispersion = member(extensions, "KHR_materials_dispersion").value("dispersion", 0.0);
    surface.index = dispersion > 0 ? dispersive(index, dispersion) : constant_index(index);
    is_layered_ = is_layered_ || index != 1.5;

    const Json& specular = member(extensions, "KHR_materials_specular");
    if (!specular.empty()) {
      is_layered_ = true;
      surface.specular = number(specular, "specularFactor", 1, "specularTexture", 3);
      surface.specular_color = {vector(specular, "specularColorFactor", {1, 1, 1}),
                                texture(specular, "specularColorTexture", ImageContent::colour)};
    }
    const Json& coat = member(extensions, "KHR_materials_clearcoat");
    if (coat.value("clearcoatFactor", 0.0) > 0) {
      is_layered_ = true;
      surface.clearcoat = number(coat, "clearcoatFactor", 0, "clearcoatTexture", 0);
      surface.clearcoat_roughness = number(coat, "clearcoatRoughnessFactor", 0, "clearcoatRoughnessTexture", 1);
      surface.clearcoat_normals = texture(coat, "clearcoatNormalTexture", ImageContent::data);
      surface.clearcoat_normal_scale = member(coat, "clearcoatNormalTexture").value("scale", 1.0);
      surface.has_coat_normals = surface.clearcoat_normals.image != result_.material.normal_map ||
                                 surface.clearcoat_normal_scale != result_.material.normal_scale ||
                                 coordinates_of(member(coat, "clearcoatNormalTexture")) != place_of_normals_;
      if (surface.clearcoat_normals.is_second)
        warn("tangents of a coat",
             "has a normal map of its clear coat at a second set of coordinates; it leans along those of the first");
    }
    const Json& sheen = member(extensions, "KHR_materials_sheen");
    if (const Vec3 tint = vector(sheen, "sheenColorFactor", {0, 0, 0}); max_component(tint) > 0) {
      is_layered_ = true;
      surface.sheen_color = {{clip(tint.x), clip(tint.y), clip(tint.z)},
                             texture(sheen, "sheenColorTexture", ImageContent::colour)};
      surface.sheen_roughness = number(sheen, "sheenRoughnessFactor", 0, "sheenRoughnessTexture", 3);
    }
    const Json& brushed = member(extensions, "KHR_materials_anisotropy");
    if (brushed.value("anisotropyStrength", 0.0) > 0) {
      is_layered_ = true;
      surface.anisotropy = number(brushed, "anisotropyStrength", 0, "anisotropyTexture", 2);
      surface.anisotropy_rotation = brushed.value("anisotropyRotation", 0.0);
      surface.anisotropy_direction = texture(brushed, "anisotropyTexture", ImageContent::data);
    }
    const Json& film = member(extensions, "KHR_materials_iridescence");
    if (film.value("iridescenceFactor", 0.0) > 0) {
      constexpr double nanometre = 1e-9;
      is_layered_ = true;
      surface.iridescence = number(film, "iridescenceFactor", 0, "iridescenceTexture", 0);
      surface.iridescence_index = std::max(1.0, film.value("iridescenceIor", 1.3));
      surface.least_thickness = std::max(0.0, film.value("iridescenceThicknessMinimum", 100.0)) * nanometre;
      surface.film_thickness = std::max(0.0, film.value("iridescenceThicknessMaximum", 400.0)) * nanometre;
      surface.thickness_texture = channel(film, "iridescenceThicknessTexture", 1);
    }
    const Json& leaf = member(extensions, "KHR_materials_diffuse_transmission");
    if (leaf.value("diffuseTransmissionFactor", 0.0) > 0) {
      is_layered_ = true;
      surface.diffuse_transmission = number(leaf, "diffuseTransmissionFactor", 0, "diffuseTransmissionTexture", 3);
      surface.diffuse_transmission_color = {colour(leaf, "diffuseTransmissionColorFactor"),
                                            texture(leaf, "diffuseTransmissionColorTexture", ImageContent::colour)};
    }
    read_transmission(extensions, surface, has_roughness_texture);
  }

  // Glass, clear or in part, thin or of a volume. Clear smooth glass is a case of its own, without layers.
  void read_transmission(const Json& extensions, PrincipledMaterial& surface, bool has_roughness_texture) {
    const Json& transmission = member(extensions, "KHR_materials_transmission");
    const Json& volume = member(extensions, "KHR_materials_volume");
    if (!(transmission.value("transmissionFactor", 0.0) > 0)) {
      if (surface.diffuse_transmission.value > 0 && volume.value("thicknessFactor", 0.0) > 0)
        warn("volume of a diffuse material", "has a volume and transmits light diffusely; it is shown as a thin sheet");
      return;
    }
    surface.transmission = number(transmission, "transmissionFactor", 0, "transmissionTexture", 0);
    surface.is_thin = !(volume.value("thicknessFactor", 0.0) > 0);
    const Vec3 tint = colour(volume, "attenuationColor");
    const double distance = volume.value("attenuationDistance", 0.0);
    if (!surface.is_thin && distance > 0 && std::isfinite(distance)) {
      surface.attenuation_color = tint;
      surface.attenuation_distance = distance;
    }
    const bool is_plain =
        surface.metalness.value == 0 && surface.transmission.value == 1 && !surface.transmission.texture.image &&
        surface.base_color.value == Vec3{1, 1, 1} && !surface.base_color.texture.image && !has_roughness_texture &&
        surface.attenuation_color == Vec3{1, 1, 1} && !(surface.is_thin && surface.roughness.value > 0);
    const bool has_only_index = extensions.size() == extensions.count("KHR_materials_ior") +
                                                         extensions.count("KHR_materials_dispersion") +
                                                         extensions.count("KHR_materials_volume") + 1;
    is_layered_ = !(is_plain && has_only_index);
    const bool has_specular = surface.specular.value != 1 || surface.specular.texture.image ||
                              surface.specular_color.texture.image || !(surface.specular_color.value == Vec3{1, 1, 1});
    if (!surface.is_thin && has_specular)
      warn("specular of glass", "is solid glass with a factor for its reflection; it reflects as its index says");
    if (!surface.is_thin && surface.iridescence.value > 0)
      warn("film on glass", "is solid glass with a thin film; the film is shown on its opaque part only");
  }

  // Cauchy's n = A + B/λ² with the Abbe number 20/dispersion at the lines d, F and C, in the visible range.
  static RefractiveIndex dispersive(double index, double dispersion) {
    constexpr double d = 587.6e-9, f = 486.1e-9, c = 656.3e-9;
    const double b = (index - 1) * dispersion / 20 / (1 / (f * f) - 1 / (c * c)), a = index - b / (d * d);
    RefractiveIndex result;
    for (int nanometres = 380; nanometres <= 780; nanometres += 10) {
      const double wavelength = nanometres * 1e-9;
      result.samples.push_back({wavelength, std::max(1.0, a + b / (wavelength * wavelength)), 0});
    }
    return result;
  }

  // OPAQUE, MASK (with its cutoff) or BLEND: the alpha of the base colour, which has these keys in a model of the surface.
  void read_opacity(const Json& source, const Json& model, const char* factor, const char* texture_key,
                    Material& material) {
    const std::string mode = source.value("alphaMode", "OPAQUE");
    if (mode != "MASK" && mode != "BLEND") return;
    if (model.contains(factor)) material.opacity = clip(model[factor].at(3).get<double>());
    const Texture alpha = texture_of_mesh(model, texture_key, ImageContent::alpha);
    if (alpha && is_alpha(*alpha)) material.opacity_texture = alpha;
    if (mode == "MASK") material.opacity_cutoff = std::max(clip(source.value("alphaCutoff", 0.5)), least_cutoff);
  }

  void warn_of_extensions(const Json& extensions) {
    constexpr std::array known{"pbrSpecularGlossiness",
                               "emissive_strength",
                               "ior",
                               "transmission",
                               "volume",
                               "unlit",
                               "specular",
                               "clearcoat",
                               "sheen",
                               "anisotropy",
                               "iridescence",
                               "dispersion",
                               "diffuse_transmission"};
    for (const auto& [name, content] : extensions.items())
      if (std::none_of(known.begin(), known.end(),
                       [&, &name = name](const char* k) { return name == std::string("KHR_materials_") + k; }))
        warn(name, fmt::format("has the extension {}; it is ignored", name));
  }

  const GltfFile& gltf_;
  const WarnOnce& warn_;
  std::string name_;
  FileMaterial result_;
  TextureCoordinates place_of_normals_;  // of the base, in the file
  bool is_layered_ = false;              // it is more than the core's model, or than clear glass
  std::map<std::tuple<int, ImageContent, ImageSampling>, Texture> images_;
  std::map<std::pair<Texture, int>, Texture> channels_;
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
  for (const Json& item : member(document, "extensionsUsed")) {
    const std::string name = item.get<std::string>();
    if (!name.starts_with("KHR_materials_") && name != "KHR_lights_punctual" && name != "KHR_texture_transform" &&
        name != "EXT_texture_webp" && name != "KHR_animation_pointer" && name != "KHR_node_visibility" &&
        name != "KHR_mesh_quantization" && name != "EXT_mesh_gpu_instancing" && name != "KHR_draco_mesh_compression" &&
        name != "EXT_meshopt_compression")
      warn(name, fmt::format("the extension {} is ignored", name));
  }
} catch (const Json::exception& e) {
  fail("{}: expected a glTF model, but it is damaged ({}); export it again", gltf.path, reason(e));
}

}  // namespace holotrace
