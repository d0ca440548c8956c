#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/base/quaternion.h"
#include "holotrace/base/units.h"
#include "holotrace/data/shapes.h"
#include "holotrace/io/mesh/gltf.h"
#include "holotrace/io/mesh/gltf_animation.h"
#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {
namespace {

using Json = nlohmann::json;

// Values of "mode" in the standard; lower ones are points and lines.
constexpr size_t triangle_list = 4, triangle_strip = 5, triangle_fan = 6;

const Json& list(const Json& parent, const char* key) {
  static const Json none = Json::array();
  const auto found = parent.find(key);
  return found == parent.end() ? none : *found;
}

// An extension of a part of the document; empty if it has none.
const Json& extension(const Json& parent, const char* name) { return list(list(parent, "extensions"), name); }

template <size_t N>
std::array<double, N> numbers(const Json& parent, const char* key, const std::array<double, N>& otherwise) {
  if (!parent.contains(key)) return otherwise;
  std::array<double, N> values;
  for (size_t i = 0; i < N; ++i) values[i] = parent.at(key).at(i).get<double>();
  return values;
}

// A map as a matrix, column by column.
Frame frame_of_matrix(const double* m) {
  return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
}

// The map of a node: a matrix, column by column, or scale, rotation (a quaternion x, y, z, w) and translation.
Frame frame_of(const Json& node) {
  if (node.contains("matrix")) {
    const auto m = numbers<16>(node, "matrix", {});
    return frame_of_matrix(m.data());
  }
  const auto t = numbers<3>(node, "translation", {0, 0, 0}), s = numbers<3>(node, "scale", {1, 1, 1});
  const Frame r = rotation_by(numbers<4>(node, "rotation", {0, 0, 0, 1}));
  return {r.x * s[0], r.y * s[1], r.z * s[2], {t[0], t[1], t[2]}};
}

class GltfReader {
 public:
  GltfReader(const std::string& path, Outside outside, const PoseTime& at)
      : reader_(path, outside),
        gltf_(read_gltf(path, outside)),
        last_key_(pose_gltf(gltf_, at, reader_.warner())),
        materials_(gltf_materials(gltf_, reader_.warner())),
        variant_(variant_named(at.variant)) {}

  LoadedModel read() try {
    warn_of_gltf_features(gltf_, reader_.warner());
    const Json& nodes = list(gltf_.document, "nodes");
    places_.resize(nodes.size());
    // Joints may be outside the scene that is shown.
    for_each_node(parentless(), [&](size_t number) {
      const Json& node = nodes.at(number);
      places_.at(number) = compose(places_.at(number), frame_of(node));
      for (const size_t child : gltf_counts(gltf_, list(node, "children"))) places_.at(child) = places_[number];
    });
    hide_nodes();
    for_each_node(roots(), [&](size_t number) {
      const Json& node = nodes.at(number);
      if (is_hidden_.at(number)) return;
      if (node.contains("mesh"))
        for (const Frame& copy : copies_of(node)) read_mesh(node, compose(places_.at(number), copy));
      const Json& light = extension(node, "KHR_lights_punctual");
      if (light.contains("light"))
        read_or_leave_out("light", [&] { read_light(gltf_count(gltf_, light.at("light")), places_.at(number)); });
      if (node.contains("camera"))
        read_or_leave_out("camera",
                          [&] { read_camera(gltf_count(gltf_, node.at("camera")), node, places_.at(number)); });
    });
    LoadedModel model = reader_.finish(std::move(materials_), last_key_.has_value());
    model.lights = std::move(lights_);
    model.cameras = std::move(cameras_);
    model.last_key = last_key_;
    return model;
  } catch (const Json::exception& e) {
    fail("{}: expected a glTF model, but it is damaged ({}); export it again", reader_.path(), reason(e));
  }

 private:
  // Calls f(number) for the nodes and all below them, parents first.
  template <class F>
  void for_each_node(const std::vector<size_t>& first, F&& f) const {
    std::vector<size_t> open(first.rbegin(), first.rend());  // nodes to visit, the next one last
    while (!open.empty()) {
      const size_t number = open.back();
      open.pop_back();
      f(number);
      const auto children = gltf_counts(gltf_, list(list(gltf_.document, "nodes").at(number), "children"));
      open.insert(open.end(), children.rbegin(), children.rend());
    }
  }

