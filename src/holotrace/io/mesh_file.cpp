#include "holotrace/io/mesh_file.h"

#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <string_view>

#include "holotrace/base/error.h"
#include "holotrace/data/shapes.h"
#include "holotrace/io/file.h"
#include "holotrace/io/image_file.h"
#include "holotrace/io/ply.h"

namespace holotrace {
namespace {

Vec3 to_vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

Frame to_frame(const aiMatrix4x4& m) {
  return {{m.a1, m.b1, m.c1}, {m.a2, m.b2, m.c2}, {m.a3, m.b3, m.c3}, {m.a4, m.b4, m.c4}};
}

struct Reader {
  const std::string& path;
  const aiScene& scene;
  LoadedModel model;
  size_t primitives_left_out = 0;

  void warn(const std::string& sentence) {
    const std::string warning = path + ": " + sentence;
    if (std::find(model.warnings.begin(), model.warnings.end(), warning) == model.warnings.end())
      model.warnings.push_back(warning);
  }

  std::shared_ptr<const Image> read_texture(const aiString& name) {
    const std::string label = fmt::format("{} (texture \"{}\")", path, name.C_Str());
    if (const aiTexture* embedded = scene.GetEmbeddedTexture(name.C_Str())) {
      if (embedded->mHeight == 0)  // still compressed, mWidth bytes of it
        return std::make_shared<Image>(decode_image(embedded->pcData, embedded->mWidth, label));
      warn(fmt::format("the uncompressed texture \"{}\" is not shown", name.C_Str()));
      return nullptr;
    }
    std::string relative = name.C_Str();
    std::replace(relative.begin(), relative.end(), '\\', '/');
    const auto file = std::filesystem::path(path).parent_path() / relative;
    if (!std::filesystem::exists(file)) {
      warn(fmt::format("the texture {} is missing, the plain colour is shown", file.string()));
      return nullptr;
    }
    return std::make_shared<Image>(load_image(file.string()));
  }

  void read_material(const aiMaterial& source) {
    DiffuseMaterial material;
    const std::string name = source.GetName().C_Str();
    const bool is_default = name == AI_DEFAULT_MATERIAL_NAME;
    aiColor4D colour;
    if (!is_default && (source.Get(AI_MATKEY_BASE_COLOR, colour) == aiReturn_SUCCESS ||
                        source.Get(AI_MATKEY_COLOR_DIFFUSE, colour) == aiReturn_SUCCESS)) {
      const auto albedo = [&](float value) {
        if (!(value >= 0 && value <= 1))
          warn(fmt::format("material \"{}\" has a colour outside [0, 1], which is clipped", name));
        return value > 0 ? std::min(double(value), 1.0) : 0.0;
      };
      material.reflectance = {albedo(colour.r), albedo(colour.g), albedo(colour.b)};
      if (colour.a < 1) warn(fmt::format("material \"{}\" is see-through, it is shown opaque", name));
    }
    aiColor3D emission;
    Vec3 emitted;
    if (source.Get(AI_MATKEY_COLOR_EMISSIVE, emission) == aiReturn_SUCCESS && std::isfinite(emission.r) &&
        std::isfinite(emission.g) && std::isfinite(emission.b))
      emitted = {std::max(emission.r, 0.f), std::max(emission.g, 0.f), std::max(emission.b, 0.f)};
    float metallic = 0, opacity = 1;
    if (source.Get(AI_MATKEY_METALLIC_FACTOR, metallic) == aiReturn_SUCCESS && metallic > 0)
      warn(fmt::format("material \"{}\" is metallic, it is shown diffuse", name));
    if (source.Get(AI_MATKEY_OPACITY, opacity) == aiReturn_SUCCESS && opacity < 1)
      warn(fmt::format("material \"{}\" is see-through, it is shown opaque", name));
    if (source.GetTextureCount(aiTextureType_NORMALS) > 0 || source.GetTextureCount(aiTextureType_HEIGHT) > 0)
      warn(fmt::format("material \"{}\" has a normal or bump map, which is not shown", name));
    aiString texture;
    if (source.GetTexture(aiTextureType_BASE_COLOR, 0, &texture) == aiReturn_SUCCESS ||
        source.GetTexture(aiTextureType_DIFFUSE, 0, &texture) == aiReturn_SUCCESS)
      material.texture = read_texture(texture);
    model.materials.push_back({material, emitted});
  }

