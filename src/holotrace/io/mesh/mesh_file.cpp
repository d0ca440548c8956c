#include "holotrace/io/mesh/mesh_file.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>

#include "holotrace/base/error.h"
#include "holotrace/data/shapes.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/mesh/gltf_materials.h"
#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {
namespace {

Vec3 to_vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

Frame to_frame(const aiMatrix4x4& m) {
  return {{m.a1, m.b1, m.c1}, {m.a2, m.b2, m.c2}, {m.a3, m.b3, m.c3}, {m.a4, m.b4, m.c4}};
}

// Converts the shapes and materials that Assimp has read from a file.
struct Reader {
  const std::string& path;
  LoadedModel model{};
  std::vector<FileMaterial> materials{};
  std::set<std::string> warned{};
  size_t primitives_left_out = 0;
  bool is_gltf = false;

  WarnOnce warn = [this](const std::string& feature, const std::string& sentence) {
    if (warned.insert(feature).second) model.warnings.push_back(path + ": " + sentence);
  };

  std::shared_ptr<const Image> load_texture(const std::string& name, ImageContent content) {
    std::string relative = name;
    std::replace(relative.begin(), relative.end(), '\\', '/');
    const auto file = std::filesystem::path(path).parent_path() / relative;
    if (!std::filesystem::exists(file)) {
      warn("missing " + file.string(),
           fmt::format("the texture {} is missing; the plain colour is used", file.string()));
      return nullptr;
    }
    Image image = load_image(file.string(), content);
    if (content == ImageContent::data) image = with_three_channels(std::move(image));
    return std::make_shared<Image>(std::move(image));
  }

  // Index of a mesh's material in `materials`. In a glTF model its name is its number; the last one means none.
  size_t material_of(const aiMaterial& source, unsigned index) const {
    if (!is_gltf) return index;
    const std::string name = source.GetName().C_Str();
    size_t number = materials.size() - 1;
    std::from_chars(name.data(), name.data() + name.size(), number);
    return std::min(number, materials.size() - 1);
  }

  void read_normals(const aiMesh& source, Mesh& mesh) {
    if (!source.HasNormals()) return;
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const Vec3 n = to_vec3(source.mNormals[i]);
      if (!(is_finite(n) && length(n) > 0)) {
        mesh.normals.clear();
        warn("normals of " + mesh.name,
             fmt::format("mesh \"{}\" has normals of length 0; it is shaded flat", mesh.name));
        return;
      }
      mesh.normals.push_back(normalize(n));
    }
  }

  void read_texture_coordinates(const aiMesh& source, const FileMaterial& material, Mesh& mesh) {
    const auto set = unsigned(std::clamp(material.coordinates.set, 0, AI_MAX_NUMBER_OF_TEXTURECOORDS - 1));
    if (!source.HasTextureCoords(set)) {
      if (!material.has_textures) return;
      warn("no coordinates",
           fmt::format("mesh \"{}\" has textures but no texture coordinates; the colour of their corner is used",
                       mesh.name));
      mesh.texture_coordinates.assign(source.mNumVertices, {0, 0});
      return;
    }
    bool is_inside = true;
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const aiVector3D t = source.mTextureCoords[set][i];
      require(std::isfinite(t.x) && std::isfinite(t.y),
              "{}: expected finite texture coordinates in mesh \"{}\", got ({}, {}) at vertex {}", path, mesh.name, t.x,
              t.y, i);
      const Vec2 uv = transform_coordinates(material.coordinates, {t.x, t.y});
      is_inside = is_inside && uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1;
      mesh.texture_coordinates.push_back(uv);
    }
    if (!is_inside && !material.repeats)
      warn("wrap", fmt::format("mesh \"{}\" has a texture that is clamped or mirrored at its border; it is repeated",
                               mesh.name));
  }

  void read_colours(const aiMesh& source, Mesh& mesh) {
    if (!source.HasVertexColors(0)) return;
    const auto channel = [&](float value) {
      const double clipped = value > 0 ? std::min(double(value), 1.0) : 0.0;
      return is_gltf ? clipped : srgb_decode(clipped);
    };
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const aiColor4D& c = source.mColors[0][i];
      mesh.colours.push_back({channel(c.r), channel(c.g), channel(c.b)});
    }
  }

  void read_triangles(const aiMesh& source, Mesh& mesh) {
    for (unsigned f = 0; f < source.mNumFaces; ++f) {
      const aiFace& face = source.mFaces[f];
      if (face.mNumIndices != 3) {
        ++primitives_left_out;
        continue;
      }
      for (unsigned i = 0; i < 3; ++i)
        require(face.mIndices[i] < source.mNumVertices,
                "{}: expected vertex indices below {} in mesh \"{}\", got {} in face {}", path, source.mNumVertices,
                mesh.name, face.mIndices[i], f);
      mesh.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
    }
  }

  void read_mesh(const aiScene& scene, const aiMesh& source, const Frame& frame) {
    Mesh mesh;
    mesh.name = source.mName.length > 0 ? source.mName.C_Str() : std::filesystem::path(path).stem().string();
    mesh.material = int(material_of(*scene.mMaterials[source.mMaterialIndex], source.mMaterialIndex));
    mesh.positions.reserve(source.mNumVertices);
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const Vec3 p = to_vec3(source.mVertices[i]);
      require(is_finite(p), "{}: expected finite coordinates in mesh \"{}\", got ({}, {}, {}) at vertex {}", path,
              mesh.name, p.x, p.y, p.z, i);
      mesh.positions.push_back(p);
    }
    read_triangles(source, mesh);
    if (mesh.triangles.empty()) return;
    read_normals(source, mesh);
    read_texture_coordinates(source, materials[size_t(mesh.material)], mesh);
    read_colours(source, mesh);
    transform_mesh(frame, mesh);
    model.meshes.push_back(std::move(mesh));
  }

  void read_node(const aiScene& scene, const aiNode& node, const Frame& parent) {
    const Frame frame = compose(parent, to_frame(node.mTransformation));
    for (unsigned i = 0; i < node.mNumMeshes; ++i) read_mesh(scene, *scene.mMeshes[node.mMeshes[i]], frame);
    for (unsigned i = 0; i < node.mNumChildren; ++i) read_node(scene, *node.mChildren[i], frame);
  }

  LoadedModel read(const aiScene& scene) {
    if (!is_gltf)
      for (unsigned i = 0; i < scene.mNumMaterials; ++i)
        materials.push_back(obj_material(
            *scene.mMaterials[i], [this](const auto& name, auto content) { return load_texture(name, content); },
            warn));
    read_node(scene, *scene.mRootNode, Frame{});
    require(!model.meshes.empty(), "{}: expected a mesh with triangles, got none", path);
    if (primitives_left_out > 0)
      warn("primitives", fmt::format("{} points and lines are ignored", primitives_left_out));
    for (FileMaterial& material : materials) model.materials.push_back(std::move(material.material));
    return std::move(model);
  }
};

