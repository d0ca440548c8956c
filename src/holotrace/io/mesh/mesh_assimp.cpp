// Formats that Assimp reads. It crashes at some damaged files, so it works in a child process.

#include <assimp/DefaultIOSystem.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <filesystem>
#include <string>

#include "holotrace/base/error.h"
#include "holotrace/base/printable.h"
#include "holotrace/io/files/child_process.h"
#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {
namespace {

// The model's file and no other.
class OneFile : public Assimp::DefaultIOSystem {
 public:
  explicit OneFile(std::string path) : path_(std::move(path)) {}
  bool Exists(const char* name) const override { return path_ == name && DefaultIOSystem::Exists(name); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    return path_ == name ? DefaultIOSystem::Open(name, mode) : nullptr;
  }

 private:
  std::string path_;
};

Vec3 to_vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }
Vec3 to_vec3(const aiColor3D& c) { return {c.r, c.g, c.b}; }

void send_material(const aiMaterial& source, ToParent& out) {
  aiColor3D diffuse(0.8f), emission;
  aiString texture;
  source.Get(AI_MATKEY_COLOR_DIFFUSE, diffuse);
  source.Get(AI_MATKEY_COLOR_EMISSIVE, emission);
  const bool has_texture = source.GetTexture(aiTextureType_DIFFUSE, 0, &texture) == aiReturn_SUCCESS;
  out.value(to_vec3(diffuse));
  out.value(to_vec3(emission));
  out.text(has_texture ? texture.C_Str() : "");
}

void send_mesh(const aiMesh& source, ToParent& out) {
  std::vector<Vec3> positions, normals, colours;
  std::vector<Vec2> coordinates;
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    positions.push_back(to_vec3(source.mVertices[i]));
    if (source.HasNormals()) normals.push_back(to_vec3(source.mNormals[i]));
    if (source.HasTextureCoords(0))
      coordinates.push_back({source.mTextureCoords[0][i].x, source.mTextureCoords[0][i].y});
    if (source.HasVertexColors(0)) {
      const aiColor4D& c = source.mColors[0][i];
      colours.push_back({c.r, c.g, c.b});
    }
  }
  std::vector<std::array<uint32_t, 3>> triangles;
  size_t left_out = 0;
  for (unsigned f = 0; f < source.mNumFaces; ++f) {
    const aiFace& face = source.mFaces[f];
    if (face.mNumIndices == 3)
      triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
    else
      ++left_out;
  }
  out.text(source.mName.C_Str());
  out.value(size_t(source.mMaterialIndex));
  out.list(positions);
  out.list(normals);
  out.list(coordinates);
  out.list(colours);
  out.list(triangles);
  out.value(left_out);
}

void send_model(const std::string& path, ToParent& out) {
  Assimp::Importer importer;
  importer.SetIOHandler(new OneFile(path));  // the importer owns it
  // Moves all meshes to their places, so that there are no nodes to send.
  const aiScene* scene = importer.ReadFile(path, aiProcess_ValidateDataStructure | aiProcess_Triangulate |
                                                     aiProcess_PreTransformVertices | aiProcess_JoinIdenticalVertices);
  require(scene && scene->mNumMaterials > 0, "{}: expected a mesh, but it is damaged ({}); export it again", path,
          scene ? "without materials" : importer.GetErrorString());
  out.value(size_t(scene->mNumMaterials));
  for (unsigned i = 0; i < scene->mNumMaterials; ++i) send_material(*scene->mMaterials[i], out);
  out.value(size_t(scene->mNumMeshes));
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) send_mesh(*scene->mMeshes[i], out);
}

Vec3 clipped(Vec3 c) {
  const auto channel = [](double value) { return value > 0 ? std::min(value, 1.0) : 0.0; };
  return {channel(c.x), channel(c.y), channel(c.z)};
}

FileMaterial receive_material(FromChild& from, ModelReader& reader) {
  const Vec3 diffuse = clipped(from.value<Vec3>()), emission = from.value<Vec3>();
  const std::string texture = printable(from.text());
  FileMaterial result;
  std::shared_ptr<const Image> image;
  if (texture.starts_with('*'))
    reader.warn("embedded", "textures inside the file are ignored");
  else if (!texture.empty())
    image = reader.load_texture(texture, ImageContent::colour);
  result.has_textures = image != nullptr;
  result.material.surface = DiffuseMaterial{image && diffuse == Vec3{0, 0, 0} ? Vec3{1, 1, 1} : diffuse, image};
  if (is_finite(emission))
    result.material.emission = {std::max(emission.x, 0.0), std::max(emission.y, 0.0), std::max(emission.z, 0.0)};
  return result;
}

void receive_mesh(FromChild& from, const std::vector<FileMaterial>& materials, ModelReader& reader) {
  Mesh mesh;
  mesh.name = printable(from.text());
  const auto material = from.value<size_t>();
  mesh.positions = from.list<Vec3>();
  mesh.normals = from.list<Vec3>();
  mesh.texture_coordinates = from.list<Vec2>();
  mesh.colours = from.list<Vec3>();
  mesh.triangles = from.list<std::array<uint32_t, 3>>();
  reader.leave_out(from.value<size_t>());
  const size_t count = mesh.positions.size();
  // A child whose memory is damaged may send any numbers.
  const auto fits = [&](size_t size) { return size == 0 || size == count; };
  const bool is_whole = material < materials.size() && fits(mesh.normals.size()) &&
                        fits(mesh.texture_coordinates.size()) && fits(mesh.colours.size());
  const auto is_inside = [&](const auto& t) { return std::max({t[0], t[1], t[2]}) < count; };
  require(is_whole && std::all_of(mesh.triangles.begin(), mesh.triangles.end(), is_inside),
          "{}: expected vertex indices below {} in mesh \"{}\", got others; export it again", reader.path(), count,
          mesh.name);
  for (Vec3& colour : mesh.colours) {
    const Vec3 code = clipped(colour);
    colour = {srgb_decode(code.x), srgb_decode(code.y), srgb_decode(code.z)};
  }
  reader.reserve(count, mesh.triangles.size());
  mesh.material = int(material);
  reader.add(std::move(mesh), materials[material], Frame{});
}

}  // namespace

LoadedModel load_assimp_mesh(const std::string& path, Outside outside) {
  ModelReader reader(path, outside);
  std::vector<FileMaterial> materials;
  const auto read = [&](ToParent& out) {
    const double bytes = double(std::filesystem::file_size(path)),
                 slowest = 1e6;  // [bytes/s], of texts on old machines
    out.allow(10 + bytes / slowest, double(1 << 30) + 50 * bytes);
    send_model(path, out);
  };
  read_in_child(path, read, [&](FromChild& from) {
    for (auto n = from.value<size_t>(); n > 0; --n) materials.push_back(receive_material(from, reader));
    for (auto n = from.value<size_t>(); n > 0; --n) receive_mesh(from, materials, reader);
  });
  return reader.finish(std::move(materials));
}

}  // namespace holotrace