  // Number of a variant of the materials; none for "".
  std::optional<size_t> variant_named(const std::string& name) const try {
    if (name.empty()) return std::nullopt;
    std::vector<std::string> names;
    for (const Json& variant : list(extension(gltf_.document, "KHR_materials_variants"), "variants"))
      names.push_back(variant.value("name", ""));
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) fail("{}: {}", gltf_.path, unknown_name_message("variant", name, names));
    return size_t(found - names.begin());
  } catch (const Json::exception& e) {
    fail("{}: expected a glTF model, but its variants are damaged ({}); export it again", gltf_.path, reason(e));
  }

  // The material of a primitive, in the variant that is read.
  size_t material_of(const Json& primitive) const {
    const size_t none = materials_.size() - 1;
    if (variant_)
      for (const Json& mapping : list(extension(primitive, "KHR_materials_variants"), "mappings"))
        for (const size_t number : gltf_counts(gltf_, list(mapping, "variants")))
          if (number == *variant_) return std::min(gltf_count(gltf_, mapping.at("material")), none);
    return std::min(gltf_count(gltf_, primitive, "material", none), none);
  }

  // Where the copies of a node's mesh are, relative to the node: one of itself, or those of EXT_mesh_gpu_instancing.
  std::vector<Frame> copies_of(const Json& node) const {
    const Json& extensions = list(node, "extensions");
    if (!extensions.contains("EXT_mesh_gpu_instancing")) return {Frame{}};
    const Json& attributes = extensions.at("EXT_mesh_gpu_instancing").at("attributes");
    const auto read = [&](const char* key, size_t components) {
      return attributes.contains(key) ? gltf_numbers(gltf_, gltf_count(gltf_, attributes.at(key)), components)
                                      : std::vector<double>();
    };
    const std::vector<double> moves = read("TRANSLATION", 3), turns = read("ROTATION", 4), sizes = read("SCALE", 3);
    const size_t count = std::max({moves.size() / 3, turns.size() / 4, sizes.size() / 3});
    for (const auto& [values, components] : {std::pair{&moves, 3}, {&turns, 4}, {&sizes, 3}})
      require(values->empty() || values->size() == count * size_t(components),
              "{}: expected {} places, turns and sizes of instances, got {}; export it again", reader_.path(), count,
              values->size() / size_t(components));
    std::vector<Frame> copies(count);
    for (size_t i = 0; i < count; ++i) {
      if (!turns.empty()) copies[i] = rotation_by({turns[4 * i], turns[4 * i + 1], turns[4 * i + 2], turns[4 * i + 3]});
      if (!sizes.empty()) {
        copies[i].x = copies[i].x * sizes[3 * i];
        copies[i].y = copies[i].y * sizes[3 * i + 1];
        copies[i].z = copies[i].z * sizes[3 * i + 2];
      }
      if (!moves.empty()) copies[i].origin = {moves[3 * i], moves[3 * i + 1], moves[3 * i + 2]};
    }
    return copies;
  }

  // Reads a light or a camera, which most users of the model do not ask for: a damaged one is left out.
  void read_or_leave_out(const char* what, const std::function<void()>& read) {
    const auto leave_out = [&](const std::string& why) {
      reader_.warn(what, fmt::format("a {} is left out: {}", what, why));
    };
    try {
      read();
    } catch (const Json::exception& e) {
      leave_out(reason(e));
    } catch (const Error& e) {
      leave_out(e.what());
    }
  }

  // A number of a light in its range; `otherwise` if it is not given.
  static double number_of(const Json& parent, const char* key, double otherwise, double lowest, double highest) {
    const double value = parent.value(key, otherwise);
    require(value >= lowest && value <= highest, "expected {} from {} to {}, got {}", key, lowest, highest, value);
    return value;
  }

  void read_light(size_t number, const Frame& place) {
    constexpr double most = std::numeric_limits<double>::max();
    const Json& light = list(extension(gltf_.document, "KHR_lights_punctual"), "lights").at(number);
    const auto colour = numbers<3>(light, "color", {1, 1, 1});
    require(std::all_of(colour.begin(), colour.end(), [](double c) { return c >= 0 && c <= most; }),
            "expected colours of 0 or more, got ({}, {}, {})", colour[0], colour[1], colour[2]);
    const Vec3 power = Vec3{colour[0], colour[1], colour[2]} * number_of(light, "intensity", 1, 0, most);
    require(is_finite(power) && is_finite(place.origin) && length(place.z) > 0 && length(place.z) <= most,
            "expected a finite place, direction and intensity, got others");
    const Vec3 direction = normalize(place.z) * -1.0;
    const std::string type = light.at("type").get<std::string>();
    if (type == "point") {
      lights_.push_back(PointLight{place.origin, power});
    } else if (type == "directional") {
      lights_.push_back(DirectionalLight{direction, power, place.origin});
    } else if (type == "spot") {
      const Json cone = light.value("spot", Json::object());
      const double outer = number_of(cone, "outerConeAngle", pi / 4, 0, pi / 2);
      lights_.push_back(
          SpotLight{place.origin, direction, power, number_of(cone, "innerConeAngle", 0, 0, outer), outer});
    } else {
      reader_.warn("light type", fmt::format("a light of the type \"{}\" is ignored", type));
    }
  }