  void read_mesh(const aiMesh& source, const Frame& frame) {
    Mesh mesh;
    mesh.name = source.mName.length > 0 ? source.mName.C_Str() : std::filesystem::path(path).stem().string();
    mesh.material = int(source.mMaterialIndex);
    mesh.positions.reserve(source.mNumVertices);
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const Vec3 p = to_vec3(source.mVertices[i]);
      require(is_finite(p), "{}: expected finite coordinates in mesh \"{}\", got ({}, {}, {}) at vertex {}", path,
              mesh.name, p.x, p.y, p.z, i);
      mesh.positions.push_back(p);
    }
    bool normals_are_whole = source.HasNormals();
    for (unsigned i = 0; normals_are_whole && i < source.mNumVertices; ++i) {
      const Vec3 n = to_vec3(source.mNormals[i]);
      normals_are_whole = is_finite(n) && length(n) > 0;
      if (normals_are_whole) mesh.normals.push_back(normalize(n));
    }
    if (source.HasNormals() && !normals_are_whole) {
      mesh.normals.clear();
      warn(fmt::format("mesh \"{}\" has normals without a direction, it is shown flat", mesh.name));
    }
    if (source.HasTextureCoords(0))
      for (unsigned i = 0; i < source.mNumVertices; ++i) {
        const aiVector3D t = source.mTextureCoords[0][i];
        require(std::isfinite(t.x) && std::isfinite(t.y),
                "{}: expected finite texture coordinates in mesh \"{}\", got ({}, {}) at vertex {}", path, mesh.name,
                t.x, t.y, i);
        mesh.texture_coordinates.push_back({t.x, t.y});
      }
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
    if (source.HasBones()) warn(fmt::format("mesh \"{}\" has bones, it is shown at rest", mesh.name));
    if (source.mNumAnimMeshes > 0) warn(fmt::format("mesh \"{}\" has morph targets, which are not shown", mesh.name));
    if (mesh.triangles.empty()) return;
    transform_mesh(frame, mesh);
    model.meshes.push_back(std::move(mesh));
  }

  void read_node(const aiNode& node, const Frame& parent) {
    const Frame frame = compose(parent, to_frame(node.mTransformation));
    for (unsigned i = 0; i < node.mNumMeshes; ++i) read_mesh(*scene.mMeshes[node.mMeshes[i]], frame);
    for (unsigned i = 0; i < node.mNumChildren; ++i) read_node(*node.mChildren[i], frame);
  }

