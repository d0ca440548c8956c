#include "holotrace/io/mesh/gltf_compression.h"

#include <draco/compression/decode.h>
#include <fmt/format.h>
#include <meshoptimizer.h>

#include <array>
#include <cstring>
#include <memory>
#include <utility>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

using Json = nlohmann::json;

const Json* extension_of(const Json& parent, const char* name) {
  const auto extensions = parent.find("extensions");
  if (extensions == parent.end() || !extensions->contains(name)) return nullptr;
  return &extensions->at(name);
}

[[noreturn]] void fail_damaged(const GltfFile& gltf, const std::string& what) {
  fail("{}: expected compressed data, but those of {} are damaged; export it again", gltf.path, what);
}

// Adds bytes as a buffer of their own. @return the number of its buffer view
size_t add_view(GltfFile& gltf, std::string bytes) {
  Json& views = gltf.document["bufferViews"];
  views.push_back({{"buffer", gltf.buffers.size()}, {"byteLength", bytes.size()}});
  gltf.buffers.push_back(std::move(bytes));
  return views.size() - 1;
}

// A buffer view as meshoptimizer (version 0 of its format) compresses it.
std::string meshopt_bytes(const GltfFile& gltf, const Json& source, const std::string& name) {
  const size_t buffer = gltf_count(gltf, source.at("buffer")), begin = gltf_count(gltf, source, "byteOffset", 0);
  const size_t size = gltf_count(gltf, source.at("byteLength")), count = gltf_count(gltf, source.at("count"));
  const size_t stride = gltf_count(gltf, source.at("byteStride"));
  const std::string mode = source.at("mode").get<std::string>(), filter = source.value("filter", "NONE");
  require(buffer < gltf.buffers.size() && begin <= gltf.buffers[buffer].size() &&
              size <= gltf.buffers[buffer].size() - begin,
          "{}: expected {} compressed bytes of {} inside its buffer {}; export it again", gltf.path, size, name,
          buffer);
  // So few bytes cannot be so many items: 16 items take 4 bytes or more for each of their bytes that changes, and 2 bits for each
  // that does not; an index takes a byte, and a triangle a third of one for each corner.
  const bool is_sound = stride > 0 && stride <= 256 && count <= 64 * size + 64 && count * stride <= 64 * size + 256 &&
                        (mode == "ATTRIBUTES" ? stride % 4 == 0 : stride == 2 || stride == 4) &&
                        (mode != "TRIANGLES" || count % 3 == 0);
  if (!is_sound) fail_damaged(gltf, name);
  const auto* data = reinterpret_cast<const unsigned char*>(gltf.buffers[buffer].data() + begin);
  std::string bytes(count * stride, '\0');
  int problem = -1;
  if (mode == "ATTRIBUTES")
    problem = meshopt_decodeVertexBuffer(bytes.data(), count, stride, data, size);
  else if (mode == "TRIANGLES")
    problem = meshopt_decodeIndexBuffer(bytes.data(), count, stride, data, size);
  else if (mode == "INDICES")
    problem = meshopt_decodeIndexSequence(bytes.data(), count, stride, data, size);
  if (problem != 0) fail_damaged(gltf, name);
  // The filters work on 4 items at once where they can, each of 4 or 8 bytes, or of any number of 4 bytes.
  if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
    meshopt_decodeFilterOct(bytes.data(), count, stride);
  else if (filter == "QUATERNION" && stride == 8)
    meshopt_decodeFilterQuat(bytes.data(), count, stride);
  else if (filter == "EXPONENTIAL" && stride % 4 == 0)
    meshopt_decodeFilterExp(bytes.data(), count, stride);
  else if (filter != "NONE")
    fail_damaged(gltf, name);
  return bytes;
}

void decompress_views(GltfFile& gltf) {
  const size_t views = gltf.document.value("bufferViews", Json::array()).size();
  for (size_t i = 0; i < views; ++i) {
    const Json* source = extension_of(gltf.document["bufferViews"][i], "EXT_meshopt_compression");
    if (!source) continue;
    std::string bytes = meshopt_bytes(gltf, *source, fmt::format("buffer view {}", i));
    Json& view = gltf.document["bufferViews"][i];
    view["buffer"] = gltf.buffers.size();
    view["byteOffset"] = 0;
    view["byteLength"] = bytes.size();
    gltf.buffers.push_back(std::move(bytes));
  }
}

