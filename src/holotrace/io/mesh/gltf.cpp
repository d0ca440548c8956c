#include "holotrace/io/mesh/gltf.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"

namespace holotrace {
namespace {

using Json = nlohmann::json;

constexpr uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

uint32_t read_u32(std::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value |= uint32_t(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

void append_u32(std::string& bytes, uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes.push_back(char(value >> (8 * i)));
}

void append_chunk(std::string& bytes, uint32_t kind, std::string content, char filler) {
  content.resize((content.size() + 3) / 4 * 4, filler);
  append_u32(bytes, uint32_t(content.size()));
  append_u32(bytes, kind);
  bytes += content;
}

// Splits a GLB into its JSON and its binary part.
std::pair<std::string, std::string> split_glb(const std::string& path, std::string_view bytes) {
  const auto damaged = [&] { fail("{}: expected a binary glTF model, but it is truncated; export it again", path); };
  require(bytes.substr(0, 4) == "glTF", "{}: expected a binary glTF model, but it is damaged; export it again", path);
  if (bytes.size() < 12) damaged();
  const uint32_t version = read_u32(bytes, 4);
  require(version == 2, "{}: expected a glTF model of version 2, got version {}; export it again as glTF 2.0", path,
          version);
  std::string json, binary;
  for (size_t at = 12; at + 8 <= bytes.size();) {
    const size_t size = read_u32(bytes, at);
    const uint32_t kind = read_u32(bytes, at + 4);
    if (size > bytes.size() - at - 8) damaged();
    const std::string_view content = bytes.substr(at + 8, size);
    if (kind == json_chunk && json.empty()) json = content;
    if (kind == binary_chunk && binary.empty()) binary = content;
    at += 8 + size;
  }
  if (json.empty()) damaged();
  return {json, binary};
}

void check_version(const GltfFile& gltf) {
  const std::string version = gltf.document.at("asset").at("version").get<std::string>();
  require(version.starts_with("2."),
          "{}: expected a glTF model of version 2, got version {}; export it again as glTF 2.0", gltf.path, version);
}

// Refuses files that require an extension without which they cannot be read.
void check_required_extensions(const GltfFile& gltf) {
  constexpr std::array harmless{"KHR_texture_transform", "KHR_lights_punctual", "EXT_texture_webp"};
  for (const Json& item : gltf.document.value("extensionsRequired", Json::array())) {
    const std::string name = item.get<std::string>();
    if (name.starts_with("KHR_materials_") || std::find(harmless.begin(), harmless.end(), name) != harmless.end())
      continue;
    fail("{}: expected a glTF model that can be read without extensions, but it needs {}; export it without {}",
         gltf.path, name,
         name.find("quantization") != std::string::npos || name.find("compression") != std::string::npos
             ? "compression"
             : "that extension");
  }
}

// Checks that nodes are trees: a node below itself would be read without end.
void check_nodes(const GltfFile& gltf) {
  const Json nodes = gltf.document.value("nodes", Json::array());
  std::vector<int> parents(nodes.size(), 0), places(nodes.size(), 0);
  for (const Json& node : nodes)
    for (const Json& child : node.value("children", Json::array())) ++parents.at(child.get<size_t>());
  for (const Json& scene : gltf.document.value("scenes", Json::array()))
    for (const Json& root : scene.value("nodes", Json::array())) places.at(root.get<size_t>()) = 1;
  for (size_t i = 0; i < nodes.size(); ++i)
    require(parents[i] + places[i] <= 1, "{}: expected each node in one place, got node {} in several; export it again",
            gltf.path, i);
}

std::string decode_base64(std::string_view text) {
  std::string bytes;
  uint32_t buffer = 0;
  int bits = 0;
  for (const char c : text) {
    int digit = -1;
    if (c >= 'A' && c <= 'Z') digit = c - 'A';
    if (c >= 'a' && c <= 'z') digit = c - 'a' + 26;
    if (c >= '0' && c <= '9') digit = c - '0' + 52;
    if (c == '+') digit = 62;
    if (c == '/') digit = 63;
    if (digit < 0) break;  // padding at the end
    buffer = buffer << 6 | uint32_t(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(char(buffer >> bits));
  }
  return bytes;
}

// "a%20b.png" → "a b.png".
std::string decode_percents(const std::string& uri) {
  std::string name;
  for (size_t i = 0; i < uri.size(); ++i) {
    const auto is_digit = [&](size_t at) {
      return at < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[at]));
    };
    if (uri[i] == '%' && is_digit(i + 1) && is_digit(i + 2)) {
      name.push_back(char(std::stoi(uri.substr(i + 1, 2), nullptr, 16)));
      i += 2;
    } else {
      name.push_back(uri[i]);
    }
  }
  return name;
}

std::string beside(const GltfFile& gltf, const std::string& uri) {
  return (std::filesystem::path(gltf.path).parent_path() / decode_percents(uri)).string();
}

// The bytes that a URI contains or refers to; "" for a file that is missing.
std::string read_uri(const GltfFile& gltf, const std::string& uri, std::string& label) {
  if (uri.starts_with("data:")) {
    const size_t comma = uri.find(',');
    return comma == std::string::npos ? "" : decode_base64(std::string_view(uri).substr(comma + 1));
  }
  label = beside(gltf, uri);
  return std::filesystem::exists(label) ? read_text(label) : "";
}

std::string read_view(const GltfFile& gltf, size_t index) {
  const Json& view = gltf.document.at("bufferViews").at(index);
  const Json& buffer = gltf.document.at("buffers").at(view.at("buffer").get<size_t>());
  std::string label, bytes;
  if (buffer.contains("uri")) bytes = read_uri(gltf, buffer.at("uri").get<std::string>(), label);
  const std::string& whole = buffer.contains("uri") ? bytes : gltf.binary;
  const auto begin = view.value("byteOffset", size_t(0)), size = view.at("byteLength").get<size_t>();
  require(begin <= whole.size() && size <= whole.size() - begin,
          "{}: expected {} bytes of an image from byte {} on, but its data end after {}; export it again", gltf.path,
          size, begin, whole.size());
  return whole.substr(begin, size);
}

}  // namespace

GltfFile read_gltf(const std::string& path) {
  GltfFile gltf{path, {}, {}};
  std::string text = read_text(path);
  if (extension_of(path) == ".glb") std::tie(text, gltf.binary) = split_glb(path, text);
  try {
    gltf.document = Json::parse(text);
    check_version(gltf);
    check_required_extensions(gltf);
    check_nodes(gltf);
  } catch (const Json::exception& e) {
    fail("{}: expected a glTF model, but it is damaged ({}); export it again", path, e.what());
  } catch (const std::out_of_range&) {
    fail("{}: expected nodes that are there, got one with a number beyond them; export it again", path);
  }
  return gltf;
}

std::string gltf_shapes(const GltfFile& gltf) {
  Json document = gltf.document;
  for (const char* key : {"textures", "images", "samplers", "animations", "skins", "cameras", "extensions",
                          "extensionsUsed", "extensionsRequired"})
    document.erase(key);
  if (document.contains("materials"))
    for (size_t i = 0; i < document["materials"].size(); ++i)
      document["materials"][i] = Json{{"name", std::to_string(i)}};
  if (document.contains("nodes"))
    for (Json& node : document["nodes"])
      for (const char* key : {"camera", "skin", "extensions"}) node.erase(key);
  std::string text = document.dump();
  if (extension_of(gltf.path) != ".glb") return text;
  std::string chunks;
  append_chunk(chunks, json_chunk, std::move(text), ' ');
  if (!gltf.binary.empty()) append_chunk(chunks, binary_chunk, gltf.binary, '\0');
  std::string bytes = "glTF";
  append_u32(bytes, 2);
  append_u32(bytes, uint32_t(chunks.size() + 12));
  return bytes + chunks;
}

std::string gltf_image(const GltfFile& gltf, int image, std::string& label) {
  const Json& source = gltf.document.at("images").at(size_t(image));
  label = fmt::format("{} (image {} \"{}\")", gltf.path, image, source.value("name", ""));
  if (source.contains("uri")) return read_uri(gltf, source.at("uri").get<std::string>(), label);
  return read_view(gltf, source.at("bufferView").get<size_t>());
}

}  // namespace holotrace
