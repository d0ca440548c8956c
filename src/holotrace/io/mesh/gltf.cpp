#include "holotrace/io/mesh/gltf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/text.h"
#include "holotrace/io/mesh/gltf_compression.h"

namespace holotrace {
namespace {

using Json = nlohmann::json;

constexpr uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

uint32_t read_u32(std::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value |= uint32_t(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
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
  constexpr std::array harmless{"KHR_texture_transform",      "KHR_lights_punctual",     "EXT_texture_webp",
                                "KHR_mesh_quantization",      "KHR_animation_pointer",   "KHR_node_visibility",
                                "KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing"};
  for (const Json& item : gltf.document.value("extensionsRequired", Json::array())) {
    const std::string name = item.get<std::string>();
    if (name.starts_with("KHR_materials_") || std::find(harmless.begin(), harmless.end(), name) != harmless.end())
      continue;
    fail(
        "{}: expected a glTF model that can be read without extensions, but it needs {}; export it without that extension",
        gltf.path, name);
  }
}

// Checks that nodes are trees: a node below itself would be read without end.
void check_nodes(const GltfFile& gltf) {
  const Json nodes = gltf.document.value("nodes", Json::array());
  std::vector<int> parents(nodes.size(), 0), places(nodes.size(), 0);
  for (const Json& node : nodes)
    for (const Json& child : node.value("children", Json::array())) ++parents.at(gltf_count(gltf, child));
  for (const Json& scene : gltf.document.value("scenes", Json::array()))
    for (const Json& root : scene.value("nodes", Json::array())) places.at(gltf_count(gltf, root)) = 1;
  for (size_t i = 0; i < nodes.size(); ++i)
    require(parents[i] + places[i] <= 1,
            "{}: expected at most one parent for each node, got several for node {}; export it again", gltf.path, i);
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

// The bytes that a URI contains or refers to; "" for a file that is missing.
std::string read_uri(const GltfFile& gltf, const std::string& uri, std::string& label) {
  if (uri.starts_with("data:")) {
    const size_t comma = uri.find(',');
    return comma == std::string::npos ? "" : decode_base64(std::string_view(uri).substr(comma + 1));
  }
  label = decode_percents(uri);
  const std::string file = find_beside(label, gltf.path, gltf.outside);
  if (file.empty()) return "";
  label = file;
  return read_text(file);
}

// The bytes of all buffers. The first buffer of a GLB without a URI is its binary part.
std::vector<std::string> read_buffers(const GltfFile& gltf, std::string&& binary) {
  std::vector<std::string> buffers;
  for (const Json& buffer : gltf.document.value("buffers", Json::array())) {
    std::string label;
    if (buffer.contains("uri")) {
      buffers.push_back(read_uri(gltf, buffer.at("uri").get<std::string>(), label));
      require(!buffers.back().empty(), "{}: expected data in its buffer {}, got none{}", gltf.path, buffers.size() - 1,
              label.empty() ? "; export it again" : fmt::format("; is {} missing?", label));
    } else {
      buffers.push_back(buffers.empty() ? std::exchange(binary, {}) : "");
    }
  }
  return buffers;
}

}  // namespace

GltfFile read_gltf(const std::string& path, Outside outside) {
  GltfFile gltf{path, {}, {}, outside};
  std::string text = read_text(path), binary;
  const bool is_text = extension_of(path) != ".glb" || text.starts_with('{');
  if (text.starts_with("glTF") || !is_text) std::tie(text, binary) = split_glb(path, text);
  gltf.document = parse_json(as_lines(std::move(text), path), path);
  try {
    check_version(gltf);
    check_required_extensions(gltf);
    check_nodes(gltf);
    gltf.buffers = read_buffers(gltf, std::move(binary));
    decompress_gltf(gltf);
  } catch (const Json::exception& e) {
    fail("{}: expected a glTF model, but it is damaged ({}); export it again", path, reason(e));
  } catch (const std::out_of_range&) {
    fail("{}: expected node numbers below that of the nodes in the file, got a larger one; export it again", path);
  }
  return gltf;
}

size_t gltf_count(const GltfFile& gltf, const Json& value) {
  if (value.is_number_unsigned()) return value.get<size_t>();
  constexpr double most = 0x1p53;  // doubles hold every whole number up to this one
  const double number = value.is_number() ? value.get<double>() : -1;
  require(number >= 0 && number <= most && number == std::floor(number),
          "{}: expected a whole number of 0 or more as an index or a count, got {}; export it again", gltf.path,
          value.is_number() ? fmt::format("{:g}", number) : std::string("a ") + value.type_name());
  return size_t(number);
}

size_t gltf_count(const GltfFile& gltf, const Json& parent, const char* key, size_t fallback) {
  const auto found = parent.find(key);
  return found == parent.end() ? fallback : gltf_count(gltf, *found);
}

std::vector<size_t> gltf_counts(const GltfFile& gltf, const Json& list) {
  require(list.is_array(), "{}: expected a list of whole numbers, got another kind of value; export it again",
          gltf.path);
  std::vector<size_t> counts;
  for (const Json& value : list) counts.push_back(gltf_count(gltf, value));
  return counts;
}

std::string_view gltf_view(const GltfFile& gltf, size_t index) {
  const Json& view = gltf.document.at("bufferViews").at(index);
  const auto number = gltf_count(gltf, view.at("buffer"));
  require(number < gltf.buffers.size(),
          "{}: expected buffer numbers below {}, got {} in buffer view {}; export it again", gltf.path,
          gltf.buffers.size(), number, index);
  const std::string& whole = gltf.buffers[number];
  const auto begin = gltf_count(gltf, view, "byteOffset", 0), size = gltf_count(gltf, view.at("byteLength"));
  require(begin <= whole.size() && size <= whole.size() - begin,
          "{}: expected {} bytes from byte {} on in buffer {}, but its data end after {}; export it again", gltf.path,
          size, begin, number, whole.size());
  return std::string_view(whole).substr(begin, size);
}

std::string reason(const nlohmann::json::exception& error) {
  const std::string_view message =
      error.what();  // "[json.exception.type_error.302] type must be number, but is string"
  return std::string(message.substr(std::min(message.find("] ") + 2, message.size())));
}

std::string gltf_image(const GltfFile& gltf, int image, std::string& label) {
  const Json& source = gltf.document.at("images").at(size_t(image));
  label = fmt::format("{} (image {} \"{}\")", gltf.path, image, source.value("name", ""));
  if (source.contains("uri")) return read_uri(gltf, source.at("uri").get<std::string>(), label);
  return std::string(gltf_view(gltf, gltf_count(gltf, source.at("bufferView"))));
}

namespace {

// Values of "componentType" in the standard.
enum Component : int { int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };

size_t size_of(int component, const GltfFile& gltf) {
  switch (component) {
    case int8:
    case uint8:
      return 1;
    case int16:
    case uint16:
      return 2;
    case uint32:
    case float32:
      return 4;
    default:
      fail("{}: expected a component type of glTF, 5120 to 5126, got {}; export it again", gltf.path, component);
  }
}

size_t components_of(const std::string& type, const GltfFile& gltf) {
  constexpr std::array<std::pair<const char*, size_t>, 7> types{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  for (const auto& [name, count] : types)
    if (type == name) return count;
  fail("{}: expected the type of an accessor, SCALAR to MAT4, got \"{}\"; export it again", gltf.path, type);
}

template <class T>
double as(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return double(value);
}

// A number, little-endian as this machine's.
double read(const char* bytes, int component) {
  switch (component) {
    case int8:
      return as<int8_t>(bytes);
    case uint8:
      return as<uint8_t>(bytes);
    case int16:
      return as<int16_t>(bytes);
    case uint16:
      return as<uint16_t>(bytes);
    case uint32:
      return as<uint32_t>(bytes);
    default:
      return as<float>(bytes);
  }
}

double normalized(double value, int component) {
  switch (component) {
    case int8:
      return std::max(value / 127, -1.0);
    case uint8:
      return value / 255;
    case int16:
      return std::max(value / 32767, -1.0);
    case uint16:
      return value / 65535;
    default:
      return value;
  }
}

// Items of numbers in a buffer view.
struct Items {
  std::string_view bytes;
  size_t stride = 0, size = 0;  // size: of one number
  int component = float32;
  const char* at(size_t item, size_t number) const { return bytes.data() + item * stride + number * size; }
};

// `count` items of `numbers` numbers each, from the "bufferView" and "byteOffset" of `source`.
Items items_of(const GltfFile& gltf, const Json& source, int component, size_t count, size_t numbers) {
  const auto index = gltf_count(gltf, source.at("bufferView"));
  Items items{gltf_view(gltf, index), 0, size_of(component, gltf), component};
  const size_t packed = items.size * numbers;
  items.stride = gltf_count(gltf, gltf.document.at("bufferViews").at(index), "byteStride", packed);
  if (items.stride == 0) items.stride = packed;
  const auto offset = gltf_count(gltf, source, "byteOffset", 0);
  const size_t present = items.bytes.size();
  const bool is_inside = offset <= present && items.stride >= packed && packed <= present - offset &&
                         count - 1 <= (present - offset - packed) / items.stride;
  require(count == 0 || is_inside,
          "{}: expected {} items of {} numbers from byte {} on, but the buffer view {} ends after {} bytes; export it "
          "again",
          gltf.path, count, numbers, offset, index, present);
  items.bytes.remove_prefix(std::min(offset, present));
  return items;
}

constexpr size_t most_without_data = 1 << 24;  // items of a sparse accessor that states only a few

}  // namespace

std::vector<double> gltf_numbers(const GltfFile& gltf, size_t accessor, size_t components) {
  const Json& source = gltf.document.at("accessors").at(accessor);
  const int component = int(std::min<size_t>(gltf_count(gltf, source.at("componentType")), 1 << 30));
  const size_t count = gltf_count(gltf, source.at("count"));
  const size_t present = components_of(source.at("type").get<std::string>(), gltf);
  const bool is_normalized = source.value("normalized", false), is_sparse = source.contains("sparse");
  require(present >= components, "{}: expected {} numbers per item of the accessor {}, got {}; export it again",
          gltf.path, components, accessor, present);
  const auto convert = [&](double value) { return is_normalized ? normalized(value, component) : value; };
  std::vector<double> values;
  if (source.contains("bufferView")) {
    const Items items = items_of(gltf, source, component, count, present);
    values.reserve(count * components);
    for (size_t i = 0; i < count; ++i)
      for (size_t c = 0; c < components; ++c) values.push_back(convert(read(items.at(i, c), component)));
  } else {
    require(is_sparse && count <= most_without_data, "{}: expected data of the accessor {}, got none; export it again",
            gltf.path, accessor);
    values.assign(count * components, 0.0);
  }
  if (!is_sparse) return values;
  const Json& sparse = source.at("sparse");
  const size_t changed = gltf_count(gltf, sparse.at("count"));
  const Json& places = sparse.at("indices");
  const int place_component = int(std::min<size_t>(gltf_count(gltf, places.at("componentType")), 1 << 30));
  const Items indices = items_of(gltf, places, place_component, changed, 1);
  const Items news = items_of(gltf, sparse.at("values"), component, changed, present);
  for (size_t i = 0; i < changed; ++i) {
    const double place = read(indices.at(i, 0), place_component);
    require(place >= 0 && place < double(count), "{}: expected indices below {} in the sparse accessor {}, got {}",
            gltf.path, count, accessor, place);
    for (size_t c = 0; c < components; ++c)
      values[size_t(place) * components + c] = convert(read(news.at(i, c), component));
  }
  return values;
}

std::vector<uint32_t> gltf_indices(const GltfFile& gltf, size_t accessor) {
  const std::vector<double> numbers = gltf_numbers(gltf, accessor, 1);
  std::vector<uint32_t> indices;
  indices.reserve(numbers.size());
  for (const double number : numbers) {
    const auto index = number >= 0 && number < 0x1p32 ? uint32_t(number) : UINT32_MAX;
    require(double(index) == number, "{}: expected whole numbers in the accessor {} of indices, got {}", gltf.path,
            accessor, number);
    indices.push_back(index);
  }
  return indices;
}

}  // namespace holotrace
