// Formats that Assimp reads. It crashes at some damaged files, so it works in a child process.

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <filesystem>
#include <string>

#include "holotrace/base/error.h"
#include "holotrace/base/message_text.h"
#include "holotrace/data/shapes.h"
#include "holotrace/io/files/child_process.h"
#include "holotrace/io/mesh/mesh_formats.h"

namespace holotrace {
namespace {

// The model's file and no other, by a name with the extension of its format.
class OneFile : public Assimp::DefaultIOSystem {
 public:
  OneFile(std::string path, std::string name) : path_(std::move(path)), name_(std::move(name)) {}
  bool Exists(const char* name) const override { return name_ == name; }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    return name_ == name ? DefaultIOSystem::Open(path_.c_str(), mode) : nullptr;
  }

 private:
  std::string path_, name_;
};

Vec3 to_vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }
Vec3 to_vec3(const aiColor3D& c) { return {c.r, c.g, c.b}; }

Frame to_frame(const aiMatrix4x4& m) {
  return {{m.a1, m.b1, m.c1}, {m.a2, m.b2, m.c2}, {m.a3, m.b3, m.c3}, {m.a4, m.b4, m.c4}};
}

// What a file asks for that is not shown.
struct Ignored {
  aiTextureType type;
  const char* name;
};
constexpr std::array ignored_textures{Ignored{aiTextureType_SPECULAR, "highlight"},
                                      Ignored{aiTextureType_SHININESS, "highlight"},
                                      Ignored{aiTextureType_EMISSIVE, "emitted light"},
                                      Ignored{aiTextureType_EMISSION_COLOR, "emitted light"},
                                      Ignored{aiTextureType_NORMALS, "normals"},
                                      Ignored{aiTextureType_NORMAL_CAMERA, "normals"},
                                      Ignored{aiTextureType_HEIGHT, "bumps"},
                                      Ignored{aiTextureType_DISPLACEMENT, "displacement"},
                                      Ignored{aiTextureType_REFLECTION, "reflections"},
                                      Ignored{aiTextureType_METALNESS, "metal"},
                                      Ignored{aiTextureType_DIFFUSE_ROUGHNESS, "roughness"}};

// The colour texture of a material and the set of its coordinates.
aiTextureType colour_type(const aiMaterial& material) {
  return material.GetTextureCount(aiTextureType_DIFFUSE) > 0 ? aiTextureType_DIFFUSE : aiTextureType_BASE_COLOR;
}

unsigned coordinate_set(const aiMaterial& material) {
  aiString texture;
  unsigned set = 0;
  material.GetTexture(colour_type(material), 0, &texture, nullptr, &set);
  return set < AI_MAX_NUMBER_OF_TEXTURECOORDS ? set : 0;
}

void send_material(const aiMaterial& source, ToParent& out) {
  aiColor3D diffuse(0.8f), emission;
  float opacity = 1;
  aiString texture;
  source.Get(AI_MATKEY_COLOR_DIFFUSE, diffuse);
  source.Get(AI_MATKEY_COLOR_EMISSIVE, emission);
  source.Get(AI_MATKEY_OPACITY, opacity);
  const bool has_texture = source.GetTexture(colour_type(source), 0, &texture) == aiReturn_SUCCESS;
  out.text(source.GetName().C_Str());
  out.value(to_vec3(diffuse));
  out.value(to_vec3(emission));
  out.text(has_texture ? texture.C_Str() : "");
  out.value(double(opacity));
  out.value(uint8_t(source.GetTextureCount(aiTextureType_OPACITY) > 0));
  std::vector<const char*> ignored;
  for (const auto& [type, name] : ignored_textures)
    if (source.GetTextureCount(type) > 0) ignored.push_back(name);
  out.value(ignored.size());
  for (const char* name : ignored) out.text(name);
}

Frame place_of(const aiNode* node) {
  aiMatrix4x4 place;
  for (; node; node = node->mParent) place = node->mTransformation * place;
  return to_frame(place);
}

// How the joints of a skin at rest move each of its vertices; empty without usable joints.
std::vector<Frame> frames_of_skin(const aiMesh& mesh, const aiScene& scene) {
  std::vector<Frame> frames;
  std::vector<WeightedFrame> moves(mesh.mNumBones > 0 ? mesh.mNumVertices : 0);
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const aiBone& bone = *mesh.mBones[b];
    const aiNode* joint = scene.mRootNode->FindNode(bone.mName);
    if (!joint) return {};
    const Frame bind = to_frame(bone.mOffsetMatrix), move = compose(place_of(joint), bind);
    if (determinant(bind) == 0) return {};  // of a COLLADA file without a bind shape matrix
    for (unsigned w = 0; w < bone.mNumWeights; ++w)
      moves.at(bone.mWeights[w].mVertexId).add(move, bone.mWeights[w].mWeight);
  }
  const Frame root = place_of(scene.mRootNode);
  for (const WeightedFrame& move : moves) frames.push_back(move.mean(root));
  return frames;
}

