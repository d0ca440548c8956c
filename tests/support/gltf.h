#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "support/temporary.h"

namespace holotrace::test {

/// Bytes in base64, as in a data URI.
inline std::string base64(const std::string& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
  }
  return text;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// A glTF model of one triangle (0,0,0), (1,0,0), (0,1,0). Its primitives may use the accessors
/// 0 positions, 1 and 2 texture coordinates (v down) of the sets 0 and 1, 3 colours, 4 indices.
struct GltfTriangle {
  std::string nodes = R"([{"mesh": 0}])";
  std::string primitives = R"([{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 4, "material": 0}])";
  std::string materials = "[{}]";
  std::string more;  ///< further members of the document, each followed by a comma
  std::vector<float> set_0{0.25f, 0, 1, 0, 0.25f, 0.75f}, set_1{0.5f, 0.5f, 1, 0, 0, 1};
  std::vector<uint8_t> colours{255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 188, 255};

  std::string binary() const {
    const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::vector<uint32_t> indices{0, 1, 2};
    return bytes_of(positions) + bytes_of(set_0) + bytes_of(set_1) + bytes_of(colours) + bytes_of(indices);
  }

  /// @param buffer  "uri": "…" of the buffer, or "" for that of a GLB
  /// @param views   further buffer views, each preceded by a comma
  std::string document(const std::string& buffer, size_t size, const std::string& views = "") const {
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": )" + nodes +
           R"(, "meshes": [{"name": "triangle", "primitives": )" + primitives + R"(}], "materials": )" + materials +
           ", " + more + R"("accessors": [
  {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
  {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
  {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2"},
  {"bufferView": 3, "componentType": 5121, "count": 3, "type": "VEC4", "normalized": true},
  {"bufferView": 4, "componentType": 5125, "count": 3, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24},
  {"buffer": 0, "byteOffset": 60, "byteLength": 24}, {"buffer": 0, "byteOffset": 84, "byteLength": 12},
  {"buffer": 0, "byteOffset": 96, "byteLength": 12})" +
           views + R"(], "buffers": [{)" + buffer + (buffer.empty() ? "" : ", ") + R"("byteLength": )" +
           std::to_string(size) + "}]}";
  }

  std::string text() const {
    const std::string bytes = binary();
    return document(R"("uri": "data:application/octet-stream;base64,)" + base64(bytes) + "\"", bytes.size());
  }

  /// The model as a GLB with an image file after the triangle, as the buffer view 5.
  std::string glb(std::string image) const {
    image.resize((image.size() + 3) / 4 * 4, '\0');
    const std::string bytes = binary() + image;
    std::string json = document(
        "", bytes.size(), R"(, {"buffer": 0, "byteOffset": 108, "byteLength": )" + std::to_string(image.size()) + "}");
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto word = [](size_t value) { return bytes_of(std::vector<uint32_t>{uint32_t(value)}); };
    return "glTF" + word(2) + word(12 + 8 + json.size() + 8 + bytes.size()) + word(json.size()) + "JSON" + json +
           word(bytes.size()) + std::string("BIN\0", 4) + bytes;
  }
};

}  // namespace holotrace::test