  LoadedModel read() {
    for (unsigned i = 0; i < scene.mNumMaterials; ++i) read_material(*scene.mMaterials[i]);
    if (model.materials.empty()) model.materials.push_back(DiffuseMaterial{});
    read_node(*scene.mRootNode, Frame{});
    require(!model.meshes.empty(), "{}: expected a mesh with triangles, got none", path);
    if (primitives_left_out > 0) warn(fmt::format("{} points and lines are not shown", primitives_left_out));
    if (scene.HasAnimations()) warn("the animations are not shown, the model is at rest");
    if (scene.HasLights()) warn("the lights are not used; place them in the scene");
    if (scene.HasCameras()) warn("the cameras are not used");
    return std::move(model);
  }
};

// Assimp drops texture coordinates and normals whose indices are out of range without a word, and says of vertices
// only that one is. So the faces of an OBJ file are read here first.
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

// A PLY mesh. Assimp stops the program at some damaged ones, so the reader of point files reads them.
LoadedModel from_ply(const std::string& path) {
  const PlyVertices vertices = read_ply(path, true);
  require(vertices.count > 0, "{}: expected a mesh with vertices, got none", path);
  const auto& x = vertices.column("x");
  const auto& y = vertices.column("y");
  const auto& z = vertices.column("z");
  LoadedModel model{{DiffuseMaterial{}}, {}, {}};
  Mesh mesh;
  mesh.name = std::filesystem::path(path).stem().string();
  for (size_t i = 0; i < vertices.count; ++i) {
    mesh.positions.push_back({x[i], y[i], z[i]});
    require(is_finite(mesh.positions.back()), "{}: expected finite coordinates, got ({}, {}, {}) at vertex {}", path,
            x[i], y[i], z[i], i);
  }

  const auto* nx = vertices.find("nx");
  const auto* ny = vertices.find("ny");
  const auto* nz = vertices.find("nz");
  for (size_t i = 0; nx && ny && nz && i < vertices.count; ++i) {
    const Vec3 normal{(*nx)[i], (*ny)[i], (*nz)[i]};
    if (!(is_finite(normal) && length(normal) > 0)) {
      mesh.normals.clear();
      model.warnings.push_back(path + ": it has normals without a direction, it is shown flat");
      break;
    }
    mesh.normals.push_back(normalize(normal));
  }
  for (auto [u_name, v_name] : {std::pair{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}}) {
    const auto* u = vertices.find(u_name);
    const auto* v = vertices.find(v_name);
    if (!u || !v || !mesh.texture_coordinates.empty()) continue;
    for (size_t i = 0; i < vertices.count; ++i) {
      require(std::isfinite((*u)[i]) && std::isfinite((*v)[i]),
              "{}: expected finite texture coordinates, got ({}, {}) at vertex {}", path, (*u)[i], (*v)[i], i);
      mesh.texture_coordinates.push_back({(*u)[i], (*v)[i]});
    }
  }

  for (size_t f = 0; f < vertices.faces.size(); ++f) {
    const auto& face = vertices.faces[f];
    require(face.size() >= 3, "{}: expected faces of 3 vertices or more, got {} in face {}", path, face.size(), f);
    for (double index : face)
      require(index >= 0 && index < double(vertices.count) && index == std::floor(index),
              "{}: expected vertex indices below {}, got {} in face {}", path, vertices.count, index, f);
    for (size_t i = 2; i < face.size(); ++i)  // a fan, right for convex faces
      mesh.triangles.push_back({uint32_t(face[0]), uint32_t(face[i - 1]), uint32_t(face[i])});
  }
  if (vertices.find("face_idx") && mesh.triangles.empty()) {  // the triangle soup of the OpenHolo library
    require(vertices.count % 3 == 0, "{}: expected three vertices per face, got {} vertices", path, vertices.count);
    for (uint32_t i = 0; i < vertices.count; i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
  }
  require(!mesh.triangles.empty(), "{}: expected a mesh with triangles, got none", path);
  if (vertices.find("red")) model.warnings.push_back(path + ": the colours of its vertices are not shown");
  model.meshes.push_back(std::move(mesh));
  return model;
}

// A face without vertices is what a truncated PLY leaves; Assimp's triangulation would end the program over it.
void check_faces(const aiScene& scene, const std::string& path) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m)
    for (unsigned f = 0; f < scene.mMeshes[m]->mNumFaces; ++f)
      require(scene.mMeshes[m]->mFaces[f].mNumIndices > 0,
              "{}: expected vertices in face {}, got none; the file is truncated or damaged, export it again", path, f);
}

}  // namespace

LoadedModel load_meshes(const std::string& path) {
  check_file_exists(path, "a mesh");
  const std::string extension = extension_of(path);
  const bool known = extension == ".obj" || extension == ".ply" || extension == ".gltf" || extension == ".glb";
  require(known, "expected a mesh file .obj, .ply, .gltf or .glb, got {}; convert it", path);
  if (extension == ".ply") return from_ply(path);
  if (extension == ".obj") check_obj_indices(path);
  Assimp::Importer importer;
  // Validation turns indices out of range into an error before any other step trusts them.
  const aiScene* scene = importer.ReadFile(path, aiProcess_ValidateDataStructure);
  if (scene) {
    check_faces(*scene, path);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_JoinIdenticalVertices);
  }
  if (!scene || !scene->mRootNode || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE)) {
    std::string reason = importer.GetErrorString();
    fail("{}: expected a mesh, but it is damaged ({}); export it again", path, reason.empty() ? "incomplete" : reason);
  }
  return Reader{path, *scene, {}, 0}.read();
}

}  // namespace holotrace