void send_mesh(const aiMesh& source, const aiNode& node, const aiScene& scene, ToParent& out) {
  const unsigned set = coordinate_set(*scene.mMaterials[source.mMaterialIndex]);
  std::vector<Vec3> positions, normals, colours;
  std::vector<Vec2> coordinates;
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    positions.push_back(to_vec3(source.mVertices[i]));
    if (source.HasNormals()) normals.push_back(to_vec3(source.mNormals[i]));
    if (source.HasTextureCoords(set))
      coordinates.push_back({source.mTextureCoords[set][i].x, source.mTextureCoords[set][i].y});
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
  out.value(place_of(&node));
  out.list(frames_of_skin(source, scene));
}

void send_model(const std::string& path, const std::string& extension, ToParent& out) {
  Assimp::Importer importer;
  const std::string name = "model" + extension;
  importer.SetIOHandler(new OneFile(path, name));                       // the importer owns it
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);  // which would stand in for bones without a mesh
  const aiScene* scene = importer.ReadFile(name, aiProcess_ValidateDataStructure | aiProcess_Triangulate |
                                                     aiProcess_TransformUVCoords | aiProcess_JoinIdenticalVertices);
  require(scene, "{}: expected a mesh, but it is damaged ({}); export it again", path, importer.GetErrorString());
  require(scene->mNumMeshes == 0 || scene->mNumMaterials > 0,
          "{}: expected a mesh, but it is damaged (without materials); export it again", path);
  out.value(uint8_t(scene->HasAnimations()));
  out.value(uint8_t(scene->HasLights()));
  out.value(uint8_t(scene->HasCameras()));
  out.value(size_t(scene->mNumMaterials));
  for (unsigned i = 0; i < scene->mNumMaterials; ++i) send_material(*scene->mMaterials[i], out);
  std::vector<const aiNode*> open{scene->mRootNode};  // nodes to send, the next one last
  while (!open.empty()) {
    const aiNode* node = open.back();
    open.pop_back();
    for (unsigned i = 0; i < node->mNumMeshes; ++i) {
      out.value(uint8_t(1));
      send_mesh(*scene->mMeshes[node->mMeshes[i]], *node, *scene, out);
    }
    for (unsigned i = node->mNumChildren; i > 0; --i) open.push_back(node->mChildren[i - 1]);
  }
  out.value(uint8_t(0));
}

Vec3 clipped(Vec3 c) {
  const auto channel = [](double value) { return value > 0 ? std::min(value, 1.0) : 0.0; };
  return {channel(c.x), channel(c.y), channel(c.z)};
}

FileMaterial receive_material(FromChild& from, ModelReader& reader) {
  const std::string name = printable(from.text());
  const Vec3 diffuse = clipped(from.value<Vec3>()), emission = from.value<Vec3>();
  const std::string texture = printable(from.text());
  const auto opacity = from.value<double>();
  if (from.value<uint8_t>())
    reader.warn("opacity", fmt::format("material \"{}\" has a texture of its opacity; it is ignored", name));
  for (auto n = from.value<size_t>(); n > 0; --n) {
    const std::string ignored = printable(from.text());
    reader.warn(ignored, fmt::format("material \"{}\" has a texture of its {}; it is ignored", name, ignored));
  }
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
  if (opacity >= 0 && opacity < 1) result.material.opacity = opacity;
  if (opacity == 0)
    reader.warn("transparent", fmt::format("material \"{}\" is fully transparent: its surfaces are not there", name));
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
  const auto place = from.value<Frame>();
  const auto frames = from.list<Frame>();
  const size_t count = mesh.positions.size();
  // A child whose memory is damaged may send any numbers.
  const auto fits = [&](size_t size) { return size == 0 || size == count; };
  const bool is_whole = material < materials.size() && fits(mesh.normals.size()) &&
                        fits(mesh.texture_coordinates.size()) && fits(mesh.colours.size()) && fits(frames.size());
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
  if (!frames.empty()) bend_mesh(frames, mesh);
  reader.add(std::move(mesh), materials[material], frames.empty() ? place : Frame{});
}

}  // namespace

LoadedModel load_assimp_mesh(const std::string& path, const std::string& extension, Outside outside) {
  ModelReader reader(path, outside);
  std::vector<FileMaterial> materials;
  const auto read = [&](ToParent& out) {
    const double bytes = double(std::filesystem::file_size(path)),
                 slowest = 1e6;  // [bytes/s], of texts on old machines
    out.allow(10 + bytes / slowest, double(1 << 30) + 50 * bytes);
    send_model(path, extension, out);
  };
  read_in_child(path, read, [&](FromChild& from) {
    if (from.value<uint8_t>()) reader.warn("animations", "animations are ignored; the model is shown in its rest pose");
    if (from.value<uint8_t>()) reader.warn("lights", "the model's lights are ignored; place them in the scene");
    if (from.value<uint8_t>()) reader.warn("cameras", "cameras are ignored");
    for (auto n = from.value<size_t>(); n > 0; --n) materials.push_back(receive_material(from, reader));
    while (from.value<uint8_t>()) receive_mesh(from, materials, reader);
  });
  return reader.finish(std::move(materials));
}

}  // namespace holotrace