// Refuses faces without vertices, which a truncated file leaves: Assimp's triangulation would end the program.
void check_faces(const aiScene& scene, const std::string& path) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m)
    for (unsigned f = 0; f < scene.mMeshes[m]->mNumFaces; ++f)
      require(scene.mMeshes[m]->mFaces[f].mNumIndices > 0,
              "{}: expected vertices in face {}, got none; the file is truncated or damaged, export it again", path, f);
}

// The files on disk, except one, whose bytes are replaced.
class FilesWithOneReplaced : public Assimp::DefaultIOSystem {
 public:
  FilesWithOneReplaced(std::string path, std::string bytes) : path_(std::move(path)), bytes_(std::move(bytes)) {}

  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (path_ != name) return DefaultIOSystem::Open(name, mode);
    return new Assimp::MemoryIOStream(reinterpret_cast<const uint8_t*>(bytes_.data()), bytes_.size());
  }

 private:
  std::string path_, bytes_;
};

}  // namespace

Vec2 transform_coordinates(const TextureCoordinates& t, Vec2 uv) {
  if (t == TextureCoordinates{.set = t.set}) return uv;
  // KHR_texture_transform: scale, rotate (counter-clockwise as seen with v down), move.
  const double u = uv.x * t.scale_u, v = (1 - uv.y) * t.scale_v;
  const double c = std::cos(t.rotation), s = std::sin(t.rotation);
  return {c * u + s * v + t.offset_u, 1 - (-s * u + c * v + t.offset_v)};
}

bool is_mesh_file(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".obj" || extension == ".ply" || extension == ".gltf" || extension == ".glb";
}

LoadedModel load_meshes(const std::string& path) {
  check_file_exists(path, "a mesh");
  require(is_mesh_file(path), "expected a mesh file .obj, .ply, .gltf or .glb, got {}; convert it", path);
  const std::string extension = extension_of(path);
  if (extension == ".ply") return load_ply_mesh(path);
  Assimp::Importer importer;
  Reader reader{path};
  reader.is_gltf = extension != ".obj";
  if (reader.is_gltf) {
    // Assimp renumbers materials and knows only a part of their data, so it reads only the shapes.
    const GltfFile gltf = read_gltf(path);
    reader.materials = gltf_materials(gltf, reader.warn);
    warn_of_gltf_features(gltf, reader.warn);
    importer.SetIOHandler(new FilesWithOneReplaced(path, gltf_shapes(gltf)));  // the importer owns it
  } else {
    check_obj_indices(path);
  }
  // Validation reports indices out of range before any other step uses them.
  const aiScene* scene = importer.ReadFile(path, aiProcess_ValidateDataStructure);
  if (scene) {
    check_faces(*scene, path);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_JoinIdenticalVertices);
  }
  if (!scene || !scene->mRootNode || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE)) {
    std::string reason = importer.GetErrorString();
    fail("{}: expected a mesh, but it is damaged ({}); export it again", path, reason.empty() ? "incomplete" : reason);
  }
  return reader.read(*scene);
}

}  // namespace holotrace
