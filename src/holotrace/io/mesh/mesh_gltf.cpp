#include <algorithm>
#include <array>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/io/mesh/gltf.h"
#include "holotrace/io/mesh/gltf_accessor.h"
#include "holotrace/io/mesh/gltf_materials.h"
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

template <size_t N>
std::array<double, N> numbers(const Json& parent, const char* key, const std::array<double, N>& otherwise) {
  if (!parent.contains(key)) return otherwise;
  std::array<double, N> values;
  for (size_t i = 0; i < N; ++i) values[i] = parent.at(key).at(i).get<double>();
  return values;
}

// The map of a node: a matrix, column by column, or scale, rotation (a quaternion x, y, z, w) and translation.
Frame frame_of(const Json& node) {
  if (node.contains("matrix")) {
    const auto m = numbers<16>(node, "matrix", {});
    return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
  }
  const auto t = numbers<3>(node, "translation", {0, 0, 0}), s = numbers<3>(node, "scale", {1, 1, 1});
  const auto [x, y, z, w] = numbers<4>(node, "rotation", {0, 0, 0, 1});
  return {Vec3{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)} * s[0],
          Vec3{2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)} * s[1],
          Vec3{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)} * s[2],
          {t[0], t[1], t[2]}};
}

class GltfReader {
 public:
  GltfReader(const std::string& path, Outside outside)
      : reader_(path, outside), gltf_(read_gltf(path, outside)), materials_(gltf_materials(gltf_, reader_.warner())) {}

  LoadedModel read() try {
    warn_of_gltf_features(gltf_, reader_.warner());
    struct Place {
      size_t node;
      Frame frame;
    };
    const Json& nodes = list(gltf_.document, "nodes");
    std::vector<Place> open;  // nodes to read, the next one last
    const auto add = [&](const std::vector<size_t>& children, const Frame& parent) {
      for (auto child = children.rbegin(); child != children.rend(); ++child)
        open.push_back({*child, compose(parent, frame_of(nodes.at(*child)))});
    };
    add(roots(), Frame{});
    while (!open.empty()) {
      const Place place = open.back();
      open.pop_back();
      const Json& node = nodes.at(place.node);
      if (node.contains("mesh")) read_mesh(gltf_count(gltf_, node.at("mesh")), place.frame);
      add(gltf_counts(gltf_, list(node, "children")), place.frame);
    }
    return reader_.finish(std::move(materials_));
  } catch (const Json::exception& e) {
    fail("{}: expected a glTF model, but it is damaged ({}); export it again", reader_.path(), reason(e));
  }

 private:
  // The nodes of the scene that is shown first; those without a parent if the file has no scenes.
  std::vector<size_t> roots() const {
    const Json& document = gltf_.document;
    const Json& scenes = list(document, "scenes");
    if (!scenes.empty()) {
      const Json& scene = scenes.at(gltf_count(gltf_, document, "scene", 0));
      return gltf_counts(gltf_, list(scene, "nodes"));
    }
    std::vector<bool> is_child(list(document, "nodes").size());
    for (const Json& node : list(document, "nodes"))
      for (const Json& child : list(node, "children")) is_child.at(gltf_count(gltf_, child)) = true;
    std::vector<size_t> found;
    for (size_t i = 0; i < is_child.size(); ++i)
      if (!is_child[i]) found.push_back(i);
    return found;
  }

  void read_mesh(size_t number, const Frame& frame) {
    const Json& mesh = list(gltf_.document, "meshes").at(number);
    for (const Json& primitive : list(mesh, "primitives")) read_primitive(primitive, mesh.value("name", ""), frame);
  }

  void read_primitive(const Json& primitive, const std::string& name, const Frame& frame) {
    const Json& attributes = primitive.at("attributes");
    if (!attributes.contains("POSITION")) return;
    const auto count = gltf_count(gltf_, accessor(attributes, "POSITION").at("count"));
    const bool has_indices = primitive.contains("indices");
    const auto corners = has_indices ? gltf_count(gltf_, accessor(primitive, "indices").at("count")) : count;
    const size_t mode = gltf_count(gltf_, primitive, "mode", triangle_list);
    if (mode < triangle_list || mode > triangle_fan) return reader_.leave_out(corners);
    Mesh mesh;
    mesh.name = name;
    const size_t material =
        std::min(gltf_count(gltf_, primitive, "material", materials_.size() - 1), materials_.size() - 1);
    mesh.material = int(material);
    mesh.positions = vectors(attributes, "POSITION", count);
    std::vector<uint32_t> indices;
    if (has_indices) indices = gltf_indices(gltf_, gltf_count(gltf_, primitive.at("indices")));
    reader_.reserve(count, corners);
    if (attributes.contains("NORMAL")) mesh.normals = vectors(attributes, "NORMAL", count);
    read_coordinates(attributes, materials_[material].coordinates.set, count, mesh);
    if (attributes.contains("COLOR_0")) {
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
    reader_.add(std::move(mesh), materials_[material], frame);
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

  void read_coordinates(const Json& attributes, int set, size_t count, Mesh& mesh) const {
    const std::string key = fmt::format("TEXCOORD_{}", set);
    if (!attributes.contains(key)) return;
    const std::vector<double> read = values(attributes, key.c_str(), count, 2);
    for (size_t i = 0; i < count; ++i) mesh.texture_coordinates.push_back({read[2 * i], 1 - read[2 * i + 1]});
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
  std::vector<FileMaterial> materials_;
};

}  // namespace

LoadedModel load_gltf_mesh(const std::string& path, Outside outside) { return GltfReader(path, outside).read(); }

}  // namespace holotrace