  void read_camera(size_t number, const Json& node, const Frame& place) {
    const Json& camera = list(gltf_.document, "cameras").at(number);
    ModelCamera read{camera.value("name", node.value("name", "")), place};
    if (read.name.empty()) read.name = std::to_string(cameras_.size() + 1);
    const bool is_orthographic = camera.at("type") == "orthographic";
    const Json& lens = camera.at(is_orthographic ? "orthographic" : "perspective");
    (is_orthographic ? read.offset : read.slope) =
        is_orthographic ? lens.at("ymag").get<double>() : std::tan(lens.at("yfov").get<double>() / 2);
    const auto is_usable = [](double value) { return value > 0 && std::isfinite(value); };
    require(is_finite(place.origin) && is_usable(read.slope + read.offset) && is_usable(std::abs(determinant(place))),
            "expected a finite place and a picture of some height, got others");
    cameras_.push_back(std::move(read));
  }

  // Finds the nodes that KHR_node_visibility hides, with all below them.
  void hide_nodes() {
    const Json& nodes = list(gltf_.document, "nodes");
    is_hidden_.resize(nodes.size());
    for_each_node(parentless(), [&](size_t number) {
      const Json& node = nodes.at(number);
      const Json& extensions = node.contains("extensions") ? node.at("extensions") : node;
      if (extensions.contains("KHR_node_visibility") && !extensions.at("KHR_node_visibility").value("visible", true))
        is_hidden_.at(number) = true;
      if (!is_hidden_.at(number)) return;
      for (const size_t child : gltf_counts(gltf_, list(node, "children"))) is_hidden_.at(child) = true;
    });
  }

  // The nodes of the scene that is shown first; those without a parent if the file has no scenes.
  std::vector<size_t> roots() const {
    const Json& document = gltf_.document;
    const Json& scenes = list(document, "scenes");
    if (!scenes.empty()) {
      const Json& scene = scenes.at(gltf_count(gltf_, document, "scene", 0));
      return gltf_counts(gltf_, list(scene, "nodes"));
    }
    return parentless();
  }

  std::vector<size_t> parentless() const {
    const Json& document = gltf_.document;
    std::vector<bool> is_child(list(document, "nodes").size());
    for (const Json& node : list(document, "nodes"))
      for (const Json& child : list(node, "children")) is_child.at(gltf_count(gltf_, child)) = true;
    std::vector<size_t> found;
    for (size_t i = 0; i < is_child.size(); ++i)
      if (!is_child[i]) found.push_back(i);
    return found;
  }

  void read_mesh(const Json& node, const Frame& frame) {
    const Json& mesh = list(gltf_.document, "meshes").at(gltf_count(gltf_, node.at("mesh")));
    const std::vector<Frame> joints =
        node.contains("skin") ? joints_of(gltf_count(gltf_, node.at("skin"))) : std::vector<Frame>{};
    const Json& weights = node.contains("weights") ? node.at("weights") : list(mesh, "weights");
    for (const Json& primitive : list(mesh, "primitives"))
      read_primitive(primitive, mesh.value("name", ""), frame, joints, weights.get<std::vector<double>>());
  }

  // Adds the morph targets of a primitive to its mesh, Σ wₜ·Δₜ.
  void morph(const Json& targets, const std::vector<double>& weights, Mesh& mesh) const {
    const size_t count = mesh.positions.size();
    for (size_t t = 0; t < std::min(weights.size(), targets.size()); ++t) {
      if (weights[t] == 0) continue;
      const auto add = [&](const char* key, std::vector<Vec3>& to) {
        if (to.empty() || !targets.at(t).contains(key)) return;
        const std::vector<Vec3> shifts = vectors(targets.at(t), key, count);
        for (size_t i = 0; i < count; ++i) to[i] += shifts[i] * weights[t];
      };
      add("POSITION", mesh.positions);
      add("NORMAL", mesh.normals);
    }
  }