// An accessor of plain numbers. @return its number
size_t add_accessor(GltfFile& gltf, std::string bytes, int component, size_t count, const std::string& type) {
  const size_t view = add_view(gltf, std::move(bytes));
  Json& accessors = gltf.document["accessors"];
  accessors.push_back({{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
  return accessors.size() - 1;
}

template <class T>
void append(std::string& bytes, T value) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  bytes.append(raw.data(), raw.size());
}

// What the integers of a Draco attribute are to be divided by: accessors may say that they are normalized where the attribute does
// not, as many encoders leave it.
float divisor_of(const Json& accessor, const draco::PointAttribute& values) {
  if (!accessor.value("normalized", false) || values.normalized()) return 1;
  switch (values.data_type()) {
    case draco::DT_UINT8:
      return 255;
    case draco::DT_INT8:
      return 127;
    case draco::DT_UINT16:
      return 65535;
    case draco::DT_INT16:
      return 32767;
    default:
      return 1;
  }
}

constexpr int unsigned_int = 5125, floating_point = 5126;  // "componentType"

// Replaces the accessors of a primitive by what Draco has kept of them. Integers that are normalized become floating-point numbers.
void decompress_primitive(GltfFile& gltf, Json& primitive, const Json& source, const std::string& name) {
  const std::string_view data = gltf_view(gltf, gltf_count(gltf, source.at("bufferView")));
  draco::DecoderBuffer buffer;
  buffer.Init(data.data(), data.size());
  std::unique_ptr<draco::PointCloud> points;
  const auto type = draco::Decoder::GetEncodedGeometryType(&buffer);
  if (!type.ok()) fail_damaged(gltf, name);
  draco::Decoder decoder;
  draco::Mesh* mesh = nullptr;
  if (type.value() == draco::TRIANGULAR_MESH) {
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) fail_damaged(gltf, name);
    std::unique_ptr<draco::Mesh> owned = std::move(decoded).value();
    mesh = owned.get();
    points = std::move(owned);
  } else {
    auto decoded = decoder.DecodePointCloudFromBuffer(&buffer);
    if (!decoded.ok()) fail_damaged(gltf, name);
    points = std::move(decoded).value();
  }
  const size_t count = points->num_points();
  for (const auto& [attribute, identity] : source.at("attributes").items()) {
    const draco::PointAttribute* values = points->GetAttributeByUniqueId(uint32_t(gltf_count(gltf, identity)));
    const int components = values ? values->num_components() : 0;
    if (components < 1 || components > 4) fail_damaged(gltf, name);
    const size_t original = gltf_count(gltf, primitive.at("attributes").at(attribute));
    const Json& accessors = gltf.document.at("accessors");
    if (original >= accessors.size()) fail_damaged(gltf, name);
    const float divisor = divisor_of(accessors[original], *values);
    std::string bytes;
    for (size_t i = 0; i < count; ++i) {
      std::array<float, 4> item{};
      const draco::AttributeValueIndex at = values->mapped_index(draco::PointIndex(uint32_t(i)));
      if (at.value() >= values->size() || !values->ConvertValue<float>(at, int8_t(components), item.data()))
        fail_damaged(gltf, name);
      for (int c = 0; c < components; ++c) append(bytes, item[size_t(c)] / divisor);
    }
    constexpr std::array types{"SCALAR", "VEC2", "VEC3", "VEC4"};
    primitive["attributes"][attribute] =
        add_accessor(gltf, std::move(bytes), floating_point, count, types[size_t(components - 1)]);
  }
  if (!mesh) return;
  std::string indices;
  for (uint32_t f = 0; f < mesh->num_faces(); ++f)
    for (const draco::PointIndex& corner : mesh->face(draco::FaceIndex(f))) append(indices, corner.value());
  primitive["mode"] = 4;  // strips are triangles now
  primitive["indices"] = add_accessor(gltf, std::move(indices), unsigned_int, 3 * size_t(mesh->num_faces()), "SCALAR");
}

void decompress_primitives(GltfFile& gltf) {
  const size_t meshes = gltf.document.value("meshes", Json::array()).size();
  for (size_t m = 0; m < meshes; ++m) {
    const size_t primitives = gltf.document["meshes"][m].value("primitives", Json::array()).size();
    for (size_t p = 0; p < primitives; ++p) {
      Json primitive = gltf.document["meshes"][m]["primitives"][p];  // a copy: the document grows meanwhile
      const Json* source = extension_of(primitive, "KHR_draco_mesh_compression");
      if (!source) continue;
      decompress_primitive(gltf, primitive, Json(*source), fmt::format("mesh {}", m));
      gltf.document["meshes"][m]["primitives"][p] = std::move(primitive);
    }
  }
}

}  // namespace

void decompress_gltf(GltfFile& gltf) {
  decompress_views(gltf);
  decompress_primitives(gltf);
}

}  // namespace holotrace