  // How each joint of a skin moves vertices: from where they were bound to it, to where it is.
  std::vector<Frame> joints_of(size_t number) const {
    const Json& skin = list(gltf_.document, "skins").at(number);
    const std::vector<size_t> nodes = gltf_counts(gltf_, list(skin, "joints"));
    std::vector<double> binds;
    if (skin.contains("inverseBindMatrices")) {
      binds = gltf_numbers(gltf_, gltf_count(gltf_, skin.at("inverseBindMatrices")), 16);
      require(binds.size() >= 16 * nodes.size(),
              "{}: expected {} inverse bind matrices, one for each joint, got {}; export it again", reader_.path(),
              nodes.size(), binds.size() / 16);
    }
    std::vector<Frame> joints;
    for (size_t j = 0; j < nodes.size(); ++j) {
      const Frame bind = binds.empty() ? Frame{} : frame_of_matrix(&binds[16 * j]);
      joints.push_back(compose(places_.at(nodes[j]), bind));
    }
    return joints;
  }

  // Moves the vertices of a skin by their joints, Σ wⱼ·Jⱼ. The place of its node does not count.
  void bend(const Json& attributes, const std::vector<Frame>& joints, Mesh& mesh) const {
    const size_t count = mesh.positions.size();
    std::vector<WeightedFrame> moves(count);
    for (int set = 0; attributes.contains(fmt::format("JOINTS_{}", set)); ++set) {
      const std::vector<double> numbers = values(attributes, fmt::format("JOINTS_{}", set).c_str(), count, 4),
                                weights = values(attributes, fmt::format("WEIGHTS_{}", set).c_str(), count, 4);
      for (size_t i = 0; i < numbers.size(); ++i) {
        if (!(weights[i] > 0)) continue;
        require(numbers[i] >= 0 && numbers[i] < double(joints.size()),
                "{}: expected joint numbers below {} in mesh \"{}\", got {}; export it again", reader_.path(),
                joints.size(), mesh.name, numbers[i]);
        moves[i / 4].add(joints[size_t(numbers[i])], weights[i]);
      }
    }
    std::vector<Frame> frames;
    for (const WeightedFrame& move : moves) frames.push_back(move.mean(joints[0]));
    bend_mesh(frames, mesh);
  }

  void read_primitive(const Json& primitive, const std::string& name, const Frame& frame,
                      const std::vector<Frame>& joints, const std::vector<double>& weights) {
    const Json& attributes = primitive.at("attributes");
    if (!attributes.contains("POSITION")) return;
    const auto count = gltf_count(gltf_, accessor(attributes, "POSITION").at("count"));
    const bool has_indices = primitive.contains("indices");
    const auto corners = has_indices ? gltf_count(gltf_, accessor(primitive, "indices").at("count")) : count;
    const size_t mode = gltf_count(gltf_, primitive, "mode", triangle_list);
    if (mode < triangle_list || mode > triangle_fan) return reader_.leave_out(corners);
    Mesh mesh;
    mesh.name = name;
    const size_t material = material_of(primitive);
    mesh.material = int(material);
    mesh.positions = vectors(attributes, "POSITION", count);
    std::vector<uint32_t> indices;
    if (has_indices) indices = gltf_indices(gltf_, gltf_count(gltf_, primitive.at("indices")));
    reader_.reserve(count, corners);
    if (attributes.contains("NORMAL")) mesh.normals = vectors(attributes, "NORMAL", count);
    if (primitive.contains("targets")) morph(primitive.at("targets"), weights, mesh);
    mesh.texture_coordinates = coordinates(attributes, materials_[material].coordinates.set, count);
    if (const int set = materials_[material].second_set; set >= 0) {
      mesh.second_coordinates = coordinates(attributes, set, count);
      if (mesh.second_coordinates.empty()) {
        reader_.warn(
            "no coordinates of set " + std::to_string(set),
            fmt::format("mesh \"{}\" has textures at TEXCOORD_{} but no such texture coordinates; the colour of "
                        "their corner is used",
                        mesh.name, set));
        mesh.second_coordinates.resize(count);
      }
    }
    if (attributes.contains("COLOR_0")) {
      warn_of_alpha(attributes, count, material, name);
      mesh.colours = vectors(attributes, "COLOR_0", count);
      for (Vec3& c : mesh.colours)
        for (double* channel : {&c.x, &c.y, &c.z}) *channel = *channel > 0 ? std::min(*channel, 1.0) : 0.0;
    }
    if (has_indices) {
      for (size_t i = 0; i < indices.size(); ++i)
        require(indices[i] < count, "{}: expected vertex indices below {} in mesh \"{}\", got {}; export it again",
                reader_.path(), count, name, indices[i]);
    } else {
      for (size_t i = 0; i < count; ++i) indices.push_back(uint32_t(i));
    }
    add_triangles(indices, mode, mesh);
    const bool is_skin = !joints.empty() && attributes.contains("JOINTS_0") && attributes.contains("WEIGHTS_0");
    if (is_skin) bend(attributes, joints, mesh);
    reader_.add(std::move(mesh), materials_[material], is_skin ? Frame{} : frame);
  }

  // Vertex colours with alpha that the material asks to show.
  void warn_of_alpha(const Json& attributes, size_t count, size_t material, const std::string& name) {
    const Json& materials = list(gltf_.document, "materials");
    const bool is_opaque = material >= materials.size() || materials[material].value("alphaMode", "OPAQUE") == "OPAQUE";
    if (is_opaque || accessor(attributes, "COLOR_0").at("type") != "VEC4") return;
    const std::vector<double> colours = values(attributes, "COLOR_0", count, 4);
    for (size_t i = 0; i < count; ++i)
      if (colours[4 * i + 3] < 1)
        return reader_.warn(
            "alpha of vertices",
            fmt::format("mesh \"{}\" has transparent vertex colours (alpha); they are shown opaque", name));
  }

  const Json& accessor(const Json& parent, const char* key) const {
    return list(gltf_.document, "accessors").at(gltf_count(gltf_, parent.at(key)));
  }

  std::vector<double> values(const Json& attributes, const char* key, size_t count, size_t components) const {
    std::vector<double> read = gltf_numbers(gltf_, gltf_count(gltf_, attributes.at(key)), components);
    require(read.size() == count * components, "{}: expected {} items of {}, one per vertex, got {}; export it again",
            reader_.path(), count, key, read.size() / components);
    return read;
  }

  std::vector<Vec3> vectors(const Json& attributes, const char* key, size_t count) const {
    const std::vector<double> read = values(attributes, key, count, 3);
    std::vector<Vec3> vectors(count);
    for (size_t i = 0; i < count; ++i) vectors[i] = {read[3 * i], read[3 * i + 1], read[3 * i + 2]};
    return vectors;
  }

  // Texture coordinates of a set, v up; none if the mesh has no such set.
  std::vector<Vec2> coordinates(const Json& attributes, int set, size_t count) const {
    const std::string key = fmt::format("TEXCOORD_{}", set);
    std::vector<Vec2> found;
    if (!attributes.contains(key)) return found;
    const std::vector<double> read = values(attributes, key.c_str(), count, 2);
    for (size_t i = 0; i < count; ++i) found.push_back({read[2 * i], 1 - read[2 * i + 1]});
    return found;
  }

  void add_triangles(const std::vector<uint32_t>& corners, size_t mode, Mesh& mesh) {
    const size_t n = corners.size();
    if (mode == triangle_list) {
      for (size_t i = 0; i + 2 < n; i += 3) mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
      if (n % 3 != 0)
        reader_.warn("rest",
                     fmt::format("mesh \"{}\" has {} indices, which are no whole triangles; the last are ignored",
                                 mesh.name, n));
      return;
    }
    for (size_t i = 2; i < n; ++i) {
      if (mode == triangle_fan)
        mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
      else  // every other triangle of a strip is turned
        mesh.triangles.push_back({corners[i - 2], corners[i - 1 + i % 2], corners[i - i % 2]});
    }
  }

  ModelReader reader_;
  GltfFile gltf_;
  std::optional<double> last_key_;  // of the animation; its constructor poses the model
  std::vector<FileMaterial> materials_;
  std::optional<size_t> variant_;  // of the materials
  std::vector<Frame> places_;      // of the nodes
  std::vector<Light> lights_{};
  std::vector<ModelCamera> cameras_{};
  std::vector<bool> is_hidden_;  // nodes
};

}  // namespace

LoadedModel load_gltf_mesh(const std::string& path, Outside outside, const PoseTime& at) {
  return GltfReader(path, outside, at).read();
}

}  // namespace holotrace
